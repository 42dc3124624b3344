// Feeds messages to the services that the input selects (never dds_gateway), on one bus in virtual
// time. An exception that leaves a handler ends a service, so it counts as a crash.
#include <cstdint>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "analyzer/analyzer_service.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/camera/memory_cameras.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/serial/memory_serial.hpp"
#include "common/service/service_main.hpp"
#include "dashboard/dashboard_service.hpp"
#include "projector_ctl/projector_service.hpp"
#include "robot_bridge/bridge_service.hpp"
#include "sim_svc/sim_service.hpp"
#include "tests/fuzz/input.hpp"
#include "tests/fuzz/messages.hpp"
#include "tests/support/robustness_experiment.hpp"
#include "tracker_svc/tracker_service.hpp"

namespace lab::fuzz {
namespace {

/// kRobustnessExperiment, long enough and with rates at which many inputs run per second.
Experiment experimentWith(const std::vector<std::string>& more) {
  std::vector<std::string> overrides{"duration_s=600", "robot.status_rate_hz=5", "camera.fps=5",
                                     "light.frame_rate_hz=10",
                                     "robots=[{id=1, x_cm=30, y_cm=45, theta_deg=0},"
                                     "{id=2, x_cm=60, y_cm=45, theta_deg=90, body=\"wire\"}]"};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return parseExperiment(kRobustnessExperiment, "fuzz", overrides);
}

const Experiment& experimentOf(bool tracked) {
  static const Experiment kPoses = experimentWith({});
  static const Experiment kPictures =
      experimentWith({"camera.tracker=\"camera\"", "camera.width_px=160", "camera.height_px=120",
                      "camera.fps=1", "camera.exposure_ms=10", "camera.handshake=false"});
  return tracked ? kPictures : kPoses;
}

/// A service and its node.
struct Member {
  Member(Bus& bus, Loop& loop, SerialPorts& ports, Cameras& cameras, const Experiment& experiment,
         const ServiceDescription& description)
      : node(bus, loop, {description.name, description.origin, 1}),
        service(description.make({node, loop, experiment, "/", ports, "/", cameras})) {
    node.start();
  }
  Node node;
  std::unique_ptr<Service> service;
};

/// The dashboard without its web server.
struct Page {
  Page(Bus& bus, Loop& loop, const Experiment& experiment)
      : node(bus, loop, {"dashboard", 0, 1}),
        context{node, loop, experiment, "/"},
        dashboard(context, hub, "/runs",
                  {.viewers = [] { return 1; }, .facts = [] { return dashboard::ServerFacts{}; }}) {
    node.start();
  }
  Node node;
  ServiceContext context;
  dashboard::Hub hub;
  dashboard::DashboardBus dashboard;
};

void run(Input& input) {
  constexpr int kMostMessages = 60;
  constexpr std::int64_t kLongest_us = 10'000'000;
  // Bits 0 to 4 each leave out one service, because fewer run faster. Only if bits 5 to 7 are all
  // set does the tracker run: its pictures take ten times as long as everything else.
  constexpr unsigned kWithTracker = 0xE0;
  const unsigned chosen = input.number<std::uint8_t>();
  const auto has = [chosen](unsigned bit) { return (chosen >> bit & 1U) == 0; };
  const bool tracked = (chosen & kWithTracker) == kWithTracker;
  const Experiment& experiment = experimentOf(tracked);
  VirtualLoop loop;
  MemoryBus bus([&loop] { return loop.now(); });
  loop.drainWith([&bus] { bus.deliver(); });
  MemorySerial ports(loop);
  MemoryCameras cameras(loop);
  std::list<Member> members;
  std::unique_ptr<Page> page;
  const auto add = [&](const ServiceDescription& description) {
    members.emplace_back(bus, loop, ports, cameras, experiment, description);
  };
  if (has(0)) add(analysis::serviceDescription());
  if (has(1)) add(projector::serviceDescription());
  if (has(2)) add(bridge::serviceDescription());
  if (tracked) add(tracker::serviceDescription());
  if (has(3)) add(sim::serviceDescription());
  if (has(4)) page = std::make_unique<Page>(bus, loop, experiment);
  const std::int64_t end = loop.now() + kLongest_us;
  for (int i = 0; i < kMostMessages && !input.empty() && loop.now() < end; ++i) {
    const TimedMessage message = nextMessage(input);
    bus.publish(message.channel, message.data);
    bus.deliver();
    loop.runUntil(loop.now() + message.wait_us);
  }
  // Longer than the second in which the analyzer publishes its results.
  loop.runUntil(loop.now() + 1'100'000);
  if (page) {
    for (const char* what : {"analysis", "trails", "robot", "speeds"}) {
      for (const char* which : {"", "1", "abp"}) {
        static_cast<void>(page->dashboard.query(what, which));
      }
    }
  }
  for (Member& member : members) member.node.close();
  bus.deliver();
}

}  // namespace
}  // namespace lab::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  lab::fuzz::Input input(bytes, size);
  lab::fuzz::run(input);
  return 0;
}
