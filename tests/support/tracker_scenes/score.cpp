#include "tests/support/tracker_scenes/score.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <sstream>

namespace lab::cases {
namespace {

constexpr double kSame = 0.01;       // [m] largest distance between a pose and its robot
constexpr double kDontCare = 0.025;  // [m] around a robot that does not count, poses are ignored

}  // namespace

std::map<int, std::vector<TrueRobot>> readTruth(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  std::vector<std::string> names;
  std::stringstream header(line);
  for (std::string name; std::getline(header, name, ',');) names.push_back(name);
  std::map<int, std::vector<TrueRobot>> truth;
  while (std::getline(in, line)) {
    std::stringstream fields(line);
    std::map<std::string, double> row;
    std::string field;
    for (const std::string& name : names) {
      if (std::getline(fields, field, ',')) row[name] = std::strtod(field.c_str(), nullptr);
    }
    const bool counts = row["vis_big"] > 0.99 && row["vis_small"] > 0.99 &&
                        std::max(row["glare_big"], row["glare_small"]) < 0.5;
    truth[static_cast<int>(row["frame"])].push_back(
        {row["x_cm"] / 100, row["y_cm"] / 100, row["theta_rad"], counts});
  }
  return truth;
}

Unmatched Score::add(const std::vector<TrueRobot>& truth,
                     const std::vector<detector::Detection>& poses,
                     const optics::CameraModel& camera, double height, double seconds) {
  ++frames_;
  fastest_ += seconds;
  struct Match {
    double distance;
    std::size_t robot;
    std::size_t pose;
  };
  std::vector<Match> matches;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (std::size_t j = 0; j < poses.size(); ++j) {
      const double distance = std::hypot(poses[j].x - truth[i].x, poses[j].y - truth[i].y);
      if (distance < (truth[i].counts ? kSame : kDontCare)) matches.push_back({distance, i, j});
    }
  }
  std::sort(matches.begin(), matches.end(),
            [](const Match& a, const Match& b) { return a.distance < b.distance; });
  std::vector<bool> robot_done(truth.size(), false);
  std::vector<bool> pose_done(poses.size(), false);
  for (const TrueRobot& robot : truth) robots_ += robot.counts ? 1 : 0;
  for (const Match& match : matches) {
    if (robot_done[match.robot] || pose_done[match.pose]) continue;
    robot_done[match.robot] = true;
    pose_done[match.pose] = true;
    const TrueRobot& robot = truth[match.robot];
    if (!robot.counts) continue;
    ++found_;
    const detector::Detection& pose = poses[match.pose];
    const Eigen::Vector3d error(pose.x - robot.x, pose.y - robot.y,
                                std::remainder(pose.theta - robot.theta, 2 * std::numbers::pi));
    if (std::abs(error.z()) > std::numbers::pi / 2) {
      ++flipped_;
      continue;
    }
    const optics::PlaneScale scale = camera.scaleAt({robot.x, robot.y}, height);
    const double square = std::abs(scale.ux * scale.vy - scale.uy * scale.vx);
    position_ += (error.x() * error.x() + error.y() * error.y()) * square;
    heading_ += error.z() * error.z();
    const auto& c = pose.covariance;
    if (c[0] > 0) {
      Eigen::Matrix3d covariance;
      covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
      nees_ += error.dot(covariance.ldlt().solve(error)) / 3;
      ++nees_count_;
    }
  }
  Unmatched left;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth[i].counts && !robot_done[i]) left.missed.push_back(i);
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!pose_done[i]) left.wrong.push_back(i);
  }
  wrong_ += static_cast<int>(left.wrong.size());
  return left;
}

Tally Score::tally() const {
  const int good = std::max(found_ - flipped_, 1);
  return {.frames = frames_,
          .robots = robots_,
          .found = found_,
          .flipped = flipped_,
          .wrong = wrong_,
          .position = std::sqrt(position_ / good),
          .heading = std::sqrt(heading_ / good) * 180 / std::numbers::pi,
          .nees = nees_count_ > 0 ? nees_ / nees_count_ : 1,
          .nees_count = nees_count_};
}

bool Score::isInconsistent() const {
  const Tally all = tally();
  return all.nees_count > 0 && std::abs(all.nees - 1) > allowedNees(all);
}

std::string Score::header() {
  return "robots  recall%  wrong/frame  flips  position px  heading deg      NEES  ms/frame";
}

std::string Score::text() const {
  const Tally all = tally();
  const int frames = std::max(all.frames, 1);
  char line[160];
  std::snprintf(line, sizeof line, "%6d  %7.2f  %11.2f  %5d  %11.4f  %11.4f  %8s  %8.3f",
                all.robots, all.robots > 0 ? 100.0 * all.found / all.robots : 100.0,
                static_cast<double>(all.wrong) / frames, all.flipped, all.position, all.heading,
                all.nees_count > 0 ? std::to_string(all.nees).substr(0, 5).c_str() : "-",
                1e3 * fastest_ / frames);
  return line;
}

}  // namespace lab::cases
