// Robots that slide and push, compared with what follows by hand from the model: velocities are
// those of the wheels plus mobility times contact force, no overlap, Coulomb's friction.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <vector>

#include "tests/support/world_fixture.hpp"

namespace lab::sim::world_contact_test {
namespace {

constexpr double kRadius = 0.0375;
constexpr std::int16_t kDuty = 85;
constexpr double kSpeed = 0.09;                    // m/s of that duty
constexpr double kTouching = 2 * kRadius + 1e-12;  // m, so that rounding is no overlap
constexpr double kPi = std::numbers::pi;

/// Robots whose motors the test drives.
std::vector<RobotSetup> driven(const std::vector<dynamics::Pose>& poses) {
  std::vector<RobotSetup> setups;
  for (const dynamics::Pose& pose : poses) {
    setups.push_back({static_cast<std::int32_t>(setups.size() + 1), pose, true});
  }
  return setups;
}

WorldSettings hardware(double friction, const SlipMobility& slip = {}) {
  WorldSettings settings = idealHardware();
  settings.contact_friction = friction;
  settings.slip = slip;
  return settings;
}

void drive(World& world, std::size_t i, std::int16_t left, std::int16_t right) {
  world.setMotors(i, {world.timeUs(), left, right});
}

dynamics::Pose change(const dynamics::Pose& from, const dynamics::Pose& to) {
  return {to.x - from.x, to.y - from.y, to.theta - from.theta};
}

double gap(const World& world, std::size_t i, std::size_t j) {
  return std::hypot(world.pose(i).x - world.pose(j).x, world.pose(i).y - world.pose(j).y) -
         2 * kRadius;
}

bool sameBits(const dynamics::Pose& a, const dynamics::Pose& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// The mean velocity of each robot over a short time from now.
std::vector<dynamics::Pose> velocities(World& world, std::int64_t time_us = 1000) {
  std::vector<dynamics::Pose> before;
  for (std::size_t i = 0; i < world.size(); ++i) before.push_back(world.pose(i));
  world.advanceTo(world.timeUs() + time_us);
  const double dt = static_cast<double>(time_us) * 1e-6;
  std::vector<dynamics::Pose> velocities;
  for (std::size_t i = 0; i < world.size(); ++i) {
    const dynamics::Pose moved = change(before[i], world.pose(i));
    velocities.push_back({moved.x / dt, moved.y / dt, moved.theta / dt});
  }
  return velocities;
}

TEST(WorldContact, TwoEqualRobotsHeadOnStand) {
  World dut(hardware(0.2), driven({{0.4, 0.45, 0}, {0.8, 0.45, kPi}}));
  drive(dut, 0, kDuty, kDuty);
  drive(dut, 1, kDuty, kDuty);
  dut.advanceTo(10 * kSecond);
  EXPECT_NEAR(dut.pose(0).x, 0.6 - kRadius, 1e-6);
  EXPECT_NEAR(dut.pose(1).x, 0.6 + kRadius, 1e-6);
  EXPECT_NEAR(dut.pose(0).y, 0.45, 1e-9);
  EXPECT_NEAR(dut.pose(0).theta, 0, 1e-9);
  EXPECT_TRUE(dut.state(0).contact_robot);
  EXPECT_TRUE(dut.state(1).contact_robot);
  EXPECT_FALSE(dut.state(0).contact_wall);
  EXPECT_EQ(dut.collisions(), 1);
  EXPECT_NEAR(dut.velocity(0).linear.x, 0, 1e-9);
}

TEST(WorldContact, TheFasterOfTwoRobotsHeadOnPushesTheOtherBack) {
  World dut(hardware(0.2), driven({{0.3, 0.45, 0}, {0.3 + 2 * kRadius, 0.45, kPi}}));
  drive(dut, 0, 90, 90);
  drive(dut, 1, 30, 30);
  dut.advanceTo(2 * kSecond);
  EXPECT_NEAR(dut.pose(0).x, 0.3 + 2 * (90 - 30) / 2 * 0.27 / 255, 1e-6);
  EXPECT_NEAR(gap(dut, 0, 1), 0, 1e-6);
  EXPECT_NEAR(dut.velocity(1).linear.x, 30 * 0.27 / 255, 1e-6) << "it drives back";
}

TEST(WorldContact, APushedRobotMovesByItsMobility) {
  // A force F slows the driven robot by F and moves the standing one by a F, a its mobility across
  // the wheels: v - F = a F.
  for (const double across : {1.0, 0.25}) {
    World dut(hardware(0.2, {across, 1}), driven({{0.3, 0.45, 0}, {0.375, 0.45, kPi / 2}}));
    drive(dut, 0, kDuty, kDuty);
    dut.advanceTo(2 * kSecond);
    const double speed = kSpeed * across / (1 + across);
    EXPECT_NEAR(dut.pose(0).x, 0.3 + 2 * speed, 1e-5) << across;
    EXPECT_NEAR(dut.pose(1).x, 0.375 + 2 * speed, 1e-5) << across;
  }
}

TEST(WorldContact, ARowIsPushedAtTheSpeedDividedByTheNumberOfRobots) {
  World dut(hardware(0.2),
            driven({{0.3, 0.45, 0}, {0.375, 0.45, 1}, {0.45, 0.45, 2}, {0.525, 0.45, 3}}));
  drive(dut, 0, kDuty, kDuty);
  dut.advanceTo(2 * kSecond);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(dut.pose(i).x, 0.3 + 0.075 * static_cast<double>(i) + 2 * kSpeed / 4, 1e-5);
  }
}

TEST(WorldContact, WheelsTurnAsDrivenWhileTheBodySlips) {
  World dut(idealHardware(), robotAt(1.1, 0.45, 0));
  dynamics::CoreSettings blind = always(wheelsProgram(0.1, 0.1));
  blind.reversal.enabled = false;
  startAll(dut, blind);
  dut.advanceTo(10 * kSecond);
  EXPECT_NEAR(dut.pose(0).x, 1.2 - kRadius, 1e-6);
  EXPECT_NEAR(dut.state(0).wheel_left, 0.1, 1e-12);
  EXPECT_NEAR(dut.velocity(0).linear.x, 0, 1e-6);
  EXPECT_TRUE(dut.state(0).contact_wall);
  EXPECT_EQ(dut.state(0).wall_contacts, 1);
}

TEST(WorldContact, ARobotSlidesAlongAWallAtTheCosineOfItsAngle) {
  for (const double angle : {0.2, 0.6, 1.2}) {
    World dut(hardware(0), driven({{0.3, 0.9 - kRadius, angle}}));
    drive(dut, 0, kDuty, kDuty);
    dut.advanceTo(2 * kSecond);
    EXPECT_NEAR(dut.pose(0).x, 0.3 + 2 * kSpeed * std::cos(angle), 1e-6) << angle;
    EXPECT_NEAR(dut.pose(0).y, 0.9 - kRadius, 1e-6);
    EXPECT_EQ(dut.pose(0).theta, angle) << "nothing turns it";
  }
}

TEST(WorldContact, WheelsThatHardlySlipAcrossHoldARobotAtAWall) {
  // The force on the wall is v sin / (sin^2 + a cos^2); it also slows the robot down along x.
  const double angle = 0.6;
  for (const double across : {0.5, 0.05}) {
    World dut(hardware(0, {across, 1}), driven({{0.3, 0.9 - kRadius, angle}}));
    drive(dut, 0, kDuty, kDuty);
    dut.advanceTo(2 * kSecond);
    const double sine2 = std::sin(angle) * std::sin(angle);
    const double speed = kSpeed * std::cos(angle) * across / (sine2 + across * (1 - sine2));
    EXPECT_NEAR(dut.pose(0).x, 0.3 + 2 * speed, 1e-6) << across;
  }
}

TEST(WorldContact, FrictionSlowsASlidingRobotDown) {
  // The wall's force is v sin; friction takes mu of it off the speed. slip_turn = 0: no rotation.
  const double angle = 0.6;
  for (const double friction : {0.2, 0.5, 1.0}) {
    World dut(hardware(friction, {1, 0}), driven({{0.3, 0.9 - kRadius, angle}}));
    drive(dut, 0, kDuty, kDuty);
    dut.advanceTo(2 * kSecond);
    const double speed = kSpeed * (std::cos(angle) - friction * std::sin(angle));
    EXPECT_NEAR(dut.pose(0).x, 0.3 + 2 * speed, 1e-6) << friction;
  }
}

TEST(WorldContact, ARobotSticksToAWallWithinTheConeOfFriction) {
  // Its direction lies inside the cone where cos < mu sin.
  World dut(hardware(0.8, {1, 0}), driven({{0.3, 0.9 - kRadius, 1.0}}));
  ASSERT_LT(std::cos(1.0), 0.8 * std::sin(1.0));
  drive(dut, 0, kDuty, kDuty);
  dut.advanceTo(2 * kSecond);
  EXPECT_NEAR(dut.pose(0).x, 0.3, 1e-6);
  drive(dut, 0, -kDuty, -kDuty);
  dut.advanceTo(3 * kSecond);
  EXPECT_NEAR(dut.pose(0).x, 0.3 - kSpeed * std::cos(1.0), 1e-6) << "nothing holds it back";
}

TEST(WorldContact, FrictionOfAWallTurnsARobotTowardsTheWall) {
  // While the rim slides: turning by turn * mu v sin / R. When it rolls: x' = R theta' with
  // x' = v cos - F and R theta' = turn F.
  const double angle = 0.9;
  const double turn = 0.5;
  for (const double friction : {0.1, 2.0}) {
    World dut(hardware(friction, {1, turn}), driven({{0.3, 0.9 - kRadius, angle}}));
    drive(dut, 0, kDuty, kDuty);
    const dynamics::Pose speed = velocities(dut)[0];
    const double sliding = friction * kSpeed * std::sin(angle);
    const double rolling = kSpeed * std::cos(angle) / (1 + turn);
    EXPECT_EQ(sliding < rolling, friction == 0.1);
    const double force = std::min(sliding, rolling);
    EXPECT_NEAR(speed.x, kSpeed * std::cos(angle) - force, 1e-3 * kSpeed);
    EXPECT_NEAR(speed.theta, turn * force / kRadius, 1e-3 * kSpeed / kRadius);
  }
}

TEST(WorldContact, AnOffCentrePushTurnsBothRobots) {
  // The standing robot lies 0.5 rad to the left of the driven one's heading. Along the line of
  // centres both move at v cos / 2. Friction: rolling takes F = v sin / (2 + 2 turn), sliding gives
  // F = mu v cos / 2.
  const double side = 0.5;
  const double turn = 0.7;
  for (const double friction : {0.2, 1.0}) {
    World dut(hardware(friction, {1, turn}),
              driven({{0.4, 0.3, 0},
                      {0.4 + kTouching * std::cos(side), 0.3 + kTouching * std::sin(side), 2}}));
    drive(dut, 0, kDuty, kDuty);
    const std::vector<dynamics::Pose> speed = velocities(dut);
    const double push = kSpeed * std::cos(side) / 2;
    const double rolling = kSpeed * std::sin(side) / (2 + 2 * turn);
    EXPECT_EQ(friction * push < rolling, friction == 0.2);
    const double drag = std::min(friction * push, rolling);
    // The rim of the first robot slides to the right over the second one, which drags it along.
    const double allowed = 2e-3 * kSpeed;
    EXPECT_NEAR(speed[1].x, push * std::cos(side) + drag * std::sin(side), allowed);
    EXPECT_NEAR(speed[1].y, push * std::sin(side) - drag * std::cos(side), allowed);
    EXPECT_NEAR(speed[0].x, kSpeed - speed[1].x, allowed);
    EXPECT_NEAR(speed[0].y, -speed[1].y, allowed);
    EXPECT_NEAR(speed[0].theta, turn * drag / kRadius, allowed / kRadius);
    EXPECT_NEAR(speed[1].theta, turn * drag / kRadius, allowed / kRadius);
  }
}

TEST(WorldContact, ARobotSlidesAroundAnotherOneAndComesFree) {
  World dut(hardware(0), driven({{0.3, 0.47, 0}, {0.6, 0.45, 0}}));
  drive(dut, 0, kDuty, kDuty);
  dut.advanceTo(9 * kSecond);
  EXPECT_FALSE(dut.state(0).contact_robot);
  EXPECT_EQ(dut.state(0).robot_contacts, 1);
  EXPECT_GT(dut.pose(0).x, dut.pose(1).x + 2 * kRadius) << "it came past";
  EXPECT_LT(dut.pose(1).y, 0.44) << "and pushed the other one aside";
  EXPECT_EQ(dut.pose(0).theta, 0);
}

TEST(WorldContact, FrictionTurnsARobotOffItsCourse) {
  World dut(hardware(0.2), driven({{0.3, 0.47, 0}, {0.6, 0.45, 0}}));
  drive(dut, 0, kDuty, kDuty);
  dut.advanceTo(6 * kSecond);
  EXPECT_LT(dut.pose(0).theta, -0.3) << "towards the other one";
  EXPECT_LT(dut.pose(1).theta, -0.3) << "which rolls on it";
}

TEST(WorldContact, ARobotThatMeetsAKinematicDiskSlidesAroundItAndDoesNotMoveIt) {
  World dut(hardware(0), driven({{0.3, 0.46, 0}}));
  dut.moveKinematicDisk(dut.addKinematicDisk(), {0.6, 0.45});
  drive(dut, 0, kDuty, kDuty);
  double closest = 1;
  while (dut.timeUs() < 8 * kSecond) {
    dut.step(10000);
    closest = std::min(closest, std::hypot(dut.pose(0).x - 0.6, dut.pose(0).y - 0.45));
  }
  EXPECT_NEAR(closest, 2 * kRadius, 1e-6);
  EXPECT_GT(dut.pose(0).x, 0.68) << "it came past";
  EXPECT_EQ(dut.pose(0).theta, 0);
  EXPECT_EQ(dut.collisions(), 1);
}

TEST(WorldContact, ACornerHoldsARobot) {
  World dut(hardware(0), driven({{0.9, 0.7, 0.3}}));
  drive(dut, 0, kDuty, kDuty);
  dut.advanceTo(20 * kSecond);
  EXPECT_NEAR(dut.pose(0).x, 1.2 - kRadius, 1e-6);
  EXPECT_NEAR(dut.pose(0).y, 0.9 - kRadius, 1e-6);
  EXPECT_NEAR(dut.velocity(0).linear.x, 0, 1e-6);
  EXPECT_TRUE(dut.state(0).contact_wall);
  drive(dut, 0, -kDuty, -kDuty);
  dut.advanceTo(21 * kSecond);
  EXPECT_NEAR(dut.pose(0).x, 1.2 - kRadius - kSpeed * std::cos(0.3), 1e-6);
}

TEST(WorldContact, AWedgePushesTwoRobotsApart) {
  // Two standing robots at +-s of the heading: u cos = F and u = v - 2 F cos, so that
  // u = v / (1 + 2 cos^2).
  const double side = 0.6;
  const double x = kTouching * std::cos(side);
  const double y = kTouching * std::sin(side);
  World dut(hardware(0), driven({{0.4, 0.45, 0}, {0.4 + x, 0.45 + y, 1}, {0.4 + x, 0.45 - y, 2}}));
  drive(dut, 0, kDuty, kDuty);
  const std::vector<dynamics::Pose> speed = velocities(dut);
  const double ahead = kSpeed / (1 + 2 * std::cos(side) * std::cos(side));
  EXPECT_NEAR(speed[0].x, ahead, 2e-3 * kSpeed);
  const double tolerance = ContactSolver::kTolerance / 1e-3;  // of a velocity over 1 ms
  EXPECT_NEAR(speed[0].y, 0, tolerance);
  EXPECT_NEAR(speed[1].x, ahead * std::cos(side) * std::cos(side), 2e-3 * kSpeed);
  EXPECT_NEAR(speed[1].y, ahead * std::cos(side) * std::sin(side), 2e-3 * kSpeed);
  EXPECT_NEAR(speed[2].y, -speed[1].y, tolerance) << "no side is preferred";
  dut.advanceTo(6 * kSecond);
  EXPECT_GT(dut.pose(0).x, dut.pose(1).x) << "it comes through";
  EXPECT_NEAR(dut.pose(0).y, 0.45, 1e-4);
}

TEST(WorldContact, AMovingKinematicDiskPushesARowOfRobots) {
  World dut(hardware(0.2), driven({{0.5, 0.45, 0}, {0.5 + kTouching, 0.45, 1}}));
  const std::size_t disk = dut.addKinematicDisk();
  for (int frame = 0; frame <= 50; ++frame) {
    dut.advanceTo(frame * 20000);
    const double front = 0.425 + 0.002 * frame;  // 10 cm/s
    dut.moveKinematicDisk(disk, {front, 0.45});
    EXPECT_NEAR(dut.pose(0).x, front + 0.075, 1e-6);
    EXPECT_NEAR(dut.pose(1).x, front + 0.150, 2e-6);
  }
}

TEST(WorldContact, FreeMotionHasTheBitsThatItHasWithRobotsThatStop) {
  WorldSettings settings;
  settings.arena = {300, 300};
  settings.wheel_gain_error = 0.02;
  settings.speed_noise = 0.002;
  settings.turn_noise = 0.05;
  const StepLight light(150, 0.2, 0.8);
  const auto run = [&](ContactRule rule) {
    settings.contact = rule;
    World world(settings, robots(40));
    // Sensing robots reads positions that differ by the age of a step.
    for (std::size_t i = 0; i < world.size(); ++i) world.setReversesFromRobots(i, false);
    world.setLight(&light);
    startAll(world, always(abpProgram()));
    world.advanceTo(60 * kSecond);
    EXPECT_EQ(world.collisions(), 0);
    std::vector<dynamics::Pose> poses;
    for (std::size_t i = 0; i < world.size(); ++i) poses.push_back(world.pose(i));
    return poses;
  };
  const auto slide = run(ContactRule::kSlide);
  const auto stop = run(ContactRule::kStop);
  for (std::size_t i = 0; i < slide.size(); ++i) EXPECT_TRUE(sameBits(slide[i], stop[i])) << i;
}

/// 60 robots that drive to the middle of the arena and jam there.
class Jam : public ::testing::Test {
 protected:
  static World jam(std::vector<RobotSetup> setups, double friction = 0.2) {
    for (RobotSetup& setup : setups) setup.external = true;
    World world(hardware(friction), setups);
    for (std::size_t i = 0; i < world.size(); ++i) drive(world, i, 40, 40);
    return world;
  }

  /// Robots on a grid that all face the middle.
  static std::vector<RobotSetup> facingTheMiddle() {
    std::vector<RobotSetup> setups;
    for (int column = 0; column < 10; ++column) {
      for (int row = 0; row < 6; ++row) {
        const double x = 0.09 + 0.113 * column;
        const double y = 0.10 + 0.14 * row + 0.01 * (column % 3);
        const int id = static_cast<int>(setups.size()) + 1;
        setups.push_back({id, dynamics::Pose{x, y, std::atan2(0.44 - y, 0.59 - x)}, true});
      }
    }
    return setups;
  }

  static double deepestOverlap(const World& world) {
    double overlap = 0;
    for (std::size_t i = 0; i < world.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) overlap = std::max(overlap, -gap(world, i, j));
    }
    return overlap;
  }
};

TEST_F(Jam, RobotsWithoutDriveDoNotMove) {
  World dut = jam(facingTheMiddle());
  dut.advanceTo(20 * kSecond);
  EXPECT_GT(dut.collisions(), 50);
  EXPECT_LT(deepestOverlap(dut), 1e-6);
  for (std::size_t i = 0; i < dut.size(); ++i) drive(dut, i, 0, 0);
  dut.step(10000);
  std::vector<dynamics::Pose> before;
  for (std::size_t i = 0; i < dut.size(); ++i) before.push_back(dut.pose(i));
  dut.advanceTo(60 * kSecond);
  for (std::size_t i = 0; i < dut.size(); ++i) {
    EXPECT_TRUE(sameBits(before[i], dut.pose(i))) << i;
    EXPECT_FALSE(dut.state(i).contact_robot);
  }
}

// The solver's tolerance is 0.1 um in each step, and a jam amplifies differences. With friction,
// robots that are wedged together have more than one solution, of which the order chooses one: the
// comparison ends before that.
struct OrderCase {
  double friction;
  std::int64_t seconds;
};
const std::vector<OrderCase> kOrderCases = {{0, 10}, {0.2, 4}};

TEST_F(Jam, DoesNotDependOnTheOrderOfTheRobots) {
  const std::vector<RobotSetup> setups = facingTheMiddle();
  const auto shuffled = [](std::size_t i) { return (37 * i + 11) % 60; };
  std::vector<RobotSetup> other_order = setups;
  for (std::size_t i = 0; i < setups.size(); ++i) other_order[shuffled(i)] = setups[i];
  const std::vector<RobotSetup> reversed(setups.rbegin(), setups.rend());
  for (const auto& [friction, seconds] : kOrderCases) {
    World dut = jam(setups, friction);
    World backwards = jam(reversed, friction);
    World mixed = jam(other_order, friction);
    for (World* world : {&dut, &backwards, &mixed}) world->advanceTo(seconds * kSecond);
    EXPECT_GT(dut.collisions(), 20);
    for (std::size_t i = 0; i < 60; ++i) {
      ASSERT_EQ(backwards.id(59 - i), dut.id(i));
      ASSERT_EQ(mixed.id(shuffled(i)), dut.id(i));
      for (const dynamics::Pose& pose : {backwards.pose(59 - i), mixed.pose(shuffled(i))}) {
        EXPECT_NEAR(pose.x, dut.pose(i).x, 1e-5) << i;
        EXPECT_NEAR(pose.y, dut.pose(i).y, 1e-5) << i;
      }
    }
  }
}

TEST_F(Jam, IsTheMirrorImageOfAMirroredJam) {
  const std::vector<RobotSetup> setups = facingTheMiddle();
  std::vector<RobotSetup> mirrored = setups;
  for (RobotSetup& setup : mirrored) {
    setup.pose->x = 1.2 - setup.pose->x;
    setup.pose->theta = kPi - setup.pose->theta;
  }
  for (const auto& [friction, seconds] : kOrderCases) {
    World dut = jam(setups, friction);
    World mirror = jam(mirrored, friction);
    dut.advanceTo(seconds * kSecond);
    mirror.advanceTo(seconds * kSecond);
    for (std::size_t i = 0; i < 60; ++i) {
      EXPECT_NEAR(mirror.pose(i).x, 1.2 - dut.pose(i).x, 1e-5) << i;
      EXPECT_NEAR(mirror.pose(i).y, dut.pose(i).y, 1e-5) << i;
    }
  }
}

TEST_F(Jam, DissolvesWhenTheProgramsChange) {
  // In dim light the robots drive straight on into the walls, in bright light they are ABPs.
  World dut(WorldSettings(), robots(60));
  dynamics::CoreSettings table = always(wheelsProgram(0.04, 0.04));
  table.programs[1] = always(abpProgram(0.04, 0.25, 5)).programs[0];
  table.light.count = 2;
  table.light.bands[0] = {0, 512, 0};
  table.light.bands[1] = {512, 1024, 1};
  table.reversal.enabled = false;
  startAll(dut, table);
  const StepLight dim(0, 0.25, 0.25);
  const StepLight bright(0, 0.75, 0.75);
  const auto speed = [&dut] {
    double sum = 0;
    for (const dynamics::Pose& v : velocities(dut, 10 * kSecond)) sum += std::hypot(v.x, v.y) / 60;
    return sum;
  };
  dut.setLight(&dim);
  dut.advanceTo(120 * kSecond);
  EXPECT_LT(speed(), 0.002) << "jammed";
  dut.setLight(&bright);
  dut.advanceTo(160 * kSecond);
  int in_contact = 0;
  for (std::size_t i = 0; i < dut.size(); ++i) {
    in_contact += dut.state(i).contact_robot || dut.state(i).contact_wall ? 1 : 0;
  }
  EXPECT_LT(in_contact, 50);
  EXPECT_GT(speed(), 0.004) << "mixing: displacements in 10 s";
}

TEST(WorldContact, FastAndNoisyRobotsGetShorterTicks) {
  WorldSettings settings;
  settings.radius = 0.005;
  settings.wheel_base = 0.01;
  settings.max_wheel_speed = 5;
  World dut(settings, robots(100));
  EXPECT_LE(1.5 * 5 * static_cast<double>(dut.settings().tick_us) * 1e-6, 0.0025);
  dynamics::CoreSettings core = always(abpProgram(0.5, 0.25, 5));
  core.reversal.enabled = false;
  core.max_wheel_um_s = 5000000;
  startAll(dut, core);
  dut.advanceTo(5 * kSecond);
  for (std::size_t i = 0; i < dut.size(); ++i) {
    EXPECT_GE(dut.pose(i).x, 0.005 - 1e-6);
    for (std::size_t j = 0; j < i; ++j) EXPECT_GT(gap(dut, i, j) + 0.065, -1e-6);
  }
}

}  // namespace
}  // namespace lab::sim::world_contact_test
