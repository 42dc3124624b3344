#include "analyzer/analyzer_service.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/collective_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/service_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/loop/virtual_loop.hpp"
#include "tests/support/programs.hpp"

namespace lab::analysis {
namespace {

constexpr int kRobots = 7;

/// A lab in which seven robots drive straight under one program.
class AnalyzerServiceTest : public testing::Test {
 protected:
  AnalyzerServiceTest() {
    loop_.drainWith([this] {
      if (!overloaded_) bus_.deliver();
    });
    bus_.subscribe(channels::kServiceStatus, [this](const Packet& packet) {
      service_status_t status{};
      ASSERT_TRUE(decode(packet.data, status));
      if (status.sender == "analyzer") beats_.push_back(status);
    });
    bus_.subscribe(channels::kAnalysis, [this](const Packet& packet) {
      analysis_t message{};
      ASSERT_TRUE(decode(packet.data, message));
      heard_[loop_.now()].push_back(message);
    });
    bus_.subscribe(channels::kCollective, [this](const Packet& packet) {
      collective_t message{};
      ASSERT_TRUE(decode(packet.data, message));
      crowds_[loop_.now()].push_back(message);
    });
    loop_.every(20'000, loop_.now(), [this] { publishRobots(); });
    source_.start();
    node_.start();
  }

  /// For `time`, messages wait; then all of them arrive at once.
  void overloadFor(std::int64_t time) {
    overloaded_ = true;
    loop_.runUntil(loop_.now() + time);
    overloaded_ = false;
    bus_.deliver();
  }

  [[nodiscard]] std::size_t heardIn(std::int64_t from, std::int64_t to) const {
    std::size_t count = 0;
    for (const auto& [utime, all] : heard_) {
      if (from <= utime && utime < to) count += all.size();
    }
    return count;
  }

  void publishRobots() {
    tracked_frame_t frame{};
    robot_status_t status{};
    frame.frame = ++frame_;
    for (int id = 1; id <= kRobots; ++id) {
      tracked_pose_t pose{};
      pose.robot_id = id;
      pose.x = 0.1 + 0.0006 * static_cast<double>(frame_);
      pose.confidence = 1;
      frame.robots.push_back(pose);
      robot_state_t state{};
      state.utime = loop_.now();
      state.robot_id = id;
      state.program = toId(program_);
      state.program_epoch = 1;
      state.program_start_utime = VirtualLoop::kEpoch;
      status.robots.push_back(state);
    }
    frame.num_robots = status.num_robots = kRobots;
    source_.publish(channels::kTrackedFrame, frame);
    source_.publish(channels::kRobotStatus, status);
  }

  VirtualLoop loop_;
  MemoryBus bus_{[this] { return loop_.now(); }};
  Node source_{bus_, loop_, {"sim_svc", 2, 1}};
  Node node_{bus_, loop_, {"analyzer", 0, 1}};
  Program program_ = test::abp(0.03, 0.5, 3);
  Experiment experiment_ = [this] {
    Experiment experiment;
    experiment.programs[program_.name] = program_;
    return experiment;
  }();
  AnalyzerService dut_{{node_, loop_, experiment_, {}}};
  std::map<std::int64_t, std::vector<analysis_t>> heard_;
  std::map<std::int64_t, std::vector<collective_t>> crowds_;
  std::vector<service_status_t> beats_;
  std::int64_t frame_ = 0;
  bool overloaded_ = false;
};

TEST_F(AnalyzerServiceTest, PublishesEachRobotAndThePoolOnceASecond) {
  loop_.runUntil(VirtualLoop::kEpoch + 12'000'000 - 1);

  std::map<std::int32_t, int> messages;
  for (const auto& [utime, all] : heard_) {
    if (utime < VirtualLoop::kEpoch + 2'000'000) continue;
    for (const analysis_t& one : all) ++messages[one.robot_id];
  }
  ASSERT_EQ(messages.size(), kRobots + 1U);
  for (const auto& [robot, count] : messages) EXPECT_EQ(count, 10) << robot;
  EXPECT_EQ(messages.count(analysis_t::POOL), 1U);
}

TEST_F(AnalyzerServiceTest, PublishesTheCrowdOfAllRobotsAndOfTheProgramOnceASecond) {
  loop_.runUntil(VirtualLoop::kEpoch + 12'000'000 - 1);

  std::map<std::string, int> messages;
  for (const auto& [utime, all] : crowds_) {
    if (utime < VirtualLoop::kEpoch + 2'000'000) continue;
    EXPECT_EQ(all.size(), 1U) << "together at " << utime;
    EXPECT_EQ(heard_.count(utime), 0U) << "together with ANALYSIS at " << utime;
    for (const collective_t& one : all) ++messages[one.program.name];
  }
  EXPECT_EQ(messages, (std::map<std::string, int>{{"", 10}, {"abp", 10}}));
  const collective_t& last = crowds_.rbegin()->second.back();
  EXPECT_GE(last.utime, loop_.now() - 1'500'000);
  EXPECT_EQ(last.robots, kRobots);
}

TEST_F(AnalyzerServiceTest, SpreadsItsMessagesOverTheSecond) {
  loop_.runUntil(VirtualLoop::kEpoch + 12'000'000);

  ASSERT_FALSE(heard_.empty());
  for (const auto& [utime, all] : heard_) EXPECT_EQ(all.size(), 1U) << utime;
}

TEST_F(AnalyzerServiceTest, StampsMessagesWithTheLastFrameUsed) {
  loop_.runUntil(VirtualLoop::kEpoch + 3'000'000);

  const analysis_t& last = heard_.rbegin()->second.back();
  EXPECT_LE(last.utime, heard_.rbegin()->first);
  EXPECT_GE(last.utime, heard_.rbegin()->first - 1'000'000);
  EXPECT_EQ(last.program.name, "abp");
  EXPECT_GT(last.observed, 1);
}

TEST_F(AnalyzerServiceTest, ComputesNoResultsWhileFramesWaitAndLeavesNoneOut) {
  loop_.runUntil(VirtualLoop::kEpoch + 6'100'000);
  const std::int64_t begin = loop_.now();

  overloadFor(4'000'000);
  const std::int64_t end = loop_.now();
  loop_.runUntil(end + 3'000'000);

  // What it sent meanwhile arrived at the end: the rest of one round, and none of a second.
  EXPECT_LE(heardIn(begin, end + 1), kRobots + 1U);
  EXPECT_GE(heardIn(end + 1, loop_.now()), 2U * (kRobots + 1U));
  ASSERT_FALSE(beats_.empty());
  EXPECT_EQ(beats_.back().last_error,
            "overloaded: results are computed every 4 s only, from all samples; the report is "
            "computed from the log and is complete");
  for (const stream_count_t& row : beats_.back().received) EXPECT_EQ(row.lost, 0) << row.sender;
  EXPECT_NEAR(heard_.rbegin()->second.back().observed, 12, 1);
}

TEST_F(AnalyzerServiceTest, LeavesOutFramesThatWaitTooLongAndCountsThem) {
  loop_.runUntil(VirtualLoop::kEpoch + 6'100'000);

  overloadFor(9'000'000);
  loop_.runUntil(loop_.now() + 3'000'000);

  ASSERT_FALSE(beats_.empty());
  constexpr std::int64_t kLeftOut = 425;  // of 9 s at 50 frames/s, all but the last half second
  std::int64_t counted = 0;
  for (const stream_count_t& row : beats_.back().received) {
    if (row.lost == 0) continue;
    EXPECT_EQ(row.channel, channels::kTrackedFrame);
    EXPECT_EQ(row.sender, "left out of the live results: overload");
    EXPECT_GE(row.received + row.lost, frame_ - 50) << "a second ago";
    EXPECT_LE(row.received + row.lost, frame_);
    counted += row.lost;
  }
  EXPECT_GE(counted, kLeftOut - 2);
  EXPECT_LE(counted, kLeftOut + 2);
  EXPECT_THAT(beats_.back().last_error,
              testing::MatchesRegex("overloaded: results are computed every 9 s only, from all but "
                                    "[0-9]+ of [0-9]+ camera frames; the report is computed from "
                                    "the log and is complete"));
  EXPECT_GE(beats_.back().utime, loop_.now() - 1'100'000);
  const analysis_t& last = heard_.rbegin()->second.back();
  EXPECT_GE(last.utime, loop_.now() - 1'500'000) << "it goes on";
  EXPECT_NEAR(last.observed, 18 - 0.02 * kLeftOut, 1.5);
}

TEST(AnalyzerDescription, StartsWithoutAnExperiment) {
  const ServiceDescription dut = serviceDescription();

  EXPECT_EQ(dut.name, "analyzer");
  EXPECT_FALSE(dut.needs_experiment);
}

}  // namespace
}  // namespace lab::analysis
