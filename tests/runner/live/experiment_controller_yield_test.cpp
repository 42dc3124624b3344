// The light table of the lab omits a robot that another sender commands, until that sender's lease
// ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/math/units.hpp"
#include "common/service/node.hpp"
#include "runner/live/experiment_controller.hpp"

namespace lab::runner {
namespace {

constexpr const char* kFile = R"(fileversion = 1
name = "yields"
duration_s = 30
program = "abp"
[[robots]]
id = 1
[[robots]]
id = 2
[programs.abp]
model = "abp"
v_cm_s = 3
epsilon_s = 0.5
eta_rad_s = 3
)";

/// An order of the lab and its time.
struct Ordered {
  double at = 0;  ///< [s] since begin()
  std::int8_t mode = 0;
  std::vector<std::int32_t> robots;
  std::int64_t seq = 0;
};

TEST(ExperimentControllerYield, OmitsARobotDuringTheLeaseOfAnotherSender) {
  constexpr double kFrom = 10;
  constexpr double kTo = 15;
  constexpr double kLease = 0.5;
  const Experiment experiment = parseExperiment(kFile, "test");
  VirtualLoop loop;
  MemoryBus bus([&loop] { return loop.now(); });
  loop.drainWith([&bus] { bus.deliver(); });
  Node node(bus, loop, {"lab", 0, 1});
  Node other(bus, loop, {"dds_gateway", 0, 1});
  const std::int64_t begin = loop.now();
  const auto now = [&] { return units::seconds(loop.now() - begin); };
  std::vector<Ordered> orders;
  other.subscribe<robot_command_t>(channels::kRobotCommand, [&](const robot_command_t& command) {
    if (command.sender != "lab" || command.orders.empty()) return;
    const robot_order_t& order = command.orders.front();
    orders.push_back({now(), order.mode, order.robot_ids, command.seq});
  });
  bool over = false;
  ExperimentController controller({node, loop, experiment, "."}, writeExperiment(experiment),
                                  [&](Ending /*ending*/, const std::string& /*why*/) {
                                    over = true;
                                    loop.stop();
                                  });
  robot_order_t stand{};
  stand.mode = robot_order_t::STAND;
  stand.robot_ids = {1};
  stand.num_robots = 1;
  robot_command_t command{};
  command.seq = 1;
  command.lease_ms = static_cast<std::int32_t>(kLease * 1000);
  command.orders = {stand};
  command.num_orders = 1;
  loop.every(units::microseconds(0.1), begin, [&] {
    if (now() < kFrom || now() > kTo) return;
    command.utime = 0;
    other.publishCommand(channels::kRobotCommand, command);
  });
  node.start();
  other.start();
  controller.begin();
  loop.run();

  EXPECT_TRUE(over);
  int before = 0;
  int meanwhile = 0;
  int after = 0;
  std::int64_t seq = 0;
  for (const Ordered& order : orders) {
    if (order.mode != robot_order_t::TABLE) continue;
    if (seq == 0) seq = order.seq;
    EXPECT_EQ(order.seq, seq) << "the seq must not change, at " << order.at;
    const bool has1 = std::ranges::count(order.robots, 1) == 1;
    EXPECT_EQ(std::ranges::count(order.robots, 2), 1) << "at " << order.at;
    if (order.at < kFrom) {
      EXPECT_TRUE(has1) << "at " << order.at;
      ++before;
    } else if (order.at > kFrom + 0.1 && order.at < kTo + kLease - 0.1) {
      EXPECT_FALSE(has1) << "at " << order.at;
      ++meanwhile;
    } else if (order.at > kTo + kLease + 0.1) {
      EXPECT_TRUE(has1) << "at " << order.at;
      ++after;
    }
  }
  EXPECT_GT(before, 10);
  EXPECT_GT(meanwhile, 10);
  EXPECT_GT(after, 10);
}

}  // namespace
}  // namespace lab::runner
