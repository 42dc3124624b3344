#include "analyzer/service/collective_message.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "common/bus/bus.hpp"
#include "common/bus/message_values.hpp"
#include "common/experiment/program_messages.hpp"
#include "tests/support/programs.hpp"

namespace lab::analysis::collective_message_test {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;  // [us since 1970]

Experiment experiment() {
  Experiment experiment;
  experiment.analysis.regions = {
      {.name = "left", .x = 0.3, .y = 0.45, .width = 0.6, .height = 0.9}};
  experiment.light_table.bands = {{0, 0.5, "abp"}, {0.5, 1, "bp"}};
  return experiment;
}

/// Robots in rows with two programs in turn; the first two touch.
class CollectiveFeedTest : public testing::Test {
 protected:
  void run(int robots, int frames) {
    for (int k = 0; k < frames; ++k) {
      const std::int64_t utime = kStart + 20'000 * k;
      robot_status_t status{};
      tracked_frame_t frame{};
      frame.utime = status.utime = utime;
      frame.frame_period = 0.02;
      for (int i = 0; i < robots; ++i) {
        robot_state_t state{};
        state.robot_id = i + 1;
        state.program = toId(i % 2 == 0 ? one_ : two_);
        state.band = static_cast<std::int8_t>(i % 2);
        status.robots.push_back(state);
        tracked_pose_t pose{};
        pose.robot_id = i + 1;
        pose.x = 0.05 + 0.1 * (i % 12) - (i == 1 ? 0.024 : 0);
        pose.y = 0.05 + 0.1 * (i / 12);
        pose.confidence = 1;
        frame.robots.push_back(pose);
      }
      dut_.take(status);
      dut_.take(frame);
    }
  }

  Program one_ = test::abp(0.03, 0.5, 3);
  Program two_ = test::abp(0.05, 0.5, 3);
  CollectiveFeed dut_{experiment()};
};

const observable_t& find(const collective_t& message, const std::string& name) {
  const auto found = std::find_if(message.observables.begin(), message.observables.end(),
                                  [&](const observable_t& one) { return one.name == name; });
  EXPECT_NE(found, message.observables.end()) << name;
  return *found;
}

TEST_F(CollectiveFeedTest, HasAMessageOfAllRobotsAndOnePerProgram) {
  run(8, 100);

  const std::vector<collective_t> messages = collectiveMessages(dut_);

  ASSERT_EQ(messages.size(), 3U);
  EXPECT_EQ(messages[0].program.hash, 0);
  EXPECT_EQ(messages[1].program.hash, one_.hash);
  EXPECT_EQ(messages[2].program.hash, two_.hash);
  EXPECT_EQ(messages[0].robots, 8);
  EXPECT_EQ(messages[1].robots, 4);
  EXPECT_NEAR(messages[0].observed, 2, 1e-9);
  EXPECT_EQ(messages[0].utime, kStart + 1'800'000);
  EXPECT_EQ(find(messages[0], "largest_cluster").now, 2);
  EXPECT_EQ(find(messages[1], "largest_cluster").now, 1);
  EXPECT_EQ(find(messages[0], "polar_order").mean, 1);
  EXPECT_NEAR(find(messages[0], "share_in_left").mean, 6.0 / 8, 1e-9);
  EXPECT_NEAR(find(messages[0], "share_in_left").now, 6.0 / 8, 1e-9);
}

TEST_F(CollectiveFeedTest, HasTheRobotsOfTheLastFrameInTheFirstMessageOnly) {
  run(8, 20);

  const std::vector<collective_t> messages = collectiveMessages(dut_);

  ASSERT_EQ(messages[0].num_members, 8);
  EXPECT_EQ(messages[1].num_members, 0);
  EXPECT_EQ(messages[0].members[0].robot_id, 1);
  EXPECT_EQ(messages[0].members[0].cluster, 1);
  EXPECT_EQ(messages[0].members[1].cluster, 1);
  EXPECT_EQ(messages[0].members[2].cluster, 0);
  EXPECT_GT(messages[0].members[0].density, 0);
}

TEST_F(CollectiveFeedTest, SurvivesTheRoundTripAndStaysBelowItsLimit) {
  run(108, 200);  // a full arena
  collective_t message = collectiveMessages(dut_).front();
  message.sender = "analyzer";
  message.members.resize(1000, message.members.front());
  message.num_members = 1000;

  const std::vector<std::uint8_t> bytes = encode(message);
  collective_t heard{};

  ASSERT_TRUE(decode(bytes, heard));
  EXPECT_LT(bytes.size(), kLargestCollective);
  EXPECT_EQ(heard.curves.size(), message.curves.size());
  EXPECT_EQ(heard.curves[0].name, "pair_distribution");
}

/// Cells without an area to speak of, a first frame, one robot that remains.
TEST_F(CollectiveFeedTest, HasNoNumberThatReceiversRefuse) {
  run(8, 1);
  for (const int together : {2, 7, 40, 1}) {
    for (int k = 0; k < 50; ++k) {
      tracked_frame_t frame{};
      frame.utime = kStart + 1'000'000 * (together + 1) + 20'000 * k;
      frame.frame_period = 0.02;
      for (int i = 0; i < together; ++i) {
        tracked_pose_t pose{};
        pose.robot_id = i + 1;
        pose.x = i % 2 == 0 ? 0 : 1.2;  // on two points of the walls
        pose.y = 0.9;
        pose.confidence = 1;
        frame.robots.push_back(pose);
      }
      dut_.take(frame);
    }
    const std::vector<collective_t> messages = collectiveMessages(dut_);
    EXPECT_EQ(messages.size(), 3U);
    for (const collective_t& message : messages) {
      EXPECT_EQ(impossibleValue(message), std::nullopt) << together;
    }
  }
}

TEST_F(CollectiveFeedTest, LeavesOutUnsurePosesAndForgetsSilentRobots) {
  run(4, 20);
  tracked_frame_t frame{};
  frame.frame_period = 0.02;
  frame.utime = kStart + 3'000'000;
  for (int i = 0; i < 4; ++i) {
    tracked_pose_t pose{};
    pose.robot_id = i + 1;
    pose.x = pose.y = 0.2 * (i + 1);
    pose.confidence = i == 0 ? 0.2F : 1.0F;
    frame.robots.push_back(pose);
  }
  const std::size_t before = dut_.analysis().group(0)->result().frames;
  dut_.take(frame);

  EXPECT_EQ(dut_.analysis().picture().robots.size(), 3U);
  EXPECT_EQ(dut_.analysis().group(0)->result().frames, before) << "no program is known any more";
}

}  // namespace
}  // namespace lab::analysis::collective_message_test
