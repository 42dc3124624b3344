// The largest messages of labs are decoded, and larger ones are refused before.
#include "common/bus/message_sizes.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/collective_t.hpp>
#include <lab/experiment_event_t.hpp>
#include <lab/light_command_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_senses_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/robot_steps_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <lab/service_status_t.hpp>
#include <lab/sim_truth_t.hpp>
#include <lab/tracked_details_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <string>
#include <vector>

#include "common/bus/received_message.hpp"
#include "common/bus/stream_counter.hpp"
#include "light/field/image.hpp"

namespace lab::message_sizes_test {
namespace {

constexpr std::size_t kRobots = 10'000;  // of a lab in virtual time

template <class Part>
void fill(std::vector<Part>& list, std::int32_t& size, std::size_t count, const Part& part = {}) {
  list.assign(count, part);
  size = static_cast<std::int32_t>(count);
}

template <class Message>
testing::AssertionResult isReceived(const Message& message) {
  const std::vector<std::uint8_t> data = encode(message);
  const auto received = receive<Message>({"", data});
  if (received->decoded && !received->removed) return testing::AssertionSuccess();
  return testing::AssertionFailure()
         << data.size() << " bytes; "
         << (received->removed ? received->removed->first : std::string("not decoded"));
}

TEST(MessageSizes, HaveRoomForAllRobotsOfALab) {
  robot_state_t robot{};
  robot.program.name.assign(32, 'x');
  robot_status_t status{};
  fill(status.robots, status.num_robots, kRobots, robot);
  EXPECT_TRUE(isReceived(status));

  tracked_frame_t frame{};
  fill(frame.robots, frame.num_robots, kRobots);
  fill(frame.unidentified, frame.num_unidentified, kRobots);
  EXPECT_TRUE(isReceived(frame));

  tracked_details_t details{};
  fill(details.caps, details.num_caps, 2 * kRobots);
  EXPECT_TRUE(isReceived(details));

  robot_steps_t steps{};
  fill(steps.steps, steps.num_steps, kRobots);
  EXPECT_TRUE(isReceived(steps));

  robot_senses_t senses{};
  fill(senses.robots, senses.num_robots, kRobots);
  EXPECT_TRUE(isReceived(senses));

  sim_truth_t truth{};
  fill(truth.robots, truth.num_robots, kRobots);
  EXPECT_TRUE(isReceived(truth));

  robot_order_t order{};  // each robot is driven by itself
  fill(order.robot_ids, order.num_robots, 1);
  robot_command_t command{};
  fill(command.orders, command.num_orders, kRobots, order);
  EXPECT_TRUE(isReceived(command));
}

TEST(MessageSizes, HaveRoomForLightAndExperiment) {
  light_layer_t grid{};
  grid.grid.assign(light::kMostColumns * light::kMostRows, 1);
  grid.num_grid = static_cast<std::int32_t>(grid.grid.size());
  light_command_t command{};
  fill(command.layers, command.num_layers, light::kMostLayers, grid);
  EXPECT_TRUE(isReceived(command));

  experiment_event_t start{};
  start.text.assign(10'000'000, 'x');
  EXPECT_TRUE(isReceived(start));
}

TEST(MessageSizes, HaveRoomForAHeartbeatWithAllStreams) {
  stream_count_t stream{};
  stream.channel.assign(63, 'x');
  stream.sender.assign(63, 'x');
  service_status_t status{};
  fill(status.received, status.num_received, 3 * StreamCounter::kMostStreams, stream);
  EXPECT_TRUE(isReceived(status));

  // A row of robot_bridge (BridgeService::reportLines()).
  stream.channel = "serial line";
  stream.sender =
      "robot 2147483647 (1000000000 restarts, 1000000000 commands sent again, 1000000000 given up, "
      "1000000000 programs loaded in 1000000000.0 s)";
  fill(status.received, status.num_received, kRobots, stream);
  EXPECT_TRUE(isReceived(status));

  collective_t collective{};  // the analysis takes at most 1000 robots
  fill(collective.members, collective.num_members, 1000);
  observable_curve_t curve{};
  for (auto* column : {&curve.x, &curve.value, &curve.low, &curve.high}) column->resize(200);
  curve.num_points = 200;
  fill(collective.curves, collective.num_curves, 20, curve);
  EXPECT_TRUE(isReceived(collective));
}

TEST(MessageSizes, EndWhereAMessageOfManyShortPartsWouldFillTheMemory) {
  analysis_t analysis{};
  fill(analysis.curves, analysis.num_curves, 100'000);
  const std::vector<std::uint8_t> data = encode(analysis);

  const auto received = receive<analysis_t>({"ANALYSIS", data});

  EXPECT_FALSE(received->decoded);
  EXPECT_TRUE(received->message.curves.empty());
  ASSERT_TRUE(received->removed);
  EXPECT_FALSE(received->removed->usable);
  EXPECT_EQ(received->removed->first,
            "size: found " + std::to_string(data.size()) + " bytes, expected at most 32000");
}

TEST(MessageSizes, DoNotHinderAStop) {
  robot_stop_t stop{};
  stop.reason.assign(20'000'000, 'x');
  EXPECT_TRUE(isReceived(stop));
}

}  // namespace
}  // namespace lab::message_sizes_test
