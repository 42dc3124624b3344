#include "analyzer/analyzer_service.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/loop/virtual_loop.hpp"

namespace lab::analysis {
namespace {

constexpr int kRobots = 7;

/// A lab in which seven robots drive straight under one program.
class AnalyzerServiceTest : public testing::Test {
 protected:
  AnalyzerServiceTest() {
    loop_.drainWith([this] { bus_.deliver(); });
    bus_.subscribe(channels::kAnalysis, [this](const Packet& packet) {
      analysis_t message{};
      ASSERT_TRUE(decode(packet.data, message));
      heard_[loop_.now()].push_back(message);
    });
    loop_.every(20'000, loop_.now(), [this] { publishRobots(); });
    source_.start();
    node_.start();
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
      state.program.kind = program_t::ABP;
      state.program.v = 0.03;
      state.program.epsilon = 0.5;
      state.program.eta = 3;
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
  Experiment experiment_;
  AnalyzerService dut_{{node_, loop_, experiment_, {}}};
  std::map<std::int64_t, std::vector<analysis_t>> heard_;
  std::int64_t frame_ = 0;
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
  EXPECT_EQ(last.program_name, "ABP");
  EXPECT_GT(last.observed, 1);
}

TEST(AnalyzerDescription, StartsWithoutAnExperiment) {
  const ServiceDescription dut = serviceDescription();

  EXPECT_EQ(dut.name, "analyzer");
  EXPECT_FALSE(dut.needs_experiment);
}

}  // namespace
}  // namespace lab::analysis
