#include "tracker_svc/tracking/motion_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>

#include "common/math/angle.hpp"

namespace lab::tracker {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kWideShare = 0.05;  // [1] of the steps
constexpr double kWide = 9;          // [1] variance of those over the others
constexpr double kGate = 12;         // [1] standard deviations beyond which nothing is linked
constexpr double kMemory = 3000;     // steps that the model remembers
constexpr double kLeastStep = 1e-6;  // [m]
constexpr double kFewSteps = 10;     // weight of the settings against learnt steps
constexpr double kLeastWeight = 1e-6;
constexpr int kRounds = 4;  // of learning from one picture
// Probability that a marker is missed, by the number of pictures since its last detection.
constexpr double kMissed[] = {0.02, 0.5, 0.9};

/// Density of a step [1/m^2] in two dimensions, and the share of its narrow part.
struct StepDensity {
  double density = 0;
  double narrow = 1;
};

StepDensity densityOf(double square, double variance) {
  const double a = (1 - kWideShare) / (2 * kPi * variance) * std::exp(-square / (2 * variance));
  const double wide = kWide * variance;
  const double b = kWideShare / (2 * kPi * wide) * std::exp(-square / (2 * wide));
  return {a + b, a + b > 0 ? a / (a + b) : 0};
}

/// The square of a step [m^2], scaled so that its mean is twice the variance.
double scaledSquare(double square, double narrow) {
  return square * (narrow + (1 - narrow) / kWide);
}

}  // namespace

struct MotionTracker::TrackState {
  std::int64_t number = 0;
  detector::Detection pose;  ///< of its last detection
  double last = 0;           ///< [s]
  double vx = 0;             ///< [m/s] of the last step
  double vy = 0;             ///< [m/s]
  bool moves = false;        ///< whether there was a step
  int missed = 0;            ///< pictures since its last detection
  double swap = 0;           ///< [1] probability that its last step was one between two markers
  double forward = 0;        ///< [m] way along its heading, the last lengths of it
  bool detected = true;
};

MotionTracker::MotionTracker(const MotionTrackerSettings& settings) : settings_(settings) {
  model_.first = settings.step * settings.step / 2;
  model_.variance = model_.first;
}

MotionTracker::~MotionTracker() = default;

MotionTracker::Prediction MotionTracker::predict(const TrackState& track, double time) const {
  const double elapsed = std::max(0.0, time - track.last);
  const double interval = model_.interval > 0 ? model_.interval : elapsed;
  Prediction result{track.pose.x, track.pose.y, 0, 1};
  if (interval > 0) result.steps = std::max(elapsed / interval, 0.1);
  const double error = (track.pose.covariance[0] + track.pose.covariance[3]) / 2;
  if (!track.moves) {
    result.variance = model_.first * result.steps * result.steps + error;
    return result;
  }
  // Steps x_1, x_2 ... with x_k = p x_{k-1} + noise: mean and variance of their sum.
  const double p = std::clamp(model_.persistence, -0.5, 1.0);
  const auto count = static_cast<int>(std::clamp(std::lround(result.steps), 1L, 1000L));
  double mean = 0;
  double power = 1;
  double gain = 0;
  double variance = 0;
  for (int k = 0; k < count; ++k) {
    gain += power;
    variance += gain * gain;
    power *= p;
    mean += power;
  }
  const double scale = result.steps / count;
  result.x += track.vx * interval * mean * scale;
  result.y += track.vy * interval * mean * scale;
  // After a doubtful link the last step may have been that between two markers.
  const double speed2 = track.vx * track.vx + track.vy * track.vy;
  const double doubt = track.swap * (1 - track.swap) * speed2;
  const double way = interval * mean * scale;
  result.variance = model_.variance * variance * scale * scale + doubt * way * way;
  return result;
}

const std::vector<detector::Expected>& MotionTracker::expect(double time) {
  expected_.clear();
  for (const TrackState& track : states_) {
    const Prediction at = predict(track, time);
    expected_.push_back({at.x, at.y, track.pose.theta, kGate * std::sqrt(at.variance), kPi});
  }
  return expected_;
}

const std::vector<Track>& MotionTracker::update(double time,
                                                std::span<const detector::Detection> detections) {
  found_.clear();
  for (const detector::Detection& detection : detections) {
    if (detection.quality > 0 && detection.merged == 1 && std::isfinite(detection.x) &&
        std::isfinite(detection.y)) {
      found_.push_back(detection);
    }
  }
  if (pictures_ > 0) {
    const double interval = time - last_time_;
    model_.interval =
        model_.interval > 0 ? model_.interval + 0.1 * (interval - model_.interval) : interval;
  }
  findLinks(time);
  learn(time);
  assign();
  std::vector<bool> taken(found_.size(), false);
  for (std::size_t i = 0; i < states_.size(); ++i) {
    TrackState& track = states_[i];
    track.detected = chosen_[i] >= 0;
    if (!track.detected) {
      ++track.missed;
      continue;
    }
    taken[static_cast<std::size_t>(chosen_[i])] = true;
    noteDetected(track, time, found_[static_cast<std::size_t>(chosen_[i])]);
    track.swap = swap_[i];
  }
  // Tracks that end.
  std::size_t kept = 0;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (!states_[i].detected && time - states_[i].last > settings_.patience) {
      ++counts_.lost;
      continue;
    }
    states_[kept] = states_[i];
    swap_[kept] = swap_[i];
    ++kept;
  }
  states_.resize(kept);
  swap_.resize(kept);
  for (std::size_t j = 0; j < found_.size(); ++j) {
    if (taken[j]) continue;
    TrackState track;
    track.number = next_number_++;
    track.pose = found_[j];
    track.last = time;
    states_.push_back(track);
    swap_.push_back(0);
    if (pictures_ > 0) ++news_;
  }
  ++pictures_;
  last_time_ = time;
  publish(time);
  return tracks_;
}

/// All links within the gate, with their weights and probabilities.
void MotionTracker::findLinks(double time) {
  links_.clear();
  predictions_.clear();
  for (const TrackState& track : states_) predictions_.push_back(predict(track, time));
  // [1/m^2] of markers that appear, per picture
  const double news = (news_ + 0.5) / static_cast<double>(pictures_ + 10) / settings_.area;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const Prediction& at = predictions_[i];
    const auto missed = std::min<std::size_t>(static_cast<std::size_t>(states_[i].missed), 2);
    const double by_miss = (1 - kMissed[missed]) / (kMissed[missed] * news);
    const double fastest = settings_.max_speed * (time - states_[i].last);
    for (std::size_t j = 0; j < found_.size(); ++j) {
      const double dx = found_[j].x - at.x;
      const double dy = found_[j].y - at.y;
      const double variance = at.variance + (found_[j].covariance[0] + found_[j].covariance[3]) / 2;
      const double square = dx * dx + dy * dy;
      if (square > kGate * kGate * variance) continue;
      if (settings_.max_speed > 0 &&
          std::hypot(found_[j].x - states_[i].pose.x, found_[j].y - states_[i].pose.y) > fastest) {
        continue;
      }
      const double weight = by_miss * densityOf(square, variance).density;
      if (weight > kLeastWeight) links_.push_back({i, j, weight});
    }
  }
  link_probabilities_ = probabilities_.of(links_);
}

/// Learns the steps from every possible link, weighted with its probability.
void MotionTracker::learn(double time) {
  // The first pictures decide: they are read again with what they taught.
  const int rounds = first_weight_ + weight_ < 20 * kFewSteps ? kRounds : 1;
  const double first_weight = first_weight_;
  const double first_square = first_square_;
  const double old_weight = weight_;
  const double old_square = square_;
  const double old_product = product_;
  const double old_before = before_;
  for (int round = 0; round < rounds; ++round) {
    first_weight_ = first_weight;
    first_square_ = first_square;
    weight_ = old_weight;
    square_ = old_square;
    product_ = old_product;
    before_ = old_before;
    double learnt = 0;
    for (std::size_t k = 0; k < links_.size(); ++k) {
      const Link& link = links_[k];
      const double p = link_probabilities_[k];
      const TrackState& track = states_[link.track];
      if (track.missed > 0 || p < 1e-4) continue;
      const Prediction& at = predictions_[link.track];
      const detector::Detection& detection = found_[link.detection];
      const double x = detection.x - track.pose.x;
      const double y = detection.y - track.pose.y;
      learnt += p;
      if (!track.moves) {
        first_weight_ += p;
        const double square = x * x + y * y;
        first_square_ += p * scaledSquare(square, densityOf(square, at.variance).narrow) / 2;
        continue;
      }
      const double u = detection.x - at.x;
      const double v = detection.y - at.y;
      const double square = u * u + v * v;
      weight_ += p;
      square_ += p * scaledSquare(square, densityOf(square, at.variance).narrow) / 2;
      const double bx = track.vx * model_.interval;
      const double by = track.vy * model_.interval;
      product_ += p * (x * bx + y * by);
      before_ += p * (bx * bx + by * by);
    }
    const double start = settings_.step * settings_.step / 2;
    const double least = kLeastStep * kLeastStep;
    model_.first = std::max(
        least, (first_square_ + kFewSteps * 0.1 * start) / (first_weight_ + kFewSteps * 0.1));
    model_.variance =
        std::max(least, (square_ + kFewSteps * 0.1 * model_.first) / (weight_ + kFewSteps * 0.1));
    model_.persistence = product_ / (before_ + kFewSteps * (model_.first + least));
    const double keep = std::exp(-learnt / kMemory);
    if (round + 1 < rounds) {
      findLinks(time);
    } else {
      weight_ *= keep;
      square_ *= keep;
      product_ *= keep;
      before_ *= keep;
    }
  }
}

/// The most likely assignment, group by group.
void MotionTracker::assign() {
  chosen_.assign(states_.size(), -1);
  swap_.assign(states_.size(), 0);
  for (const std::vector<std::size_t>& group : probabilities_.groups()) {
    std::map<std::size_t, std::size_t> rows;
    std::map<std::size_t, std::size_t> columns;
    std::vector<std::size_t> detections;
    for (const std::size_t k : group) {
      rows.try_emplace(links_[k].track, rows.size());
      if (columns.try_emplace(links_[k].detection, columns.size()).second) {
        detections.push_back(links_[k].detection);
      }
    }
    assignment_.reset(rows.size(), columns.size());
    for (const std::size_t k : group) {
      assignment_.allow(rows[links_[k].track], columns[links_[k].detection],
                        -std::log(links_[k].weight));
    }
    assignment_.solve();
    for (const auto& [track, row] : rows) {
      const int column = assignment_.columnOf(row);
      if (column < 0) continue;
      chosen_[track] = static_cast<int>(detections[static_cast<std::size_t>(column)]);
    }
    for (const std::size_t k : group) {
      if (chosen_[links_[k].track] == static_cast<int>(links_[k].detection)) {
        swap_[links_[k].track] = std::clamp(1 - link_probabilities_[k], 0.0, 1.0);
      }
    }
  }
}

void MotionTracker::noteDetected(TrackState& track, double time,
                                 const detector::Detection& detection) {
  const double elapsed = time - track.last;
  const double dx = detection.x - track.pose.x;
  const double dy = detection.y - track.pose.y;
  detector::Detection pose = detection;
  direct(track, pose, dx, dy);
  if (elapsed > 0) {
    track.vx = dx / elapsed;
    track.vy = dy / elapsed;
    track.moves = true;
  }
  track.pose = pose;
  track.last = time;
  track.missed = 0;
}

/// Turns the axis of a blob by half a turn if its head is probably at the other end.
void MotionTracker::direct(TrackState& track, detector::Detection& pose, double dx,
                           double dy) const {
  if (pose.heading != detector::HeadingKind::kAxis) return;
  constexpr double kLengths = 3;  // of the blob that are remembered
  const auto length = std::max(static_cast<double>(pose.length), 1e-6);
  if (track.pose.heading != detector::HeadingKind::kUnknown &&
      std::abs(wrapAngle(pose.theta - track.pose.theta)) > kPi / 2) {
    pose.theta = wrapAngle(pose.theta + kPi);
  }
  const double way = dx * std::cos(pose.theta) + dy * std::sin(pose.theta);
  track.forward = std::clamp(track.forward + way, -kLengths * length, kLengths * length);
  if (track.forward < -length / 2) {
    track.forward = -track.forward;
    pose.theta = wrapAngle(pose.theta + kPi);
  }
}

void MotionTracker::publish(double time) {
  tracks_.clear();
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const TrackState& state = states_[i];
    Track track{state.number, -1, state.pose, state.detected, 0, swap_[i]};
    if (!state.detected) {
      const Prediction at = predict(state, time);
      track.pose.x = at.x;
      track.pose.y = at.y;
      track.pose.covariance[0] = track.pose.covariance[3] = at.variance;
      track.pose.quality = 0;
      track.pose.used = 0;
      track.since_detection = time - state.last;
    }
    tracks_.push_back(track);
  }
}

}  // namespace lab::tracker
