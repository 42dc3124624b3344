#include "sim_svc/bodies/replay_robot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <lab/experiment_event_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/codec.hpp"
#include "common/bus/log_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::sim {
namespace {

using testing::DoubleEq;
using testing::HasSubstr;
using testing::Pair;
using testing::ThrowsMessage;

constexpr std::int64_t kSecond_us = 1'000'000;
constexpr std::int64_t kFirst = 1'000 * kSecond_us;    // the first frame of the recording
constexpr std::int64_t kScript = kFirst + kSecond_us;  // its script starts a second later
/// Time in the new run at which the replay starts.
constexpr std::int64_t kLive = 5'000 * kSecond_us;

template <class Message>
void write(LogWriter& log, std::string_view channel, const Message& message) {
  const std::vector<std::uint8_t> bytes = encode(message);
  log.write({channel, bytes, message.utime});
}

Recording loadRecording(const std::filesystem::path& path, std::int32_t id, double from) {
  return RecordedLog(path, {id}).take(id, from);
}

/// Robots 3 and 4 for ten seconds at 50 frames per second; robot 3 is missing in the frame at 2.02
/// s of the script.
class ReplayRobotTest : public testing::Test {
 protected:
  ReplayRobotTest() {
    LogWriter log(path);
    experiment_event_t event{};
    event.kind = experiment_event_t::STEP;
    event.utime = kScript + 500'000;
    event.commanded_utime = kScript;
    write(log, channels::kExperimentEvent, event);
    for (std::int64_t frame = 0; frame <= 500; ++frame) {
      const std::int64_t utime = kFirst + frame * 20'000;
      tracked_frame_t message{};
      message.utime = utime;
      message.frame_period = 0.02;
      for (const std::int32_t id : {3, 4}) {
        if (id == 3 && utime == kScript + 2'020'000) continue;
        tracked_pose_t pose{};
        pose.robot_id = id;
        pose.x = 0.1 + 0.001 * static_cast<double>(frame);
        pose.y = 0.1 * id;
        pose.theta = frame % 2 == 0 ? 3.1 : -3.1;
        message.robots.push_back(pose);
      }
      message.num_robots = static_cast<std::int32_t>(message.robots.size());
      write(log, channels::kTrackedFrame, message);
      robot_status_t status{};
      status.utime = utime + 3000;
      robot_state_t state{};
      state.utime = utime + 3000;
      state.robot_id = 3;
      state.origin = robot_state_t::SIM;
      state.program.hash = 77;
      state.program.name = "rtp";
      state.phase = 1;
      state.program_start_utime = kScript + 10;
      state.command_seq = 9;
      state.stop_seq = 8;
      state.tumble_count = static_cast<std::int32_t>(frame);
      status.robots = {state};
      status.num_robots = 1;
      write(log, channels::kRobotStatus, status);
    }
    log.flush();
  }

  TemporaryFolder folder;
  std::filesystem::path path = folder / "log.lcmlog";
};

TEST_F(ReplayRobotTest, PlaysTheRecordedPosesAtTheirPace) {
  const ReplayRobot dut(loadRecording(path, 3, 2), 21, kLive);
  // 2 s of the script are frame 150.
  for (const std::int64_t frame : {0, 5, 100}) {
    const auto pose = dut.trackedPose(kLive + frame * 20'000);
    ASSERT_TRUE(pose) << frame;
    EXPECT_EQ(pose->robot_id, 21);
    EXPECT_EQ(pose->x, 0.1 + 0.001 * static_cast<double>(150 + frame));
    EXPECT_NEAR(pose->y, 0.3, 1e-12);
  }
  EXPECT_FALSE(dut.trackedPose(kLive - 1));
}

TEST_F(ReplayRobotTest, InterpolatesBetweenFrames) {
  const ReplayRobot dut(loadRecording(path, 3, 2), 3, kLive);
  const auto pose = dut.trackedPose(kLive + 5 * 20'000 + 5'000);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->x, 0.1 + 0.001 * 155.25, 1e-12);
  // From -3.1 to 3.1 by the shorter way, through pi.
  EXPECT_NEAR(pose->theta, -3.1 - 0.25 * (2 * M_PI - 6.2), 1e-9);
}

TEST_F(ReplayRobotTest, HasNoTrackedPoseButALastPoseWhileTheTrackerHadLostIt) {
  const ReplayRobot dut(loadRecording(path, 3, 2), 3, kLive);
  EXPECT_TRUE(dut.trackedPose(kLive));
  EXPECT_FALSE(dut.trackedPose(kLive + 20'000));
  EXPECT_TRUE(dut.trackedPose(kLive + 40'000));
  ASSERT_TRUE(dut.lastPose(kLive + 20'000));
  EXPECT_EQ(dut.lastPose(kLive + 20'000)->x, dut.lastPose(kLive)->x);
}

TEST_F(ReplayRobotTest, ReportsStatesWithShiftedTimesAndWithoutCommands) {
  const ReplayRobot dut(loadRecording(path, 3, 2), 21, kLive);
  const std::int64_t shift = kLive - (kScript + 2 * kSecond_us);
  const auto state = dut.state(kLive + kSecond_us);
  ASSERT_TRUE(state);
  EXPECT_EQ(state->robot_id, 21);
  EXPECT_EQ(state->origin, robot_state_t::REPLAY);
  EXPECT_EQ(state->program.hash, 77);
  EXPECT_EQ(state->program.name, "rtp");
  EXPECT_EQ(state->phase, 1);
  EXPECT_EQ(state->tumble_count, 150 + 49)
      << "the state after the frame at 1 s is still in the future";
  EXPECT_EQ(state->utime, kLive + 980'000 + 3000);
  EXPECT_EQ(state->program_start_utime, kScript + 10 + shift);
  EXPECT_EQ(state->reversal_start_utime, 0) << "0 means none and is not shifted";
  EXPECT_EQ(state->command_seq, 0);
  EXPECT_EQ(state->stop_seq, 0);
}

TEST_F(ReplayRobotTest, IsGoneAfterTheEnd) {
  const ReplayRobot dut(loadRecording(path, 3, 8), 3, kLive);
  EXPECT_TRUE(dut.trackedPose(kLive + kSecond_us));
  EXPECT_FALSE(dut.isOver(kLive + kSecond_us));
  EXPECT_TRUE(dut.isOver(kLive + kSecond_us + 1));
  EXPECT_FALSE(dut.lastPose(kLive + kSecond_us + 1));
  EXPECT_FALSE(dut.state(kLive + kSecond_us + 1));
}

TEST_F(ReplayRobotTest, ReadsTheFolderOfARun) {
  // The script starts at frame 50 of 0 to 500.
  EXPECT_EQ(loadRecording(folder / "", 4, 0).frames.size(), 451U);
}

TEST_F(ReplayRobotTest, RobotsOfOneLogAreReadTogether) {
  RecordedLog log(path, {4, 3, 4});
  std::filesystem::remove(path);
  const ReplayRobot first(log.take(4, 2), 21, kLive);
  const ReplayRobot second(log.take(3, 0), 22, kLive);
  const ReplayRobot third(log.take(4, 3), 23, kLive);
  const auto placeOf = [](const ReplayRobot& robot) {
    const auto pose = robot.trackedPose(kLive);
    return pose ? std::pair(pose->x, pose->y) : std::pair(0.0, 0.0);
  };
  // Their frames 150, 50 and 200.
  EXPECT_THAT(placeOf(first), Pair(DoubleEq(0.25), DoubleEq(0.4)));
  EXPECT_THAT(placeOf(second), Pair(DoubleEq(0.15), DoubleEq(0.1 * 3)));
  EXPECT_THAT(placeOf(third), Pair(DoubleEq(0.3), DoubleEq(0.4)));
  EXPECT_FALSE(first.state(kLive + kSecond_us)) << "the log has reports of robot 3 only";
  EXPECT_TRUE(second.state(kLive + kSecond_us));
}

TEST_F(ReplayRobotTest, OfALongNameOfAProgramOnlyTheBeginningIsReported) {
  const std::filesystem::path other = folder / "long_name.lcmlog";
  {
    LogWriter log(other);
    robot_status_t status{};
    status.utime = kFirst;
    status.robots.resize(1);
    status.num_robots = 1;
    status.robots[0].utime = kFirst;
    status.robots[0].robot_id = 3;
    status.robots[0].program.name = std::string(300'000, 'x');
    write(log, channels::kRobotStatus, status);
    for (const std::int64_t utime : {kFirst, kFirst + kSecond_us}) {
      tracked_frame_t frame{};
      frame.utime = utime;
      frame.robots.resize(1);
      frame.num_robots = 1;
      frame.robots[0].robot_id = 3;
      write(log, channels::kTrackedFrame, frame);
    }
    log.flush();
  }
  const ReplayRobot dut(loadRecording(other, 3, 0), 21, kLive);
  const auto state = dut.state(kLive);
  ASSERT_TRUE(state);
  EXPECT_EQ(state->program.name, std::string(32, 'x'));
}

TEST_F(ReplayRobotTest, ReportsInvalidRecordingsInOneLine) {
  const auto loading = [&](const std::string& file, std::int32_t id, double from) {
    return [this, file, id, from] { static_cast<void>(loadRecording(folder / file, id, from)); };
  };
  EXPECT_THAT(loading("none.lcmlog", 3, 0),
              ThrowsMessage<std::runtime_error>(HasSubstr("none.lcmlog: there is no log")));
  EXPECT_THAT(
      loading("log.lcmlog", 5, 0),
      ThrowsMessage<std::runtime_error>(HasSubstr("no camera frame has robot 5; it has 3, 4")));
  EXPECT_THAT(loading("log.lcmlog", 3, 60),
              ThrowsMessage<std::runtime_error>(
                  HasSubstr("last seen 9.0 s after the start, so nothing is left from 60.0 s on")));
}

}  // namespace
}  // namespace lab::sim
