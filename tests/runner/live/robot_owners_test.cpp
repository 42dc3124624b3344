#include "runner/live/robot_owners.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <lab/robot_status_t.hpp>
#include <string>

namespace lab::runner::robot_owners_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

robot_status_t statusOf(const std::string& sender, std::int64_t instance, std::int64_t utime) {
  robot_status_t status{};
  status.sender = sender;
  status.instance = instance;
  status.utime = utime;
  status.robots.resize(1);
  status.robots[0].robot_id = 4;
  status.num_robots = 1;
  return status;
}

TEST(RobotOwners, ReportsARobotOfTwoServicesOnce) {
  RobotOwners dut;

  EXPECT_THAT(dut.take(statusOf("sim_svc", 1, 1'000'000)), IsEmpty());
  EXPECT_THAT(
      dut.take(statusOf("robot_bridge", 1, 1'500'000)),
      ElementsAre(HasSubstr("robot 4 has two owners, sim_svc (instance 1) and robot_bridge")));
  EXPECT_THAT(dut.take(statusOf("robot_bridge", 1, 1'600'000)), IsEmpty());
}

TEST(RobotOwners, AcceptsARestartedServiceAndAnOwnerThatReplacesASilentOne) {
  RobotOwners dut;

  EXPECT_THAT(dut.take(statusOf("sim_svc", 1, 1'000'000)), IsEmpty());
  EXPECT_THAT(dut.take(statusOf("sim_svc", 2, 1'100'000)), IsEmpty());
  EXPECT_THAT(dut.take(statusOf("robot_bridge", 1, 3'000'000)), IsEmpty());
}

}  // namespace
}  // namespace lab::runner::robot_owners_test
