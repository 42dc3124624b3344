#include "runner/campaign/live/robot_problems.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

namespace lab::runner::campaign {
namespace {

constexpr double kLeastSeen = 0.5;        // [1] of the median
constexpr double kLeastMoved = 0.5;       // [1] of the median
constexpr double kMostContact = 0.25;     // [1] of the time
constexpr double kLag = 1;                // [s]
constexpr std::size_t kFewestRobots = 3;  // whose median is typical

/// What a robot did in the program in which it was seen longest.
struct Motion {
  double longest = 0;  ///< [s] in this one
  std::string program;
  double moved = std::nan("");  ///< [cm] root mean square displacement in about 1 s
  bool jammed = false;          ///< in contact for so long that it may be held by others
};

double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

double displacementOf(const nlohmann::json& motion) {
  const nlohmann::json& lags = motion.at("lag_s");
  const nlohmann::json& msd = motion.at("msd_cm2");
  double best = std::nan("");
  double distance = 0;
  for (std::size_t i = 0; i < lags.size() && i < msd.size(); ++i) {
    if (!lags[i].is_number() || !msd[i].is_number()) continue;
    const double off = std::abs(std::log(lags[i].get<double>() / kLag));
    if (std::isnan(best) || off < distance) {
      best = std::sqrt(std::max(0.0, msd[i].get<double>()));
      distance = off;
    }
  }
  return best;
}

void addMotion(const std::string& program, const nlohmann::json& robot, Motion& motion) {
  const nlohmann::json& whole = robot.at("whole_motion");
  const double observed = whole.at("observed_s").get<double>();
  if (observed <= motion.longest) return;
  motion.longest = observed;
  motion.program = program;
  motion.moved = displacementOf(whole);
  motion.jammed = robot.at("time_shares").at("contact").get<double>() > kMostContact;
}

std::map<std::int32_t, Motion> motionsOf(const nlohmann::json& summary) {
  std::map<std::int32_t, Motion> motions;
  const nlohmann::json& robots = summary.at("robots");
  for (const nlohmann::json& program : summary.at("programs")) {
    const auto name = program.at("name").get<std::string>();
    if (robots.size() == 1) {  // its numbers are those of the pool, and not repeated
      const auto id = robots[0].at("robot").get<std::int32_t>();
      addMotion(name, program.at("pool"), motions[id]);
      continue;
    }
    for (const nlohmann::json& robot : program.at("each_robot")) {
      addMotion(name, robot, motions[robot.at("robot").get<std::int32_t>()]);
    }
  }
  return motions;
}

/// Robots that move far less than those of their program.
void findStalled(const std::map<std::int32_t, Motion>& motions,
                 std::map<std::int32_t, RobotProblem>& problems) {
  std::map<std::string, std::vector<double>> moved;
  for (const auto& [id, motion] : motions) {
    if (!std::isnan(motion.moved)) moved[motion.program].push_back(motion.moved);
  }
  for (const auto& [id, motion] : motions) {
    if (std::isnan(motion.moved) || motion.jammed) continue;
    if (moved[motion.program].size() < kFewestRobots) continue;
    if (motion.moved < kLeastMoved * medianOf(moved[motion.program])) {
      problems.emplace(id, RobotProblem::kStalled);
    }
  }
}

}  // namespace

const char* nameOf(RobotProblem problem) {
  switch (problem) {
    case RobotProblem::kRebooted:
      return "rebooted";
    case RobotProblem::kVanished:
      return "vanished";
    case RobotProblem::kStalled:
      return "stalled";
  }
  return "";
}

std::map<std::int32_t, RobotProblem> robotProblems(std::string_view summary_json,
                                                   const std::map<std::int32_t, double>& seen) {
  const nlohmann::json summary = nlohmann::json::parse(summary_json);
  std::map<std::int32_t, RobotProblem> problems;
  for (const nlohmann::json& robot : summary.at("robots")) {
    if (robot.at("boots").get<std::int64_t>() <= 1) continue;
    problems.emplace(robot.at("robot").get<std::int32_t>(), RobotProblem::kRebooted);
  }
  std::vector<double> shares;
  for (const auto& [id, share] : seen) shares.push_back(share);
  const double typical = shares.size() < kFewestRobots ? 1 : medianOf(shares);
  for (const auto& [id, share] : seen) {
    if (share < kLeastSeen * typical) problems.emplace(id, RobotProblem::kVanished);
  }
  findStalled(motionsOf(summary), problems);
  return problems;
}

}  // namespace lab::runner::campaign
