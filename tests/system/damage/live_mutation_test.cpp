// Whatever arrives on the bus, every service goes on.
#include <gtest/gtest.h>

#include <cstdint>
#include <lab/service_status_t.hpp>
#include <list>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "analyzer/analyzer_service.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/camera/memory_cameras.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/serial/memory_serial.hpp"
#include "dashboard/views/lab_view.hpp"
#include "projector_ctl/projector_service.hpp"
#include "robot_bridge/bridge_service.hpp"
#include "sim_svc/sim_service.hpp"
#include "tests/system/damage/recorded_run.hpp"

namespace lab::damage {
namespace {

struct Member {
  Member(Bus& bus, Loop& loop, SerialPorts& ports, Cameras& cameras,
         const ServiceDescription& description, const Experiment& experiment)
      : node(bus, loop, {description.name, description.origin, 2}),
        service(description.make({node, loop, experiment, {}, ports, {}, cameras})) {}
  Node node;
  std::unique_ptr<Service> service;
};

/// Runs the services for some seconds with these messages on their bus.
/// @return the services that still report
std::set<std::string> reporting(const std::vector<RecordedMessage>& messages) {
  const Experiment lab = experiment();
  VirtualLoop loop;
  MemoryBus bus([&loop] { return loop.now(); });
  loop.drainWith([&bus] { bus.deliver(); });
  MemorySerial ports(loop);
  MemoryCameras cameras(loop);
  dashboard::Hub hub;
  dashboard::LabView page(hub, "dashboard", 2, [](const Experiment&, const std::string&) {
    return light::ImageStore();
  });
  std::set<std::string> names;
  std::int64_t end = 0;
  bus.subscribeAll([&](const Packet& packet) {
    page.take(packet, loop.now());
    service_status_t status{};
    if (loop.now() < end || packet.channel != channels::kServiceStatus) return;
    if (decode(packet.data, status) && status.instance == 2) names.insert(status.sender);
  });
  std::list<Member> members;
  for (const ServiceDescription& description :
       {sim::serviceDescription(), bridge::serviceDescription(), projector::serviceDescription(),
        analysis::serviceDescription()}) {
    members.emplace_back(bus, loop, ports, cameras, description, lab);
  }
  for (Member& member : members) member.node.start();
  loop.every(50'000, loop.now(), [&] { page.publishMoving(loop.now(), true); });
  loop.every(1'000'000, loop.now(), [&] {
    page.publishTotals(loop.now(), {});
    static_cast<void>(page.query("trails", "", loop.now()));
    static_cast<void>(page.query("robot", "1", loop.now()));
    static_cast<void>(page.query("speeds", "1", loop.now()));
    static_cast<void>(page.query("analysis", "1", loop.now()));
  });
  std::int64_t at = loop.now();
  for (const RecordedMessage& message : messages) {
    at += 3'000;
    if (message.channel.empty() || message.channel.size() > 63) continue;
    loop.at(at, [&bus, &message] { bus.publish(message.channel, message.data); });
  }
  loop.runUntil(at);
  end = at;
  loop.runUntil(at + 1'500'000);
  return names;
}

TEST(LiveMutation, EveryServiceGoesOnWhateverItHears) {
  const std::vector<RecordedMessage>& whole = recordedRun();
  const MutantRange range = mutants(60);
  forEachMutant(range, [&whole](std::uint64_t seed) {
    std::vector<RecordedMessage> messages = mutated(whole, seed);
    for (std::size_t i = 0; i < messages.size(); i += 5) {
      overwriteNumbers(messages[i].data, seed * 100'000 + i);
    }
    EXPECT_EQ(reporting(messages),
              (std::set<std::string>{"analyzer", "projector_ctl", "robot_bridge", "sim_svc"}))
        << "mutant " << seed;
    return true;
  });
}

}  // namespace
}  // namespace lab::damage
