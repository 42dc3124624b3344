#include "runner/live/robot_owners.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <lab/robot_status_t.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/math/units.hpp"

namespace lab::runner::robot_owners_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

robot_status_t statusOf(const std::string& sender, std::int64_t instance) {
  robot_status_t status{};
  status.sender = sender;
  status.instance = instance;
  status.robots.resize(1);
  status.robots[0].robot_id = 4;
  status.num_robots = 1;
  return status;
}

TEST(RobotOwners, ReportsARobotOfTwoServicesOnce) {
  RobotOwners dut;

  EXPECT_THAT(dut.take(statusOf("sim_svc", 1), 1'000'000), IsEmpty());
  EXPECT_THAT(
      dut.take(statusOf("robot_bridge", 1), 1'500'000),
      ElementsAre(HasSubstr("robot 4 has two owners, sim_svc (instance 1) and robot_bridge")));
  EXPECT_THAT(dut.take(statusOf("robot_bridge", 1), 1'600'000), IsEmpty());
}

TEST(RobotOwners, AcceptsARestartedServiceAndAnOwnerThatReplacesASilentOne) {
  RobotOwners dut;

  EXPECT_THAT(dut.take(statusOf("sim_svc", 1), 1'000'000), IsEmpty());
  EXPECT_THAT(dut.take(statusOf("sim_svc", 2), 1'100'000), IsEmpty());
  EXPECT_THAT(dut.take(statusOf("robot_bridge", 1), 3'000'000), IsEmpty());
}

/// The instance is the start time, and the stamps are of the service's clock.
class AfterAStepOfTheClock : public testing::TestWithParam<std::int64_t> {};

TEST_P(AfterAStepOfTheClock, ARestartedServiceIsTheSameOwner) {
  const std::int64_t step_us = GetParam();
  RobotOwners dut;
  std::int64_t now = 1'000'000'000'000;
  robot_status_t before = statusOf("sim_svc", now);
  robot_status_t after = statusOf("sim_svc", now + 5'000'000 + step_us);
  for (int i = 0; i < 10; ++i, now += 20'000) {
    before.utime = now;
    ASSERT_THAT(dut.take(before, now), IsEmpty());
  }
  for (int i = 0; i < 100; ++i, now += 20'000) {
    after.utime = now + step_us;
    ASSERT_THAT(dut.take(after, now), IsEmpty()) << "message " << i;
    // Two messages of the old instance come late.
    if (i < 2) {
      ASSERT_THAT(dut.take(before, now), IsEmpty());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Each, AfterAStepOfTheClock,
                         testing::Values(-3600 * units::kSecond_us, 0, 3600 * units::kSecond_us));

TEST(RobotOwners, FindsTwoServicesOfOneName) {
  RobotOwners dut;
  std::vector<std::string> found;
  for (std::int64_t now = 1'000'000; now < 4'000'000; now += 20'000) {
    for (const std::int64_t instance : {7, 3, 5}) {
      for (std::string& what : dut.take(statusOf("sim_svc", instance), now)) {
        found.push_back(std::move(what));
      }
    }
  }
  EXPECT_THAT(found, ElementsAre(HasSubstr("robot 4 has two owners, sim_svc (instance ")));
}

}  // namespace
}  // namespace lab::runner::robot_owners_test
