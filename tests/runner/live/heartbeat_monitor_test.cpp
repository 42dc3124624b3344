#include "runner/live/heartbeat_monitor.hpp"

#include <gtest/gtest.h>

namespace lab::runner::heartbeat_monitor_test {
namespace {

constexpr std::int64_t kStep_us = 100'000;
constexpr std::int64_t kSecond_us = 1'000'000;

class HeartbeatMonitorTest : public testing::Test {
 protected:
  /// Checks every 100 ms, while the services in `alive` send a heartbeat every second.
  void pass(double seconds, const std::vector<std::string>& alive) {
    for (const std::int64_t end = now + static_cast<std::int64_t>(seconds * 1e6); now < end;) {
      now += kStep_us;
      if (now % kSecond_us == 0) {
        for (const std::string& name : alive) dut.beat(name);
      }
      for (const auto& change : dut.look(now)) changes.push_back(change);
    }
  }

  HeartbeatMonitor dut;
  std::int64_t now = 1'000 * kSecond_us;
  std::vector<HeartbeatMonitor::Change> changes;
};

TEST_F(HeartbeatMonitorTest, ReportsSilenceAndReturnOnce) {
  dut.expect("sim_svc");
  dut.expect("analyzer");
  pass(5, {"sim_svc", "analyzer"});
  EXPECT_TRUE(changes.empty());

  pass(3.3, {"analyzer"});
  EXPECT_TRUE(changes.empty());
  pass(3.7, {"analyzer"});
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].name, "sim_svc");
  EXPECT_TRUE(changes[0].silent);
  EXPECT_EQ(changes[0].silence_s, 3);

  pass(2, {"sim_svc", "analyzer"});
  ASSERT_EQ(changes.size(), 2U);
  EXPECT_EQ(changes[1].name, "sim_svc");
  EXPECT_FALSE(changes[1].silent);
  EXPECT_EQ(changes[1].silence_s, 8);
}

TEST_F(HeartbeatMonitorTest, TwoLostHeartbeatsAreNoSilence) {
  dut.expect("sim_svc");
  for (int round = 0; round < 20; ++round) {
    pass(1, {"sim_svc"});
    pass(2, {});
  }
  EXPECT_TRUE(changes.empty());
}

TEST_F(HeartbeatMonitorTest, StallsOfTheMonitorDoNotCountAsSilence) {
  dut.expect("sim_svc");
  pass(5, {"sim_svc"});

  for (int stall = 0; stall < 5; ++stall) {
    now += 60 * kSecond_us;
    pass(0.5, {});
  }
  EXPECT_TRUE(changes.empty());

  pass(4, {});
  EXPECT_EQ(changes.size(), 1U) << "it is still monitored";
}

TEST_F(HeartbeatMonitorTest, AStartingProcessHasALongerTimeout) {
  dut.expect("tracker_svc");
  pass(9.5, {});
  EXPECT_TRUE(changes.empty());
  pass(1, {});
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].silence_s, 10);
}

TEST_F(HeartbeatMonitorTest, ARestartedServiceIsNotSilent) {
  dut.expect("sim_svc");
  pass(1, {"sim_svc"});
  pass(4, {});
  ASSERT_EQ(changes.size(), 1U);
  dut.expect("sim_svc");
  pass(5, {});
  EXPECT_EQ(changes.size(), 1U);
}

}  // namespace
}  // namespace lab::runner::heartbeat_monitor_test
