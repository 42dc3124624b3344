#include "robot_bridge/calibration/drive_pattern.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/math/angle.hpp"
#include "robot/dynamics/kinematics.hpp"
#include "robot/dynamics/motor.hpp"

namespace lab::calibration {
namespace {

using dynamics::Pose;

constexpr std::array kDuties = {38, 77, 128, 178};  // about 15, 30, 50 and 70 % of 255
constexpr double kReach = 0.12;                     // [m] length of a straight run
constexpr double kLongest = 1.2;                    // [s] duration of a step
constexpr double kShortest = 0.5;                   // [s]
constexpr double kPathStep = 0.02;                  // [s]
constexpr int kDirections = 72;                     // number of headings tried
constexpr int kMargin = 4;                          // free headings required on each side
// Preferred clearance, larger than necessary because a robot does not stop exactly as ordered.
constexpr double kSoughtClearance = kClearance + 0.004;
constexpr double kLongestWay = 0.20;    // [m] longest escape path
constexpr double kSpare = 0.01;         // [m] additional clearance at the end of an escape path
constexpr double kWayStep = 0.02;       // [m]
constexpr double kTrackerSlack = 1e-3;  // [m] allowance for the tracker's noise
// Clearance that a robot must gain per metre of an escape path: more than an error of its heading
// may cost.
constexpr double kWayGain = 0.3;

/// Adds a step and its reverse. @param full [m/s] nominal speed, which determines the duration
void addPair(Pattern& pattern, double left, double right, double full) {
  const double duration = std::clamp(kReach / full - kSettleTime, kShortest, kLongest);
  pattern.push_back({left, right, duration});
  pattern.push_back({-left, -right, duration});
}

/// The path of a robot with nominal motors, relative to its start.
std::vector<Pose> pathOf(const Pattern& pattern, double wheel_base) {
  std::vector<Pose> path = {{}};
  for (const PatternStep& step : pattern) {
    const double time = step.duration + kSettleTime;
    const int pieces = static_cast<int>(std::ceil(time / kPathStep));
    const dynamics::Arc arc = dynamics::makeArc(step.left, step.right, wheel_base, time / pieces);
    for (int i = 0; i < pieces; ++i) path.push_back(dynamics::apply(arc, path.back()));
  }
  return path;
}

/// 0, 1, -1, 2, -2, ...
int directionNumber(int i) { return (i + 1) / 2 * (i % 2 == 0 ? -1 : 1); }

/// The present heading, rotated by a number of steps of 2 pi / kDirections.
double turned(double present, int directions) {
  return wrapAngle(present + directions * 2 * std::numbers::pi / kDirections);
}

/// Distance between a robot at (x, y) and the nearest obstacle.
double clearanceAt(double x, double y, const Surroundings& around) {
  const double radius = around.diameter / 2;
  double clearance = std::min({x, y, around.width - x, around.height - y}) - radius;
  for (const Place& other : around.others) {
    clearance = std::min(clearance, std::hypot(x - other.x, y - other.y) - around.diameter);
  }
  return clearance;
}

}  // namespace

Pattern calibrationPattern(const Motors& stored, double max) {
  Pattern pattern;
  for (const int wanted : kDuties) {
    const auto speedAt = [&](const Wheel& wheel) {
      // A robot with a stored dead band never uses a duty within it.
      const double least = wheel.dead_band * dynamics::kMaxDuty + 8;
      return wheelSpeed(wheel, std::max<double>(wanted, std::ceil(least)) / dynamics::kMaxDuty,
                        max);
    };
    const double left = speedAt(stored.left);
    const double right = speedAt(stored.right);
    const double full = wanted * max / dynamics::kMaxDuty;
    addPair(pattern, left, right, full);
    addPair(pattern, -left, right, full);
    addPair(pattern, left, 0, full);
    addPair(pattern, 0, right, full);
  }
  return pattern;
}

Pattern checkPattern(double max) {
  Pattern pattern;
  for (const auto& [left, right] : std::array<std::array<double, 2>, 6>{
           {{0.42, 0.42}, {-0.36, 0.36}, {0.23, 0.47}, {0.51, 0.29}, {0.6, 0.6}, {-0.57, 0.57}}}) {
    addPair(pattern, left * max, right * max, (std::fabs(left) + std::fabs(right)) / 2 * max);
  }
  return pattern;
}

std::optional<double> clearHeading(const Pattern& pattern, const Place& robot,
                                   const Surroundings& surroundings) {
  const std::vector<Pose> path = pathOf(pattern, surroundings.diameter);
  const auto isRoomy = [&](double heading, double clearance) {
    const double c = std::cos(heading);
    const double s = std::sin(heading);
    return std::all_of(path.begin(), path.end(), [&](const Pose& at) {
      return clearanceAt(robot.x + c * at.x - s * at.y, robot.y + s * at.x + c * at.y,
                         surroundings) >= clearance;
    });
  };
  if (isRoomy(robot.theta, kClearance)) return turned(robot.theta, 0);
  for (int i = 0; i < kDirections; ++i) {
    const int first = directionNumber(i);
    if (!isRoomy(turned(robot.theta, first), kSoughtClearance)) continue;
    // Prefer the middle of the free headings, because a robot does not turn exactly.
    const int sense = first < 0 ? -1 : 1;
    int more = 0;
    while (more < kMargin &&
           isRoomy(turned(robot.theta, first + sense * (more + 1)), kSoughtClearance)) {
      ++more;
    }
    return turned(robot.theta, first + sense * (more + 1) / 2);
  }
  return {};
}

std::optional<EscapePath> escapePath(const Pattern& pattern, const Place& robot,
                                     const Surroundings& surroundings) {
  const double now = clearanceAt(robot.x, robot.y, surroundings) - kTrackerSlack;
  const auto isFree = [&](double heading, double distance) {
    for (double gone = 0; gone < distance + kWayStep / 2; gone += kWayStep / 4) {
      const double least = std::min(kClearance, now + kWayGain * gone);
      if (clearanceAt(robot.x + gone * std::cos(heading), robot.y + gone * std::sin(heading),
                      surroundings) < least) {
        return false;
      }
    }
    return true;
  };
  // Only consider end positions with additional clearance.
  Surroundings tighter = surroundings;
  tighter.diameter += kSpare;
  const int steps = static_cast<int>(std::lround(kLongestWay / kWayStep));
  for (int step = 1; step <= steps; ++step) {
    const double distance = step * kWayStep;
    for (int i = 0; i < kDirections; ++i) {
      const double heading = turned(robot.theta, directionNumber(i));
      if (!isFree(heading, distance)) continue;
      const Place there{robot.x + distance * std::cos(heading),
                        robot.y + distance * std::sin(heading), heading};
      if (clearHeading(pattern, there, tighter)) return EscapePath{heading, distance};
    }
  }
  return {};
}

double reachOf(const Pattern& pattern, double wheel_base) {
  double reach = 0;
  for (const Pose& pose : pathOf(pattern, wheel_base)) {
    reach = std::max(reach, std::hypot(pose.x, pose.y));
  }
  return reach;
}

}  // namespace lab::calibration
