// The size budget: one message per tick with all robots, below 60 KB (61 440 bytes), in one UDP
// datagram. The numbers are those of lcmtypes/README.md.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/programs/program.hpp"
#include "robot/dynamics/byte_code.hpp"
#include "tests/lcmtypes/contract.hpp"

namespace lab {
namespace {

constexpr std::size_t kLargest = 60'000;  // a little below 60 KB, for the names of senders
constexpr std::size_t kLargestAnalysis = 8'192;
constexpr std::size_t kLargestCollective = 24'576;
constexpr std::string_view kSender = "robot_bridge";

/// `message` with one part per robot in `parts`.
template <class Message, class Part, class Count>
std::size_t sizeWith(std::size_t robots, std::vector<Part> Message::*parts, Count Message::*count) {
  Message message{};
  message.sender = kSender;
  message.*parts = std::vector<Part>(robots, sample<Part>(0));
  message.*count = static_cast<Count>(robots);
  return encode(message).size();
}

/// As long as an experiment file may name a program.
const std::string kLongestName(32, 'n');

struct Row {
  std::size_t robots;
  std::size_t status;
  std::size_t frame;
  std::size_t truth;
  std::size_t stop;
  std::size_t command;
  std::size_t senses;
};

/// The states of robots that run the program with the longest name.
std::size_t statusSize(std::size_t robots) {
  auto state = sample<robot_state_t>(0);
  state.program.name = kLongestName;
  robot_status_t status{};
  status.sender = kSender;
  status.robots.assign(robots, state);
  status.num_robots = static_cast<std::int32_t>(robots);
  return encode(status).size();
}

/// One order for all robots, with the longest table of the longest programs.
std::size_t commandSize(std::size_t robots) {
  light_band_t band{};
  band.program.id.name = kLongestName;
  band.program.text = std::string(kLongestProgramText, 't');
  band.program.code.assign(dynamics::kLargestProgram, 0);
  band.program.size = dynamics::kLargestProgram;
  robot_command_t command{};
  command.sender = kSender;
  robot_order_t order{};
  order.robot_ids.assign(robots, 0);
  order.num_robots = static_cast<std::int32_t>(robots);
  order.bands.assign(4, band);
  order.num_bands = 4;
  command.orders.assign(1, order);
  command.num_orders = 1;
  return encode(command).size();
}

class MessageSize : public testing::TestWithParam<Row> {};

TEST_P(MessageSize, IsThatOfTheReadmeAndFitsOneDatagram) {
  const Row row = GetParam();
  EXPECT_EQ(statusSize(row.robots), row.status);
  EXPECT_EQ(sizeWith(row.robots, &tracked_frame_t::robots, &tracked_frame_t::num_robots),
            row.frame);
  EXPECT_EQ(sizeWith(row.robots, &sim_truth_t::robots, &sim_truth_t::num_robots), row.truth);
  EXPECT_EQ(sizeWith(row.robots, &robot_stop_t::robot_ids, &robot_stop_t::num_robots), row.stop);
  EXPECT_EQ(commandSize(row.robots), row.command);
  EXPECT_EQ(sizeWith(row.robots, &robot_senses_t::robots, &robot_senses_t::num_robots), row.senses);
  for (const std::size_t size :
       {row.status, row.frame, row.truth, row.stop, row.command, row.senses}) {
    EXPECT_LT(size, kLargest);
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, MessageSize,
                         testing::Values(Row{1, 277, 154, 99, 63, 17'093, 89},
                                         Row{20, 4'533, 1'674, 821, 139, 17'169, 773},
                                         Row{250, 56'053, 20'074, 9'561, 1'059, 18'089, 9'053}));

TEST(MessageSizes, KeepAnAnalysisBelowEightKilobytes) {
  constexpr std::size_t kLags = 60;
  auto analysis = sample<analysis_t>(0);
  auto curve = sample<curve_t>(kLags);
  auto estimate = sample<estimate_t>(0);
  estimate.note = std::string(60, 'n');
  analysis.curves.assign(3, curve);
  analysis.num_curves = 3;
  analysis.estimates.assign(12, estimate);
  analysis.num_estimates = 12;
  EXPECT_LT(encode(analysis).size(), kLargestAnalysis);
}

TEST(MessageSizes, KeepACollectiveBelowTwentyFourKilobytes) {
  constexpr std::size_t kPoints = 90;  // of g(r) and C_v(r); other curves have fewer
  constexpr std::size_t kRobots = 250;
  auto collective = sample<collective_t>(0);
  collective.observables.assign(26, sample<observable_t>(0));
  collective.num_observables = 26;
  collective.curves.assign(9, sample<observable_curve_t>(kPoints));
  collective.num_curves = 9;
  collective.members.assign(kRobots, sample<crowd_member_t>(0));
  collective.num_members = kRobots;
  EXPECT_LT(encode(collective).size(), kLargestCollective);
}

TEST(MessageSizes, KeepTheLargestLightFieldInOneDatagram) {
  constexpr std::size_t kMostLayers = 160;  // light/field/layer.hpp, in one picture
  auto layer = sample<light_layer_t>(0);
  layer.image = std::string(64, 'f');  // a SHA-256
  auto status = sample<light_status_t>(0);
  status.layers.assign(kMostLayers, layer);
  status.num_layers = kMostLayers;
  status.previous.assign(kMostLayers, layer);
  status.num_previous = kMostLayers;
  EXPECT_LT(encode(status).size(), kLargest);
}

TEST(MessageSizes, KeepAHeartbeatSmallAfterAHundredRestarts) {
  constexpr std::size_t kStreams = 300;  // three channels of a sender that was restarted so often
  auto status = sample<service_status_t>(0);
  auto stream = sample<stream_count_t>(0);
  stream.channel = "TRACKED_FRAME";
  stream.sender = "tracker_svc";
  status.received.assign(kStreams, stream);
  status.num_received = kStreams;
  EXPECT_LT(encode(status).size(), kLargest);
}

}  // namespace
}  // namespace lab
