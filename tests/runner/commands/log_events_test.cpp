#include "runner/commands/log_events.hpp"

#include <gtest/gtest.h>

#include <lab/robot_status_t.hpp>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::runner {
namespace {

TEST(ReplayClock, RunsAtItsSpeedAndStopsInAPause) {
  ReplayClock dut(1'000'000, 500, 2);
  EXPECT_EQ(dut.logTime(500), 1'000'000);
  EXPECT_EQ(dut.logTime(1500), 1'002'000);
  dut.pause(1500);
  EXPECT_TRUE(dut.paused());
  EXPECT_EQ(dut.logTime(9999), 1'002'000);
  dut.resume(10'000);
  EXPECT_EQ(dut.logTime(10'100), 1'002'200);
}

TEST(AsReplay, MarksTheOriginAndChangesNothingElse) {
  robot_status_t status{};
  status.sender = "sim_svc";
  status.seq = 12;
  robot_state_t robot{};
  robot.origin = robot_state_t::SIM;
  robot.robot_id = 4;
  status.robots.push_back(robot);
  status.num_robots = 1;
  robot_status_t replayed{};
  ASSERT_TRUE(decode(asReplay(std::string(channels::kRobotStatus), encode(status)), replayed));
  EXPECT_EQ(replayed.robots[0].origin, robot_state_t::REPLAY);
  replayed.robots[0].origin = robot_state_t::SIM;
  EXPECT_EQ(encode(replayed), encode(status));
}

TEST(AsReplay, ReturnsUnknownMessagesUnchanged) {
  const std::vector<std::uint8_t> bytes{1, 2, 3};
  EXPECT_EQ(asReplay("FOREIGN", bytes), bytes);
  EXPECT_EQ(asReplay(std::string(channels::kRobotStatus), bytes), bytes);
}

TEST(SelectEvents, OmitsChannelsThatThePlayerPublishesItself) {
  const TemporaryFolder folder;
  const std::filesystem::path log = folder / "log.lcmlog";
  {
    LogWriter writer(log);
    for (const auto channel : {channels::kExperimentStatus, channels::kRobotStatus,
                               channels::kExperimentCommand, channels::kExperimentEvent}) {
      writer.write({channel, {}, 7});
    }
  }
  std::vector<std::string> kept;
  for (const LogEvent& event : selectEvents({log}, {})) kept.push_back(event.channel);
  EXPECT_EQ(kept, (std::vector<std::string>{std::string(channels::kRobotStatus),
                                            std::string(channels::kExperimentEvent)}));
}

TEST(SelectEvents, ShortensGapsAndGoesOnWhereTheClockWasSetBack) {
  constexpr std::int64_t kSecond = 1'000'000;
  const TemporaryFolder folder;
  const std::filesystem::path log = folder / "log.lcmlog";
  {
    LogWriter writer(log);
    for (const std::int64_t second : {100, 101, 500, 501, 200, 201, 202}) {
      writer.write({channels::kRobotStatus, {}, second * kSecond});
    }
  }
  ShortenedGaps gaps;
  std::vector<std::int64_t> played;
  std::vector<std::int64_t> recorded;
  for (const LogEvent& event : selectEvents({log}, {}, &gaps)) {
    played.push_back(event.utime / kSecond);
    recorded.push_back(event.log_utime / kSecond);
  }
  EXPECT_EQ(played, (std::vector<std::int64_t>{100, 101, 111, 112, 112, 113, 114}));
  EXPECT_EQ(recorded, (std::vector<std::int64_t>{100, 101, 500, 501, 200, 201, 202}));
  EXPECT_EQ(gaps.gaps, 1);
  EXPECT_DOUBLE_EQ(gaps.longest, 399);
  EXPECT_EQ(gaps.steps_back, 1);
}

}  // namespace
}  // namespace lab::runner
