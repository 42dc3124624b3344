#include "runner/commands/log_events.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <lab/robot_status_t.hpp>
#include <stdexcept>
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

TEST(LogEvents, OmitsChannelsThatThePlayerPublishesItself) {
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
  const LogEvents dut({log});
  for (const LogEvent& event : dut.all()) kept.push_back(dut.channelOf(event));
  EXPECT_EQ(kept, (std::vector<std::string>{std::string(channels::kRobotStatus),
                                            std::string(channels::kExperimentEvent)}));
}

TEST(LogEvents, ReadsEachMessageWhenItIsAskedFor) {
  const TemporaryFolder folder;
  const std::filesystem::path first = folder / "log.lcmlog";
  const std::filesystem::path second = folder / "log.lcmlog.01";
  LogWriter(first).write({"A", std::vector<std::uint8_t>{1, 2, 3}, 7});
  {
    LogWriter writer(second);
    writer.write({"B", std::vector<std::uint8_t>{4}, 8});
    writer.write({"A", std::vector<std::uint8_t>{}, 9});
  }
  LogEvents dut({first, second});
  ASSERT_EQ(dut.all().size(), 3U);
  EXPECT_THAT(dut.messageOf(dut.all()[1]), testing::ElementsAre(4));
  EXPECT_THAT(dut.messageOf(dut.all()[0]), testing::ElementsAre(1, 2, 3));
  EXPECT_TRUE(dut.messageOf(dut.all()[2]).empty());
  EXPECT_TRUE(dut.has("A"));
  EXPECT_FALSE(dut.has("C"));
}

TEST(LogEvents, SaysThatALogHasBecomeShorter) {
  const TemporaryFolder folder;
  const std::filesystem::path log = folder / "log.lcmlog";
  {
    LogWriter writer(log);
    writer.write({"A", std::vector<std::uint8_t>(100'000), 7});
  }
  LogEvents dut({log});
  std::filesystem::resize_file(log, 50'000);
  EXPECT_THAT([&] { static_cast<void>(dut.messageOf(dut.all()[0])); },
              testing::ThrowsMessage<std::runtime_error>(testing::AllOf(
                  testing::HasSubstr("cannot go on reading the log " + log.string() + ": found "),
                  testing::HasSubstr("expected 100000; was it made shorter?"))));
  std::filesystem::resize_file(log, 110'000);
  EXPECT_EQ(dut.messageOf(dut.all()[0]).size(), 100'000U) << "it goes on when the file is back";
}

TEST(LogEvents, LeavesOutAndCountsWhatNoBusCarries) {
  const TemporaryFolder folder;
  const std::filesystem::path log = folder / "log.lcmlog";
  {
    LogWriter writer(log);
    writer.write({std::string(63, 'A'), {}, 1'000'000});
    writer.write({std::string(64, 'A'), {}, 2'000'000});
    writer.write({"B", std::vector<std::uint8_t>((16U << 20U) + 1), 3'000'000});
    writer.write({"C", {}, 4'000'000});
  }
  const LogEvents dut({log});
  ASSERT_EQ(dut.all().size(), 2U);
  EXPECT_EQ(dut.channelOf(dut.all()[1]), "C");
  EXPECT_EQ(dut.unsendable(), 2);
}

TEST(LogEvents, KnowsLengthAndChannelsOfTheWholeLog) {
  const TemporaryFolder folder;
  const std::filesystem::path log = folder / "log.lcmlog";
  {
    LogWriter writer(log);
    for (const std::int64_t second : {1, 4, 7}) {
      writer.write({second == 4 ? "B" : "A", {}, second * 1'000'000});
    }
    writer.write({channels::kExperimentStatus, {}, 7'500'000});
  }
  LogSelection selection;
  selection.from = 10;
  const LogEvents dut({log}, selection);
  EXPECT_TRUE(dut.all().empty());
  EXPECT_DOUBLE_EQ(dut.logLength(), 6.5);
  EXPECT_THAT(dut.logChannels(), testing::ElementsAre("A", "B"));
  EXPECT_TRUE(dut.hasSelectedChannel());
  selection.channels = {"C", "EXPERIMENT_STATUS"};
  EXPECT_FALSE(LogEvents({log}, selection).hasSelectedChannel());
  selection.channels = {"B", "C"};
  EXPECT_TRUE(LogEvents({log}, selection).hasSelectedChannel());
}

TEST(LogEvents, ManyGapsOfYearsStayInOrder) {
  constexpr std::int64_t kYears = 1'000'000'000'000'000;
  const TemporaryFolder folder;
  const std::filesystem::path log = folder / "log.lcmlog";
  {
    LogWriter writer(log);
    for (int i = 0; i < 20'000; ++i) {
      for (const std::int64_t later : {0, 1000, 2000}) {
        writer.write({"A", {}, (i % 2 == 0 ? 1'000'000 : kYears) + later});
      }
    }
  }
  LogSelection selection;
  selection.max_gap = 1e9;
  const LogEvents dut({log}, selection);
  EXPECT_EQ(dut.all().size(), 60'000U);
  EXPECT_GE(dut.all().front().utime, 0);
}

TEST(LogEvents, ShortensGapsAndGoesOnWhereTheClockWasSetBack) {
  constexpr std::int64_t kSecond = 1'000'000;
  const TemporaryFolder folder;
  const std::filesystem::path log = folder / "log.lcmlog";
  {
    LogWriter writer(log);
    for (const std::int64_t second : {100, 101, 500, 501, 200, 201, 202}) {
      writer.write({channels::kRobotStatus, {}, second * kSecond});
    }
  }
  std::vector<std::int64_t> played;
  std::vector<std::int64_t> recorded;
  const LogEvents dut({log});
  for (const LogEvent& event : dut.all()) {
    played.push_back(event.utime / kSecond);
    recorded.push_back(event.log_utime / kSecond);
  }
  EXPECT_EQ(played, (std::vector<std::int64_t>{100, 101, 111, 112, 112, 113, 114}));
  EXPECT_EQ(recorded, (std::vector<std::int64_t>{100, 101, 500, 501, 200, 201, 202}));
  EXPECT_EQ(dut.gaps().gaps, 1);
  EXPECT_DOUBLE_EQ(dut.gaps().longest, 399);
  EXPECT_EQ(dut.gaps().steps_back, 1);
}

}  // namespace
}  // namespace lab::runner
