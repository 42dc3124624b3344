#include "tracker_svc/tracking/cap_tracker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "light/median.hpp"
#include "tracker_svc/tracking/reappearance_density.hpp"

namespace lab::tracker {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFaster = 1.1;        // [1] times max_wheel_speed: gain errors, pushes
constexpr double kPlaceSlack = 0.003;  // [m] error of a place, from noise and calibration
constexpr double kTouch = 0.006;       // [m] gap below which two caps may touch
constexpr double kLost = 0.5;          // [s] without detection
constexpr double kLostReach = 0.15;    // [m]
// [1] times the highest mean speed so far: a robot may have been held by a wall
constexpr double kSpeedMargin = 2;
// [s] over which a mean speed is taken, to average the noise of places
constexpr double kStride = 0.5;
constexpr double kBriefly = 1;       // [s] for which a track with few detections is kept at least
constexpr double kOutside = 0.3;     // [m] beyond the walls nothing is tracked
constexpr double kNewCaps = 1e-3;    // [1/s] rate at which caps are put into the arena
constexpr double kNewAtOnce = 1e-5;  // [1] minimum probability per picture
// Probability that a cap is missed again, by the number of pictures since its last detection: a
// visible cap is rarely missed, a hidden one tends to stay hidden.
constexpr double kStaysUndetected[] = {0.05, 0.5, 0.95};
constexpr int kUndetectedLong = 5;       // pictures
constexpr float kFlippedQuality = 0.4F;  // [1] low enough to be excluded from analysis

bool isDegraded(const detector::Detection& detection) {
  return (detection.used & detector::kUsedRim) != 0;
}

dynamics::Pose poseOf(const detector::Detection& detection) {
  return {detection.x, detection.y, detection.theta};
}

double distance2(const dynamics::Pose& pose, const detector::Detection& detection) {
  const double dx = pose.x - detection.x;
  const double dy = pose.y - detection.y;
  return dx * dx + dy * dy;
}

}  // namespace

struct CapTracker::TrackState {
  std::int64_t number = 0;
  dynamics::Pose pose;  ///< last detected pose
  std::array<double, 6> covariance{};
  detector::Detection detection;  ///< of this picture, or predicted
  double first = 0;               ///< [s] of the first detection
  double last = 0;                ///< [s] of the last detection
  bool detected = true;
  Wheels speeds;            ///< [m/s] from the cap's motion
  int votes = 1;            ///< pictures that agree with the heading, minus those that do not
  int undetected = 0;       ///< lit pictures without it since its last detection
  int blanks = 0;           ///< pictures without it since its last detection, lit or not
  dynamics::Pose begun_at;  ///< start of the current stride
  double begun = 0;         ///< [s] start of the current stride
  double top_speed = 0;     ///< [m/s] highest mean speed of a stride
  int chosen = -1;          ///< index of its detection in this picture
  IdentityEvidence evidence;
};

CapTracker::CapTracker(const TrackerSettings& settings, std::vector<std::int32_t> robot_ids)
    : settings_(settings),
      binding_({settings.wheel_base, settings.max_wheel_speed}, std::move(robot_ids)),
      reckoner_({settings.wheel_base, settings.max_wheel_speed}) {}

CapTracker::~CapTracker() = default;

void CapTracker::addReports(std::span<const WheelReport> wheels) {
  for (const WheelReport& report : wheels) {
    binding_.addReport(report.robot_id, report.time, report.left, report.right);
  }
}

double CapTracker::reachOf(double elapsed) const {
  return kFaster * settings_.max_wheel_speed * elapsed + kPlaceSlack;
}

/// Median over the caps of their highest speeds; ignores single caps carried by hand.
double CapTracker::usualSpeed() const {
  if (track_states_.empty()) return 0;
  std::vector<double> speeds;
  for (const TrackState& follow : track_states_) speeds.push_back(follow.top_speed);
  return medianOf(speeds);
}

/// [m] distance from its last detection within which a cap counts as the same.
double CapTracker::returnOf(const TrackState& follow, double time, double usual) const {
  const double elapsed = std::max(0.0, time - follow.last);
  const double by_hand = 2 * reachOf(elapsed);
  // Without a picture in between the cap was not missed: recordings may have one picture per
  // second.
  if (!settings_.caps_may_be_replaced || follow.blanks == 0 || elapsed <= kLost) return by_hand;
  const double speed = std::max(follow.top_speed, usual);
  return std::min(by_hand, kSpeedMargin * speed * elapsed + settings_.robot_radius);
}

double CapTracker::turnOf(double elapsed) const {
  return kFaster * 2 * settings_.max_wheel_speed / settings_.wheel_base * elapsed + 0.1;
}

Reckoning CapTracker::reckon(const TrackState& follow, double time) {
  Reckoning result = reckoner_.reckon(follow.pose, follow.covariance, follow.speeds,
                                      binding_.logOf(follow.evidence.robot), follow.last, time);
  // Clamps to the walls if it was inside.
  const auto hold = [&](double place, double from, double size) {
    const double low = std::min(settings_.robot_radius, from);
    const double high = std::max(size - settings_.robot_radius, from);
    return std::clamp(place, low, high);
  };
  result.pose.x = hold(result.pose.x, follow.pose.x, settings_.arena_width);
  result.pose.y = hold(result.pose.y, follow.pose.y, settings_.arena_height);
  return result;
}

const std::vector<detector::Expected>& CapTracker::expect(double time) {
  expected_.clear();
  for (const TrackState& follow : track_states_) {
    const double elapsed = std::max(0.0, time - follow.last);
    const dynamics::Pose pose = reckon(follow, time).pose;
    const double moved = std::hypot(pose.x - follow.pose.x, pose.y - follow.pose.y);
    const double turned = std::abs(pose.theta - follow.pose.theta);
    const double largest = elapsed > kLost ? kLostReach : settings_.robot_radius;
    expected_.push_back({pose.x, pose.y, wrapped(pose.theta),
                         std::min(reachOf(elapsed) + moved, largest),
                         std::min(turnOf(elapsed) + turned, kPi)});
  }
  return expected_;
}

const std::vector<Track>& CapTracker::update(double time,
                                             std::span<const detector::Detection> detections) {
  clean(detections);
  for (TrackState& follow : track_states_) follow.chosen = -1;
  matchSure(time);
  matchRest(time);
  const bool lit = 2 * found_.size() >= track_states_.size() && !found_.empty();
  for (TrackState& follow : track_states_) {
    if (follow.chosen >= 0) {
      noteDetected(follow, time, found_[static_cast<std::size_t>(follow.chosen)]);
    } else {
      noteUndetected(follow, time, lit);
    }
  }
  giveUp(time);
  for (std::size_t i = 0; i < found_.size(); ++i) {
    if (cap_of_[i] < 0 && !isDegraded(found_[i])) start(time, found_[i]);
  }
  if (lit) lit_ = time;
  if (binding_.isDue(time)) compareMotion(time);
  publish(time);
  return tracks_;
}

void CapTracker::clean(std::span<const detector::Detection> detections) {
  found_.clear();
  for (const detector::Detection& detection : detections) {
    if (detection.quality > 0 && std::isfinite(detection.x) && std::isfinite(detection.y) &&
        std::isfinite(detection.theta)) {
      found_.push_back(detection);
    }
  }
  cap_of_.assign(found_.size(), -1);
}

/// Assigns caps that cannot have driven half the distance of two robots in contact: another robot
/// within their reach would overlap them.
void CapTracker::matchSure(double time) {
  constexpr int kSeveral = -2;
  for (std::size_t i = 0; i < track_states_.size(); ++i) {
    TrackState& follow = track_states_[i];
    const double reach = reachOf(std::max(0.0, time - follow.last));
    if (reach > 0.95 * settings_.robot_radius) continue;
    for (std::size_t j = 0; j < found_.size(); ++j) {
      if (distance2(follow.pose, found_[j]) > reach * reach) continue;
      follow.chosen = follow.chosen == -1 ? static_cast<int>(j) : kSeveral;
      cap_of_[j] = cap_of_[j] == -1 ? static_cast<int>(i) : kSeveral;
    }
  }
  // With several candidates, likelihood decides later.
  for (TrackState& follow : track_states_) {
    if (follow.chosen >= 0 && cap_of_[static_cast<std::size_t>(follow.chosen)] < 0) {
      follow.chosen = -1;
    }
    if (follow.chosen == kSeveral) follow.chosen = -1;
  }
  for (std::size_t j = 0; j < found_.size(); ++j) {
    if (cap_of_[j] < 0 ||
        track_states_[static_cast<std::size_t>(cap_of_[j])].chosen != static_cast<int>(j)) {
      cap_of_[j] = -1;
    }
  }
}

/// Assigns the others by likelihood: each track's density at each detection, against not being
/// detected, and against the cap being new.
void CapTracker::matchRest(double time) {
  std::vector<std::size_t> columns;
  for (std::size_t j = 0; j < found_.size(); ++j) {
    if (cap_of_[j] < 0) columns.push_back(j);
  }
  if (columns.empty()) return;
  std::vector<std::size_t> rows;
  const double usual = settings_.caps_may_be_replaced ? usualSpeed() : 0;
  for (std::size_t i = 0; i < track_states_.size(); ++i) {
    if (track_states_[i].chosen >= 0) continue;
    const double reach = returnOf(track_states_[i], time, usual);
    if (std::any_of(columns.begin(), columns.end(), [&](std::size_t j) {
          return distance2(track_states_[i].pose, found_[j]) <= reach * reach;
        })) {
      rows.push_back(i);
    }
  }
  if (rows.empty()) return;
  const double area = settings_.arena_width * settings_.arena_height * 2 * kPi;
  const double new_density = (kNewCaps * (time - lit_) + kNewAtOnce) / area;
  assignment_.reset(rows.size(), columns.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const TrackState& follow = track_states_[rows[i]];
    const ReappearanceDensity reappearance(follow.pose, reckon(follow, time),
                                           reachOf(std::max(0.0, time - follow.last)),
                                           kFaster * settings_.max_wheel_speed);
    const double undetected = kStaysUndetected[follow.undetected == 0                ? 0
                                               : follow.undetected < kUndetectedLong ? 1
                                                                                     : 2];
    assignment_.setAlone(i, -std::log(undetected));
    const double farthest = returnOf(follow, time, usual);
    for (std::size_t j = 0; j < columns.size(); ++j) {
      if (distance2(follow.pose, found_[columns[j]]) > farthest * farthest) continue;
      const double density = reappearance.logDensity(found_[columns[j]]);
      if (density > -100) {
        assignment_.allow(i, j, -std::log(1 - undetected) - density + std::log(new_density));
      }
    }
  }
  assignment_.solve();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    TrackState& follow = track_states_[rows[i]];
    const int column = assignment_.columnOf(i);
    if (column >= 0) {
      follow.chosen = static_cast<int>(columns[static_cast<std::size_t>(column)]);
      cap_of_[static_cast<std::size_t>(follow.chosen)] = static_cast<int>(rows[i]);
    }
    if (assignment_.margin(i) < kDoubt) doubt(follow);
  }
}

void CapTracker::doubt(TrackState& follow) {
  if (follow.evidence.robot >= 0) ++counts_.unbound;
  follow.evidence.forget();
}

void CapTracker::noteDetected(TrackState& follow, double time, detector::Detection detection) {
  // A degraded pose has the expected heading and a less accurate place.
  const bool sharp = !isDegraded(detection);
  if (sharp) correctFlip(follow, time, detection);
  const dynamics::Pose pose = poseOf(detection);
  const double span = time - follow.last;
  if (span > kLost) {
    follow.speeds = {};
  } else if (span > 1e-3 && sharp && !isDegraded(follow.detection)) {
    const Wheels travel = wheelsBetween(follow.pose, pose, settings_.wheel_base);
    const double most = settings_.max_wheel_speed;
    const auto blend = [&](double old, double measured) {
      return std::clamp(0.3 * old + 0.7 * measured / span, -most, most);
    };
    follow.speeds = {blend(follow.speeds.left, travel.left),
                     blend(follow.speeds.right, travel.right)};
  }
  if (span > kLost && follow.blanks > 0) {  // its path in between is unknown
    follow.begun = time;
    follow.begun_at = pose;
  } else if (sharp && time - follow.begun >= kStride) {
    const double travel = std::hypot(pose.x - follow.begun_at.x, pose.y - follow.begun_at.y);
    follow.top_speed = std::max(follow.top_speed, travel / (time - follow.begun));
    follow.begun = time;
    follow.begun_at = pose;
  }
  follow.pose = pose;
  follow.covariance = detection.covariance;
  follow.detection = detection;
  follow.last = time;
  follow.detected = true;
  follow.undetected = 0;
  follow.blanks = 0;
}

void CapTracker::correctFlip(TrackState& follow, double time, detector::Detection& detection) {
  const double elapsed = std::max(0.0, time - follow.last);
  double limit = turnOf(elapsed);
  double from = follow.pose.theta;
  if (limit > 0.4 * kPi) {
    // It may really have turned round: only its own wheel reports can tell.
    const Reckoning reckoning = reckon(follow, time);
    limit = 4 * std::sqrt(reckoning.covariance[5]) + 0.1;
    from = reckoning.pose.theta;
    if (reckoning.known < 0.9 * elapsed || limit > 0.4 * kPi) return;
  }
  limit += 4 * std::sqrt(detection.covariance[5] + follow.covariance[5]);
  const double turned = std::abs(wrapped(detection.theta - from));
  if (turned <= limit || kPi - turned > limit) {
    if (turned <= limit) follow.votes = std::min(follow.votes + 1, kVotes);
    return;
  }
  if (--follow.votes < 0) {
    // The heading was wrong from the beginning; accept the opposite one.
    follow.votes = 1;
    follow.speeds = {-follow.speeds.right, -follow.speeds.left};
    follow.pose.theta = wrapped(follow.pose.theta + kPi);
    follow.evidence.begun = false;
    return;
  }
  ++counts_.flips;
  detection.theta = wrapped(detection.theta + kPi);
  std::swap(detection.big, detection.small);
  detection.quality = std::min(detection.quality, kFlippedQuality);
}

void CapTracker::noteUndetected(TrackState& follow, double time, bool lit) {
  const Reckoning reckoning = reckon(follow, time);
  detector::Detection& detection = follow.detection;
  detection.x = reckoning.pose.x;
  detection.y = reckoning.pose.y;
  detection.theta = wrapped(reckoning.pose.theta);
  detection.covariance = reckoning.covariance;
  detection.quality = 0;
  detection.used = 0;
  detection.spacing = 0;
  follow.detected = false;
  if (lit) ++follow.undetected;
  ++follow.blanks;
}

void CapTracker::start(double time, const detector::Detection& detection) {
  TrackState follow;
  follow.number = next_number_++;
  follow.pose = poseOf(detection);
  follow.covariance = detection.covariance;
  follow.detection = detection;
  follow.first = time;
  follow.last = time;
  follow.begun = time;
  follow.begun_at = follow.pose;
  follow.evidence.pairs.resize(binding_.robots());
  track_states_.push_back(std::move(follow));
}

void CapTracker::giveUp(double time) {
  const auto isLost = [&](const TrackState& follow) {
    if (follow.detected) return false;
    const double timeout = std::min(kGiveUp, kBriefly + follow.last - follow.first);
    const detector::Detection& at = follow.detection;
    return time - follow.last > timeout || at.x < -kOutside || at.y < -kOutside ||
           at.x > settings_.arena_width + kOutside || at.y > settings_.arena_height + kOutside;
  };
  const auto end = std::remove_if(track_states_.begin(), track_states_.end(), isLost);
  counts_.lost += track_states_.end() - end;
  track_states_.erase(end, track_states_.end());
}

bool CapTracker::isTouching(const TrackState& follow) const {
  const dynamics::Pose& at = follow.pose;
  const double wall = settings_.robot_radius + kTouch;
  if (at.x < wall || at.y < wall || at.x > settings_.arena_width - wall ||
      at.y > settings_.arena_height - wall) {
    return true;
  }
  const double near = 2 * settings_.robot_radius + kTouch;
  return std::any_of(track_states_.begin(), track_states_.end(), [&](const TrackState& other) {
    const double dx = other.pose.x - at.x;
    const double dy = other.pose.y - at.y;
    return &other != &follow && dx * dx + dy * dy < near * near;
  });
}

void CapTracker::compareMotion(double time) {
  evidence_.clear();
  for (TrackState& follow : track_states_) {
    IdentityEvidence& evidence = follow.evidence;
    evidence.placed = follow.detected && !isDegraded(follow.detection);
    evidence.place = follow.pose;
    const double half_base = settings_.wheel_base / 2;
    evidence.variance = (follow.covariance[0] + follow.covariance[3]) / 2 +
                        half_base * half_base * follow.covariance[5];
    evidence.touching = isTouching(follow);
    evidence_.push_back(&evidence);
  }
  const std::int64_t bound = binding_.bound();
  const std::int64_t unbound = binding_.unbound();
  binding_.step(time, evidence_);
  counts_.bound += binding_.bound() - bound;
  counts_.unbound += binding_.unbound() - unbound;
}

bool CapTracker::bind(std::int32_t robot_id, double x, double y, double reach) {
  const int robot = binding_.indexOf(robot_id);
  if (robot < 0) return false;
  TrackState* nearest = nullptr;
  double least = reach * reach;
  detector::Detection place;
  place.x = x;
  place.y = y;
  for (TrackState& follow : track_states_) {
    const double distance = distance2(follow.pose, place);
    if (!follow.detected || isDegraded(follow.detection) || distance > least) continue;
    least = distance;
    nearest = &follow;
  }
  if (nearest == nullptr) return false;
  if (nearest->evidence.robot == robot) return true;
  for (TrackState& follow : track_states_) {
    if (follow.evidence.robot == robot) doubt(follow);
  }
  if (nearest->evidence.robot >= 0) doubt(*nearest);
  nearest->evidence.forget();
  nearest->evidence.robot = robot;
  nearest->evidence.proven = true;
  ++counts_.bound;
  for (std::size_t i = 0; i < tracks_.size() && i < track_states_.size(); ++i) {
    tracks_[i].robot_id = binding_.idOf(track_states_[i].evidence.robot);
  }
  return true;
}

void CapTracker::publish(double time) {
  tracks_.resize(track_states_.size());
  for (std::size_t i = 0; i < track_states_.size(); ++i) {
    const TrackState& follow = track_states_[i];
    tracks_[i] = {follow.number, binding_.idOf(follow.evidence.robot), follow.detection,
                  follow.detected, follow.detected ? 0 : time - follow.last};
  }
}

}  // namespace lab::tracker
