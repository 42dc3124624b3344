#include "tracker_svc/tracking/motion.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/angle.hpp"

namespace lab::tracker {
namespace {

double square(double x) { return x * x; }

/// A pose with its covariance and its derivatives by the gains of the wheels.
class Chain {
 public:
  Chain(const dynamics::Pose& from, const std::array<double, 6>& covariance, double wheel_base)
      : pose_(from), c_(covariance), wheel_base_(wheel_base) {}

  /// Adds one arc; `left` and `right` variances are random errors of the travels.
  void move(Wheels travel, Wheels variance) {
    const double forward = (travel.left + travel.right) / 2;
    const double turn = (travel.right - travel.left) / wheel_base_;
    const dynamics::Arc arc = dynamics::makeArcOf(forward, turn, 1);
    const double middle = pose_.theta + turn / 2;
    const double cosine = std::cos(middle);
    const double sine = std::sin(middle);
    const double chord = std::hypot(arc.dx, arc.dy) * (forward < 0 ? -1 : 1);
    const double dx = chord * cosine;
    const double dy = chord * sine;
    turnErrors(dx, dy);
    // Additional travel of one wheel: half of it forward, the rest as turn.
    const double l[3] = {cosine / 2, sine / 2, -1 / wheel_base_};
    const double r[3] = {cosine / 2, sine / 2, 1 / wheel_base_};
    for (int i = 0; i < 3; ++i) {
      by_left_gain_[i] += l[i] * travel.left;
      by_right_gain_[i] += r[i] * travel.right;
    }
    addNoise(l, variance.left);
    addNoise(r, variance.right);
    pose_.x += dx;
    pose_.y += dy;
    pose_.theta += turn;
  }

  [[nodiscard]] const dynamics::Pose& pose() const { return pose_; }

  [[nodiscard]] std::array<double, 6> covariance(double gain_error) {
    addNoise(by_left_gain_, square(gain_error));
    addNoise(by_right_gain_, square(gain_error));
    return c_;
  }

 private:
  /// Propagates an error of the heading to the end of a step.
  void turnErrors(double dx, double dy) {
    const double xt = c_[2];
    const double yt = c_[4];
    const double tt = c_[5];
    c_[0] += -2 * dy * xt + dy * dy * tt;
    c_[1] += dx * xt - dy * yt - dx * dy * tt;
    c_[2] += -dy * tt;
    c_[3] += 2 * dx * yt + dx * dx * tt;
    c_[4] += dx * tt;
    for (double* by : {by_left_gain_, by_right_gain_}) {
      by[0] += -dy * by[2];
      by[1] += dx * by[2];
    }
  }

  void addNoise(const double (&by)[3], double variance) {
    c_[0] += by[0] * by[0] * variance;
    c_[1] += by[0] * by[1] * variance;
    c_[2] += by[0] * by[2] * variance;
    c_[3] += by[1] * by[1] * variance;
    c_[4] += by[1] * by[2] * variance;
    c_[5] += by[2] * by[2] * variance;
  }

  dynamics::Pose pose_;
  std::array<double, 6> c_;
  double wheel_base_;
  double by_left_gain_[3] = {0, 0, 0};
  double by_right_gain_[3] = {0, 0, 0};
};

}  // namespace

Wheels wheelsBetween(const dynamics::Pose& from, const dynamics::Pose& to, double wheel_base) {
  const double turn = wrapAngle(to.theta - from.theta);
  const double middle = from.theta + turn / 2;
  const double chord = (to.x - from.x) * std::cos(middle) + (to.y - from.y) * std::sin(middle);
  // Ratio of arc to chord: half / sin(half), by its series where that is exact to 1e-6.
  const double half = turn / 2;
  const double forward =
      chord * (std::abs(half) < 0.1 ? 1 + half * half / 6 : half / std::sin(half));
  return {forward - turn * wheel_base / 2, forward + turn * wheel_base / 2};
}

Reckoning DeadReckoner::reckon(const dynamics::Pose& from, const std::array<double, 6>& covariance,
                               Wheels speeds, const WheelLog* reports, double begin, double end) {
  Reckoning result;
  Chain chain(from, covariance, settings_.wheel_base);
  double time = begin;
  double idle = 0;  // [s] since the wheels' speeds were last reported
  const auto assume = [&](double until) {
    const double span = until - time;
    if (span <= 0) return;
    // The mean speed decays over the span; the rest of what wheels can do is random.
    const double share = kMemory * (std::exp(-idle / kMemory) - std::exp(-(idle + span) / kMemory));
    const double spread =
        square(settings_.max_wheel_speed / 3 * span) * std::min(1.0, (idle + span) / kMemory);
    chain.move({speeds.left * share, speeds.right * share}, {spread, spread});
    result.travel += std::abs(speeds.left + speeds.right) / 2 * share;
    result.assumed += span;
    idle += span;
    time = until;
  };
  segments_.clear();
  if (reports != nullptr) reports->segments(begin, end, segments_);
  for (const WheelSegment& part : segments_) {
    assume(part.begin);
    const double span = part.end - part.begin;
    const double when = square(part.end - part.begin) / 12 + square(WheelLog::kTimeError);
    const double random = square(WheelLog::kRandomWay) * span;
    chain.move({part.left * span, part.right * span},
               {random + square(part.left_step) * when, random + square(part.right_step) * when});
    result.travel += std::abs(part.left + part.right) / 2 * span;
    result.known += span;
    speeds = {part.left, part.right};
    idle = 0;
    time = part.end;
  }
  assume(end);
  result.pose = chain.pose();
  result.covariance = chain.covariance(kGainError);
  return result;
}

}  // namespace lab::tracker
