#include "tracker_svc/fusion/camera_fusion.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "common/math/angle.hpp"

namespace lab::tracker {
namespace {

constexpr double kSolveEvery = 1;       // [s]
constexpr double kSteady = 0.02;        // [m/s] change of a velocity between rounds
constexpr double kAcceleration = 0.5;   // [m/s^2] of a robot, standard deviation
constexpr double kLongestStep = 0.25;   // [s] between rounds, for a velocity
constexpr double kLargestOffset = 0.5;  // [s] farther apart, pictures do not belong together

}  // namespace

CameraFusion::CameraFusion(std::size_t cameras, const FusionSettings& settings)
    : settings_(settings),
      pictures_(cameras),
      missed_(cameras, 0),
      comparison_(cameras),
      offsets_(cameras),
      errors_(cameras) {
  offsets_[0] = {0, 0};
}

std::vector<FusedRound> CameraFusion::add(std::size_t camera, double time,
                                          std::span<const detector::Detection> detections) {
  std::vector<FusedRound> rounds;
  const auto keep = [&rounds](std::optional<FusedRound> round) {
    if (round) rounds.push_back(std::move(*round));
  };
  if (pictures_[camera]) keep(finish());
  pictures_[camera] = Picture{time, {detections.begin(), detections.end()}};
  missed_[camera] = 0;
  bool complete = true;
  for (std::size_t i = 0; i < pictures_.size(); ++i) {
    complete = complete && (pictures_[i] || !isAlive(i));
  }
  if (complete) keep(finish());
  return rounds;
}

double CameraFusion::offsetOf(std::size_t camera) const {
  return offsets_[camera].sigma < kApplied ? offsets_[camera].offset : 0;
}

const CameraFusion::Mover* CameraFusion::moverAt(double x, double y) const {
  const Mover* nearest = nullptr;
  double reach = settings_.same;
  for (const Mover& mover : movers_) {
    const double distance = std::hypot(mover.x - x, mover.y - y);
    if (distance >= reach) continue;
    reach = distance;
    nearest = &mover;
  }
  return nearest;
}

std::optional<FusedRound> CameraFusion::finish() {
  FusedRound round;
  std::vector<Sighting> raw;
  std::vector<double> stamps(pictures_.size());
  for (std::size_t i = 0; i < pictures_.size(); ++i) {
    std::optional<Picture> picture = std::exchange(pictures_[i], std::nullopt);
    if (!picture) {
      missed_[i] = std::min(missed_[i] + 1, kMissed);
      continue;
    }
    stamps[i] = picture->time;
    const double time = picture->time - offsetOf(i);
    if (round.cameras.empty()) round.time = time;
    if (std::abs(time - round.time) > kLargestOffset) continue;
    round.cameras.push_back(i);
    for (const detector::Detection& pose : picture->detections) {
      raw.push_back({i, pose});
      comparison_.addToView(i, {pose.x, pose.y});
    }
  }
  if (round.time <= last_) return std::nullopt;
  std::vector<Sighting> moved = raw;
  for (Sighting& sighting : moved) {
    detector::Detection& pose = sighting.pose;
    const ViewError& wrong = errors_[sighting.camera];
    const Eigen::Vector2d by = wrong.at(pose.x, pose.y);
    pose.x -= by.x();
    pose.y -= by.y();
    pose.theta = wrapAngle(pose.theta - wrong.rotation());
    const double step = round.time - (stamps[sighting.camera] - offsetOf(sighting.camera));
    const Mover* mover = step != 0 ? moverAt(pose.x, pose.y) : nullptr;
    if (mover == nullptr || !mover->moves) continue;
    pose.x += mover->vx * step;
    pose.y += mover->vy * step;
    pose.theta = wrapAngle(pose.theta + mover->omega * step);
    const double error = kAcceleration * step * step / 2;
    pose.covariance[0] += error * error;
    pose.covariance[3] += error * error;
  }
  FusionSettings settings = settings_;
  if (!compared_) settings.calibration_error = ViewComparison::kShiftError;
  const std::vector<FusedPose> robots = fuseSightings(moved, settings);
  const double elapsed = round.time - last_;
  std::vector<Mover> movers;
  for (const FusedPose& robot : robots) {
    const detector::Detection& pose = robot.pose;
    round.detections.push_back(pose);
    Mover mover{.x = pose.x, .y = pose.y, .theta = pose.theta};
    const Mover* before = elapsed < kLongestStep ? moverAt(pose.x, pose.y) : nullptr;
    if (before != nullptr) {
      mover.vx = (pose.x - before->x) / elapsed;
      mover.vy = (pose.y - before->y) / elapsed;
      mover.omega = wrapAngle(pose.theta - before->theta) / elapsed;
      mover.moves = true;
      mover.steady =
          before->moves && std::hypot(mover.vx - before->vx, mover.vy - before->vy) < kSteady;
    }
    movers.push_back(mover);
    counts_.shared += robot.sightings.size() > 1 ? 1 : 0;
    counts_.rejected += static_cast<std::int64_t>(robot.rejected);
  }
  learn(robots, movers, raw, stamps);
  movers_ = std::move(movers);
  last_ = round.time;
  if (round.time >= solved_ + kSolveEvery) {
    offsets_ = comparison_.clocks();
    errors_ = comparison_.errors(offsets_, kApplied);
    compared_ = std::ranges::any_of(std::span(offsets_).subspan(1), [](const ClockOffset& clock) {
      return clock.sigma < kApplied;
    });
    solved_ = round.time;
  }
  return round;
}

void CameraFusion::learn(const std::vector<FusedPose>& robots, const std::vector<Mover>& movers,
                         const std::vector<Sighting>& raw, const std::vector<double>& stamps) {
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const std::vector<std::size_t>& seen = robots[i].sightings;
    if (!movers[i].steady || seen.size() < 2) continue;
    const Sighting& first = raw[seen.front()];
    const Eigen::Vector2d velocity(movers[i].vx, movers[i].vy);
    for (const std::size_t k : std::span(seen).subspan(1)) {
      const Sighting& other = raw[k];
      if (((first.pose.used | other.pose.used) & detector::kUsedRim) != 0) continue;
      const double between = stamps[other.camera] - stamps[first.camera];
      const Eigen::Vector2d apart(other.pose.x - first.pose.x, other.pose.y - first.pose.y);
      const auto& p = first.pose.covariance;
      const auto& q = other.pose.covariance;
      Eigen::Matrix2d covariance;
      covariance << p[0] + q[0], p[1] + q[1], p[1] + q[1], p[3] + q[3];
      comparison_.add(first.camera, other.camera, {first.pose.x, first.pose.y},
                      apart - velocity * between, velocity, covariance);
    }
  }
}

}  // namespace lab::tracker
