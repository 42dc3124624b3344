// External inputs of the world: motors, calibrations, kinematic disks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "common/math/random.hpp"
#include "tests/support/world_fixture.hpp"

namespace lab::sim::world_outside_test {
namespace {

std::vector<RobotSetup> externalAt(double x, double y, double theta) {
  std::vector<RobotSetup> setups = robotAt(x, y, theta);
  setups[0].external = true;
  return setups;
}

bool sameBits(const dynamics::Pose& a, const dynamics::Pose& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

double distance(Vec a, const dynamics::Pose& b) { return std::hypot(a.x - b.x, a.y - b.y); }

constexpr double kStep = 0.27 / 255;  // m/s of one duty

TEST(WorldMotors, ChangesTakeEffectAtTheirExactTimes) {
  World dut(idealHardware(), externalAt(0.3, 0.45, 0));
  dut.setMotors(0, {1003, 100, 100});
  dut.setMotors(0, {13457, 200, 200});
  dut.setMotors(0, {1234567, 0, 0});
  dut.advanceTo(2 * kSecond);
  const double driven =
      100 * kStep * (13457 - 1003) * 1e-6 + 200 * kStep * (1234567 - 13457) * 1e-6;
  EXPECT_NEAR(dut.pose(0).x, 0.3 + driven, 1e-12);
}

TEST(WorldMotors, DoNotDependOnTheStepsOfTheWorld) {
  WorldSettings fine = idealHardware();
  fine.tick_us = 700;
  World a(idealHardware(), externalAt(0.6, 0.45, 1));
  World b(fine, externalAt(0.6, 0.45, 1));
  for (World* world : {&a, &b}) {
    for (std::int64_t at = 333; at < kSecond; at += 7919) {
      const auto duty = static_cast<std::int16_t>(at % 511 - 255);
      world->setMotors(0, {at, duty, static_cast<std::int16_t>(-duty / 2)});
    }
    world->advanceTo(kSecond);
  }
  EXPECT_NEAR(a.pose(0).x, b.pose(0).x, 1e-12);
  EXPECT_NEAR(a.pose(0).y, b.pose(0).y, 1e-12);
  EXPECT_NEAR(a.pose(0).theta, b.pose(0).theta, 1e-11);
}

TEST(WorldMotors, ALateChangeTakesEffectNow) {
  World dut(idealHardware(), externalAt(0.3, 0.45, 0));
  dut.advanceTo(kSecond);
  dut.setMotors(0, {500'000, 100, 100});
  dut.advanceTo(2 * kSecond);
  EXPECT_NEAR(dut.pose(0).x, 0.3 + 100 * kStep, 1e-12);
}

TEST(WorldMotors, WheelsStandInTheDeadBandAndReachFullSpeedAtFullDuty) {
  WorldSettings settings = idealHardware();
  settings.motor_dead_band = 0.2;  // 51 of 255
  for (const auto& [duty, speed] : std::vector<std::pair<std::int16_t, double>>{
           {51, 0}, {-51, 0}, {153, 0.135}, {-153, -0.135}, {255, 0.27}}) {
    World dut(settings, externalAt(0.6, 0.45, 0));
    dut.setMotors(0, {0, duty, duty});
    dut.advanceTo(kSecond);
    EXPECT_NEAR(dut.pose(0).x, 0.6 + speed, 1e-12) << duty;
  }
}

TEST(WorldMotors, ErrorsDifferBetweenRobotsAndBelongToTheRobotsId) {
  WorldSettings settings = idealHardware();
  settings.arena = {10, 10};
  settings.wheel_gain_error = 0.05;
  settings.wheel_base_error = 0.05;
  const auto turned = [&](int n) {
    std::vector<RobotSetup> setups = robots(n);
    for (RobotSetup& setup : setups) setup.external = true;
    World world(settings, setups);
    std::vector<double> angles;
    for (std::size_t i = 0; i < world.size(); ++i) {
      angles.push_back(-world.pose(i).theta);
      world.setMotors(i, {0, -100, 100});
    }
    world.advanceTo(kSecond);
    for (std::size_t i = 0; i < world.size(); ++i) angles[i] += world.pose(i).theta;
    return angles;
  };
  const auto few = turned(3);
  const auto more = turned(4);
  const double ideal = 2 * 100 * kStep / settings.wheel_base;
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_EQ(few[i], more[i]);
    EXPECT_NE(few[i], ideal);
    EXPECT_NEAR(few[i], ideal, 0.3 * ideal);
  }
  EXPECT_NE(few[0], few[1]);
}

/// Drives a robot with its own core straight for a second and returns the distance.
double drivenBy(WorldSettings settings, const dynamics::WheelCalibration& calibration) {
  World world(settings, robotAt(0.4, 0.45, 0));
  world.setCalibration(0, calibration, calibration, 0.08);
  EXPECT_EQ(world.storedWheelBase(0), 0.08);
  startAll(world, always(wheelsProgram(0.1, 0.1)));
  const StepLight light(0.6, 0.5, 0.5);
  world.setLight(&light);
  world.advanceTo(kSecond);
  const double before = world.pose(0).x;
  world.advanceTo(2 * kSecond);
  return world.pose(0).x - before;
}

TEST(WorldCalibration, ACorrectCalibrationMakesARobotDriveAtTheOrderedSpeed) {
  WorldSettings settings = idealHardware();
  settings.motor_dead_band = 0.2;
  const double wrong = drivenBy(settings, {});
  EXPECT_LT(wrong, 0.08);
  dynamics::WheelCalibration right;
  right.dead_band = 51;
  EXPECT_NEAR(drivenBy(settings, right), 0.1, 1e-9);
  settings.pwm_steps = true;
  EXPECT_NEAR(drivenBy(settings, right), 0.1, 0.27 / (255 - 51) / 2);
  right.gain_ppm = 900000;  // lower than the true gain
  EXPECT_NEAR(drivenBy(settings, right), 0.1 / 0.9, 0.27 / (255 - 51) / 2);
}

TEST(WorldKinematicDisks, AreSensedAtTheirPositionsUnlessHidden) {
  World dut(idealHardware(), externalAt(0.6, 0.45, 0));
  EXPECT_EQ(dut.measure(0).ir[0], 0);
  const std::size_t disk = dut.addKinematicDisk();
  EXPECT_EQ(dut.measure(0).ir[0], 0);
  dut.moveKinematicDisk(disk, {0.6 + 0.075 + 0.025, 0.45});
  EXPECT_NEAR(dut.measure(0).ir[0], 1023 / 2.0, 1);
  EXPECT_EQ(dut.measure(0).ir[3], 0);
  dut.moveKinematicDisk(disk, {0.6 - 0.075 - 0.025, 0.45});
  EXPECT_EQ(dut.measure(0).ir[0], 0);
  EXPECT_NEAR(dut.measure(0).ir[3], 1023 / 2.0, 1);
  dut.hideKinematicDisk(disk);
  EXPECT_EQ(dut.measure(0).ir[3], 0);
  dut.moveKinematicDisk(disk, {0.6 - 0.075 - 0.025, 0.45});
  EXPECT_NE(dut.measure(0).ir[3], 0);
  dut.moveKinematicDisk(disk, {std::nan(""), 0.45});
  dut.moveKinematicDisk(disk, {1e300, -1e300});
  EXPECT_EQ(dut.measure(0).ir[3], 0);
  dut.advanceTo(kSecond);
}

TEST(WorldKinematicDisks, StopARobotThatDrivesIntoThem) {
  World dut(idealHardware(), externalAt(0.3, 0.45, 0));
  dut.moveKinematicDisk(dut.addKinematicDisk(), {0.6, 0.45});
  dut.setMotors(0, {0, 255, 255});
  dut.advanceTo(3 * kSecond);
  EXPECT_NEAR(dut.pose(0).x, 0.6 - 0.075, 1e-6);
  EXPECT_TRUE(dut.state(0).contact_robot);
  EXPECT_EQ(dut.collisions(), 1);
}

TEST(WorldKinematicDisks, PushARobotOutAlongTheLineOfCentres) {
  World dut(idealHardware(), externalAt(0.6, 0.45, 2));
  const std::size_t disk = dut.addKinematicDisk();
  const Vec centre = {0.6 - 0.03, 0.45 - 0.04};  // 5 cm off: 2.5 cm too near
  dut.moveKinematicDisk(disk, centre);
  EXPECT_NEAR(distance(centre, dut.pose(0)), 0.075, 1e-6);
  EXPECT_NEAR(dut.pose(0).x, 0.6 + 0.025 * 0.6, 1e-6);
  EXPECT_NEAR(dut.pose(0).y, 0.45 + 0.025 * 0.8, 1e-6);
  EXPECT_EQ(dut.pose(0).theta, 2);
  EXPECT_EQ(dut.state(0).robot_contacts, 1);
}

TEST(WorldKinematicDisks, PushOutARobotAtTheSamePosition) {
  World dut(idealHardware(), externalAt(0.6, 0.45, 0));
  dut.moveKinematicDisk(dut.addKinematicDisk(), {0.6, 0.45});
  EXPECT_NEAR(dut.pose(0).x, 0.6 + 0.075, 1e-6);
}

TEST(WorldKinematicDisks, OfRobotsThatStopWallsAndRobotsLimitThePushWhichContinuesLater) {
  // Two robots side by side: the right one blocks the left one.
  std::vector<RobotSetup> setups = {{1, dynamics::Pose{0.5, 0.45, 0}, true},
                                    {2, dynamics::Pose{0.58, 0.45, 0}, true}};
  WorldSettings settings = idealHardware();
  settings.contact = ContactRule::kStop;
  World dut(settings, setups);
  dut.moveKinematicDisk(dut.addKinematicDisk(), {0.44, 0.45});
  EXPECT_NEAR(dut.pose(0).x, 0.58 - 0.075, 1e-6) << "as far as the other robot allows";
  EXPECT_EQ(dut.pose(1).x, 0.58) << "a push is not transferred";
  dut.setMotors(1, {0, 100, 100});
  dut.advanceTo(kSecond);
  EXPECT_NEAR(dut.pose(0).x, 0.44 + 0.075, 1e-6);

  World corner(settings, externalAt(0.04, 0.45, 0));
  corner.moveKinematicDisk(corner.addKinematicDisk(), {0.09, 0.45});
  EXPECT_NEAR(corner.pose(0).x, 0.0375, 1e-6);
}

TEST(WorldKinematicDisks, PushARobotTogetherWithThoseThatItTouches) {
  std::vector<RobotSetup> setups = {{1, dynamics::Pose{0.5, 0.45, 0}, true},
                                    {2, dynamics::Pose{0.58, 0.45, 0}, true}};
  World dut(idealHardware(), setups);
  dut.moveKinematicDisk(dut.addKinematicDisk(), {0.44, 0.45});
  EXPECT_NEAR(dut.pose(0).x, 0.44 + 0.075, 1e-6);
  EXPECT_NEAR(dut.pose(1).x, 0.44 + 0.150, 2e-6);
  EXPECT_TRUE(dut.state(1).contact_robot);
}

TEST(WorldKinematicDisks, HoldARobotAtAWallWhichDoesNotYield) {
  World dut(idealHardware(), externalAt(0.04, 0.45, 0));
  const std::size_t disk = dut.addKinematicDisk();
  dut.moveKinematicDisk(disk, {0.09, 0.45});
  EXPECT_NEAR(dut.pose(0).x, 0.0375, 1e-6);
  dut.advanceTo(kSecond);
  EXPECT_NEAR(dut.pose(0).x, 0.0375, 1e-6);
  EXPECT_TRUE(dut.state(0).contact_wall);
  EXPECT_TRUE(dut.state(0).contact_robot);
  dut.moveKinematicDisk(disk, {0.09, 0.49});  // beyond the cones of friction
  dut.advanceTo(2 * kSecond);
  // It comes out at the side; pushes by pieces leave a gap where they turn it around the disk.
  EXPECT_NEAR(distance({0.09, 0.49}, dut.pose(0)), 0.075, 1e-5);
  EXPECT_GE(distance({0.09, 0.49}, dut.pose(0)), 0.075 - 1e-6);
}

TEST(WorldKinematicDisks, MayBePutAnywhereOnACrowdWhichStaysInside) {
  WorldSettings settings;
  World dut(settings, robots(100));
  dynamics::CoreSettings core = always(abpProgram(0.1));
  core.reversal.enabled = false;
  startAll(dut, core);
  std::vector<std::size_t> disks;
  for (int k = 0; k < 8; ++k) disks.push_back(dut.addKinematicDisk());
  Random random(5);
  for (int frame = 0; frame < 400; ++frame) {
    dut.advanceTo(frame * 50'000);
    for (const std::size_t disk : disks) {
      if (frame % 20 != 0) continue;
      dut.moveKinematicDisk(disk, {1.3 * random.uniform() - 0.05, random.uniform() - 0.05});
    }
    for (std::size_t i = 0; i < dut.size(); ++i) {
      const dynamics::Pose a = dut.pose(i);
      ASSERT_TRUE(std::isfinite(a.theta)) << frame;
      ASSERT_GE(std::min(a.x, 1.2 - a.x), 0.0375 - 1e-6) << frame;
      ASSERT_GE(std::min(a.y, 0.9 - a.y), 0.0375 - 1e-6) << frame;
      for (std::size_t j = 0; j < i; ++j) {
        ASSERT_GE(distance({a.x, a.y}, dut.pose(j)), 0.075 - 1e-6) << frame;
      }
    }
  }
}

TEST(WorldKinematicDisks, AndExternalRobotsDoNotChangeTheDrawsOfOthers) {
  WorldSettings settings;
  settings.arena = {20, 20};
  settings.wheel_gain_error = 0.02;
  settings.speed_noise = 0.002;
  World few(settings, robots(3));
  std::vector<RobotSetup> setups = robots(3);
  setups.push_back({4, std::nullopt, true});
  World more(settings, setups);
  more.moveKinematicDisk(more.addKinematicDisk(), {19.9, 19.9});
  more.setMotors(3, {5000, 100, -100});
  for (World* world : {&few, &more}) {
    startAll(*world, always(abpProgram()));
    world->advanceTo(30 * kSecond);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(sameBits(few.pose(i), more.pose(i))) << i;
  }
}

TEST(WorldKinematicDisks, NeverOverlapARobotThatCanYield) {
  WorldSettings settings;
  World dut(settings, robots(12));
  startAll(dut, always(abpProgram(0.1)));
  const StepLight light(0.6, 0.5, 0.5);
  dut.setLight(&light);
  const std::size_t disk = dut.addKinematicDisk();
  int overlaps = 0;
  int frames = 0;
  // A real robot crosses the crowd at 20 cm/s, with 50 camera frames per second.
  for (std::int64_t at = 0; at < 60 * kSecond; at += 20'000) {
    dut.advanceTo(at);
    const double phase = static_cast<double>(at) * 1e-6;
    const Vec centre = {0.6 + 0.5 * std::sin(0.4 * phase), 0.45 + 0.35 * std::cos(0.29 * phase)};
    dut.moveKinematicDisk(disk, centre);
    for (std::size_t i = 0; i < dut.size(); ++i) {
      ++frames;
      overlaps += distance(centre, dut.pose(i)) < 0.075 - 1e-6 ? 1 : 0;
      EXPECT_GE(dut.pose(i).x, 0.0375 - 1e-6);
      EXPECT_LE(dut.pose(i).x, 1.2 - 0.0375 + 1e-6);
    }
    for (std::size_t i = 0; i < dut.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_GE(distance({dut.pose(i).x, dut.pose(i).y}, dut.pose(j)), 0.075 - 1e-6);
      }
    }
  }
  EXPECT_GT(dut.collisions(), 0);
  // A robot can only be unable to move at walls and in crowds.
  EXPECT_LT(overlaps, frames / 100);
}

}  // namespace
}  // namespace lab::sim::world_outside_test
