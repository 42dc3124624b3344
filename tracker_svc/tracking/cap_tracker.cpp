#include "tracker_svc/tracking/cap_tracker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "common/math/angle.hpp"
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
  Wheels speeds;               ///< [m/s] from the cap's motion
  int votes = 1;               ///< pictures that agree with the heading, minus those that do not
  int undetected = 0;          ///< lit pictures without it since its last detection
  int blanks = 0;              ///< pictures without it since its last detection, lit or not
  dynamics::Pose stride_pose;  ///< at the start of the current stride
  double stride_time = 0;      ///< [s] start of the current stride
  double top_speed = 0;        ///< [m/s] highest mean speed of a stride
  int chosen = -1;             ///< index of its detection in this picture
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
  for (const TrackState& track : track_states_) speeds.push_back(track.top_speed);
  return medianOf(speeds);
}

/// [m] distance from its last detection within which a cap counts as the same.
double CapTracker::returnOf(const TrackState& track, double time, double usual) const {
  const double elapsed = std::max(0.0, time - track.last);
  const double by_hand = 2 * reachOf(elapsed);
  // Without a picture in between the cap was not missed: recordings may have one picture per
  // second.
  if (!settings_.caps_may_be_replaced || track.blanks == 0 || elapsed <= kLost) return by_hand;
  const double speed = std::max(track.top_speed, usual);
  return std::min(by_hand, kSpeedMargin * speed * elapsed + settings_.robot_radius);
}

double CapTracker::turnOf(double elapsed) const {
  return kFaster * 2 * settings_.max_wheel_speed / settings_.wheel_base * elapsed + 0.1;
}

Reckoning CapTracker::reckon(const TrackState& track, double time) {
  Reckoning result = reckoner_.reckon(track.pose, track.covariance, track.speeds,
                                      binding_.logOf(track.evidence.robot), track.last, time);
  // Clamps to the walls if it was inside.
  const auto hold = [&](double place, double from, double size) {
    const double low = std::min(settings_.robot_radius, from);
    const double high = std::max(size - settings_.robot_radius, from);
    return std::clamp(place, low, high);
  };
  result.pose.x = hold(result.pose.x, track.pose.x, settings_.arena_width);
  result.pose.y = hold(result.pose.y, track.pose.y, settings_.arena_height);
  return result;
}

const std::vector<detector::Expected>& CapTracker::expect(double time) {
  expected_.clear();
  for (const TrackState& track : track_states_) {
    const double elapsed = std::max(0.0, time - track.last);
    const dynamics::Pose pose = reckon(track, time).pose;
    const double moved = std::hypot(pose.x - track.pose.x, pose.y - track.pose.y);
    const double turned = std::abs(pose.theta - track.pose.theta);
    const double largest = elapsed > kLost ? kLostReach : settings_.robot_radius;
    expected_.push_back({pose.x, pose.y, wrapAngle(pose.theta),
                         std::min(reachOf(elapsed) + moved, largest),
                         std::min(turnOf(elapsed) + turned, kPi)});
  }
  return expected_;
}

const std::vector<Track>& CapTracker::update(double time,
                                             std::span<const detector::Detection> detections) {
  clean(detections);
  for (TrackState& track : track_states_) track.chosen = -1;
  matchSure(time);
  matchRest(time);
  const bool lit = 2 * found_.size() >= track_states_.size() && !found_.empty();
  for (TrackState& track : track_states_) {
    if (track.chosen >= 0) {
      noteDetected(track, time, found_[static_cast<std::size_t>(track.chosen)]);
    } else {
      noteUndetected(track, time, lit);
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
    TrackState& track = track_states_[i];
    const double reach = reachOf(std::max(0.0, time - track.last));
    if (reach > 0.95 * settings_.robot_radius) continue;
    for (std::size_t j = 0; j < found_.size(); ++j) {
      if (distance2(track.pose, found_[j]) > reach * reach) continue;
      track.chosen = track.chosen == -1 ? static_cast<int>(j) : kSeveral;
      cap_of_[j] = cap_of_[j] == -1 ? static_cast<int>(i) : kSeveral;
    }
  }
  // With several candidates, likelihood decides later.
  for (TrackState& track : track_states_) {
    if (track.chosen >= 0 && cap_of_[static_cast<std::size_t>(track.chosen)] < 0) {
      track.chosen = -1;
    }
    if (track.chosen == kSeveral) track.chosen = -1;
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
    const TrackState& track = track_states_[rows[i]];
    const ReappearanceDensity reappearance(track.pose, reckon(track, time),
                                           reachOf(std::max(0.0, time - track.last)),
                                           kFaster * settings_.max_wheel_speed);
    const double undetected = kStaysUndetected[track.undetected == 0                ? 0
                                               : track.undetected < kUndetectedLong ? 1
                                                                                    : 2];
    assignment_.setAlone(i, -std::log(undetected));
    const double farthest = returnOf(track, time, usual);
    for (std::size_t j = 0; j < columns.size(); ++j) {
      if (distance2(track.pose, found_[columns[j]]) > farthest * farthest) continue;
      const double density = reappearance.logDensity(found_[columns[j]]);
      if (density > -100) {
        assignment_.allow(i, j, -std::log(1 - undetected) - density + std::log(new_density));
      }
    }
  }
  assignment_.solve();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    TrackState& track = track_states_[rows[i]];
    const int column = assignment_.columnOf(i);
    if (column >= 0) {
      track.chosen = static_cast<int>(columns[static_cast<std::size_t>(column)]);
      cap_of_[static_cast<std::size_t>(track.chosen)] = static_cast<int>(rows[i]);
    }
    if (assignment_.margin(i) < kDoubt) doubt(track);
  }
}

void CapTracker::doubt(TrackState& track) {
  if (track.evidence.robot >= 0) ++counts_.unbound;
  track.evidence.forget();
}

void CapTracker::noteDetected(TrackState& track, double time, detector::Detection detection) {
  // A degraded pose has the expected heading and a less accurate place.
  const bool sharp = !isDegraded(detection);
  if (sharp) correctFlip(track, time, detection);
  const dynamics::Pose pose = poseOf(detection);
  const double span = time - track.last;
  if (span > kLost) {
    track.speeds = {};
  } else if (span > 1e-3 && sharp && !isDegraded(track.detection)) {
    const Wheels travel = wheelsBetween(track.pose, pose, settings_.wheel_base);
    const double most = settings_.max_wheel_speed;
    const auto blend = [&](double old, double measured) {
      return std::clamp(0.3 * old + 0.7 * measured / span, -most, most);
    };
    track.speeds = {blend(track.speeds.left, travel.left), blend(track.speeds.right, travel.right)};
  }
  if (span > kLost && track.blanks > 0) {  // its path in between is unknown
    track.stride_time = time;
    track.stride_pose = pose;
  } else if (sharp && time - track.stride_time >= kStride) {
    const double travel = std::hypot(pose.x - track.stride_pose.x, pose.y - track.stride_pose.y);
    track.top_speed = std::max(track.top_speed, travel / (time - track.stride_time));
    track.stride_time = time;
    track.stride_pose = pose;
  }
  track.pose = pose;
  track.covariance = detection.covariance;
  track.detection = detection;
  track.last = time;
  track.detected = true;
  track.undetected = 0;
  track.blanks = 0;
}

void CapTracker::correctFlip(TrackState& track, double time, detector::Detection& detection) {
  const double elapsed = std::max(0.0, time - track.last);
  double limit = turnOf(elapsed);
  double from = track.pose.theta;
  if (limit > 0.4 * kPi) {
    // It may really have turned round: only its own wheel reports can tell.
    const Reckoning reckoning = reckon(track, time);
    limit = 4 * std::sqrt(reckoning.covariance[5]) + 0.1;
    from = reckoning.pose.theta;
    if (reckoning.known < 0.9 * elapsed || limit > 0.4 * kPi) return;
  }
  limit += 4 * std::sqrt(detection.covariance[5] + track.covariance[5]);
  const double turned = std::abs(wrapAngle(detection.theta - from));
  if (turned <= limit || kPi - turned > limit) {
    if (turned <= limit) track.votes = std::min(track.votes + 1, kVotes);
    return;
  }
  if (--track.votes < 0) {
    // The heading was wrong from the beginning; accept the opposite one.
    track.votes = 1;
    track.speeds = {-track.speeds.right, -track.speeds.left};
    track.pose.theta = wrapAngle(track.pose.theta + kPi);
    track.evidence.begun = false;
    return;
  }
  ++counts_.flips;
  detection.theta = wrapAngle(detection.theta + kPi);
  std::swap(detection.big, detection.small);
  detection.quality = std::min(detection.quality, kFlippedQuality);
}

void CapTracker::noteUndetected(TrackState& track, double time, bool lit) {
  const Reckoning reckoning = reckon(track, time);
  detector::Detection& detection = track.detection;
  detection.x = reckoning.pose.x;
  detection.y = reckoning.pose.y;
  detection.theta = wrapAngle(reckoning.pose.theta);
  detection.covariance = reckoning.covariance;
  detection.quality = 0;
  detection.used = 0;
  detection.spacing = 0;
  track.detected = false;
  if (lit) ++track.undetected;
  ++track.blanks;
}

void CapTracker::start(double time, const detector::Detection& detection) {
  TrackState track;
  track.number = next_number_++;
  track.pose = poseOf(detection);
  track.covariance = detection.covariance;
  track.detection = detection;
  track.first = time;
  track.last = time;
  track.stride_time = time;
  track.stride_pose = track.pose;
  track.evidence.pairs.resize(binding_.robots());
  track_states_.push_back(std::move(track));
}

void CapTracker::giveUp(double time) {
  const auto isLost = [&](const TrackState& track) {
    if (track.detected) return false;
    const double timeout = std::min(kGiveUp, kBriefly + track.last - track.first);
    const detector::Detection& at = track.detection;
    return time - track.last > timeout || at.x < -kOutside || at.y < -kOutside ||
           at.x > settings_.arena_width + kOutside || at.y > settings_.arena_height + kOutside;
  };
  const auto end = std::remove_if(track_states_.begin(), track_states_.end(), isLost);
  counts_.lost += track_states_.end() - end;
  track_states_.erase(end, track_states_.end());
}

bool CapTracker::isTouching(const TrackState& track) const {
  const dynamics::Pose& at = track.pose;
  const double wall = settings_.robot_radius + kTouch;
  if (at.x < wall || at.y < wall || at.x > settings_.arena_width - wall ||
      at.y > settings_.arena_height - wall) {
    return true;
  }
  const double near = 2 * settings_.robot_radius + kTouch;
  return std::any_of(track_states_.begin(), track_states_.end(), [&](const TrackState& other) {
    const double dx = other.pose.x - at.x;
    const double dy = other.pose.y - at.y;
    return &other != &track && dx * dx + dy * dy < near * near;
  });
}

void CapTracker::compareMotion(double time) {
  evidence_.clear();
  for (TrackState& track : track_states_) {
    IdentityEvidence& evidence = track.evidence;
    evidence.placed = track.detected && !isDegraded(track.detection);
    evidence.place = track.pose;
    const double half_base = settings_.wheel_base / 2;
    evidence.variance = (track.covariance[0] + track.covariance[3]) / 2 +
                        half_base * half_base * track.covariance[5];
    evidence.touching = isTouching(track);
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
  for (TrackState& track : track_states_) {
    const double distance = distance2(track.pose, place);
    if (!track.detected || isDegraded(track.detection) || distance > least) continue;
    least = distance;
    nearest = &track;
  }
  if (nearest == nullptr) return false;
  if (nearest->evidence.robot == robot) return true;
  for (TrackState& track : track_states_) {
    if (track.evidence.robot == robot) doubt(track);
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
    const TrackState& track = track_states_[i];
    tracks_[i] = {track.number, binding_.idOf(track.evidence.robot), track.detection,
                  track.detected, track.detected ? 0 : time - track.last};
  }
}

}  // namespace lab::tracker
