// The messages of a simulator with several threads.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/loop/virtual_loop.hpp"
#include "sim_svc/sim_service.hpp"

namespace lab::sim::sim_service_threads_test {
namespace {

using Messages = std::vector<std::pair<std::string, std::vector<std::uint8_t>>>;

/// What a lab with more robots than one thread takes sends in five seconds.
Messages messagesOf(std::size_t threads) {
  Experiment experiment = parseExperiment(R"(
fileversion = 1
name = "many"
duration_s = 10
program = "abp"

[arena]
width_cm = 300
height_cm = 300

[reversal]
on = "never"

[camera]
fps = 10

[robot]
status_rate_hz = 10

[[robots]]
id = 1

[programs.abp]
model = "abp"
v_cm_s = 5
epsilon_s = 0.5
eta_rad_s = 3
)",
                                          "many");
  for (std::int32_t id = 2; id <= 600; ++id) {
    experiment.robots.push_back(experiment.robots[0]);
    experiment.robots.back().id = id;
  }
  VirtualLoop loop;
  MemoryBus bus([&loop] { return loop.now(); });
  loop.drainWith([&bus] { bus.deliver(); });
  Messages messages;
  bus.subscribeAll([&messages](const Packet& packet) {
    messages.emplace_back(std::string(packet.channel),
                          std::vector<std::uint8_t>(packet.data.begin(), packet.data.end()));
  });
  Node node(bus, loop, {"sim_svc", robot_state_t::SIM, 1});
  SimService service(
      {.node = node, .loop = loop, .experiment = experiment, .directory = {}, .threads = threads});
  Node lab(bus, loop, {"lab", 0, 1});
  robot_command_t command = lightTableCommand(experiment);
  command.seq = 1;
  command.lease_ms = 60000;
  lab.publishCommand(channels::kRobotCommand, command);
  loop.runUntil(loop.now() + 5'000'000);
  return messages;
}

TEST(SimServiceThreads, SendTheSameBytesWithAnyNumber) {
  const Messages one = messagesOf(1);
  EXPECT_GT(one.size(), 100U);
  for (const std::size_t threads : {2U, 8U}) EXPECT_TRUE(messagesOf(threads) == one) << threads;
}

}  // namespace
}  // namespace lab::sim::sim_service_threads_test
