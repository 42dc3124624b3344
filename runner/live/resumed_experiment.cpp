#include "runner/live/resumed_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/math/random.hpp"

namespace lab::runner {
namespace {

constexpr int kRounds = 200;
constexpr double kGap = 1e-4;  // [m] gap kept between robots, more than the rounding in the file

void keepInside(StartPose& pose, const Experiment& experiment) {
  const double margin = experiment.hardware.diameter / 2 + kGap;
  pose.x = std::clamp(pose.x, margin, experiment.arena_width - margin);
  pose.y = std::clamp(pose.y, margin, experiment.arena_height - margin);
}

/// Moves two robots apart along the line between them. @return whether they were too close.
bool separate(StartPose& a, StartPose& b, double distance) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double found = std::hypot(dx, dy);
  if (found >= distance) return false;
  const double push = (distance - found) / 2 + kGap;
  const double ux = found > 0 ? dx / found : 1;
  const double uy = found > 0 ? dy / found : 0;
  a.x -= ux * push;
  a.y -= uy * push;
  b.x += ux * push;
  b.y += uy * push;
  return true;
}

bool overlapsAny(const StartPose& pose, const std::vector<StartPose*>& others, double distance) {
  return std::any_of(others.begin(), others.end(), [&](const StartPose* other) {
    return std::hypot(other->x - pose.x, other->y - pose.y) < distance;
  });
}

}  // namespace

Experiment resumedExperiment(const Experiment& experiment,
                             const std::map<std::int32_t, tracked_pose_t>& seen, int restart) {
  Experiment resumed = experiment;
  resumed.seed =
      deriveSeed(experiment.seed, restart, "restart") >> 1U;  // TOML integers have a sign
  std::vector<StartPose*> poses;
  for (RobotSpec& robot : resumed.robots) {
    const auto pose = seen.find(robot.id);
    robot.start.reset();
    // Only robots that sim_svc simulates have a start pose.
    if (pose == seen.end() || !isSimulated(robot.body)) continue;
    robot.start = StartPose{pose->second.x, pose->second.y, pose->second.theta};
    poses.push_back(&*robot.start);
  }
  const double distance = experiment.hardware.diameter;
  for (int round = 0; round < kRounds; ++round) {
    bool moved = false;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) moved = separate(*poses[j], *poses[i], distance) || moved;
    }
    for (StartPose* pose : poses) keepInside(*pose, experiment);
    if (!moved) break;
  }
  std::vector<StartPose*> placed;
  for (RobotSpec& robot : resumed.robots) {
    if (!robot.start) continue;
    if (overlapsAny(*robot.start, placed, distance)) {
      robot.start.reset();
    } else {
      placed.push_back(&*robot.start);
    }
  }
  return resumed;
}

}  // namespace lab::runner
