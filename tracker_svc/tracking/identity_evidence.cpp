#include "tracker_svc/tracking/identity_evidence.hpp"

#include <cmath>
#include <numbers>

namespace lab::tracker {
namespace {

constexpr double kLikeOthers = 0.9;    // [1] probability that a foreign cap's new speeds follow the
                                       // distribution of robots' speeds
constexpr std::size_t kSamples = 128;  // number of stored robot speeds
constexpr std::size_t kSamplesASlice = 3;  // so that they cover about four seconds
constexpr double kFade = 0.995;            // [1] per slice: forgets within half a minute
constexpr double kStallBegins = -0.7;   // [ln] a cap in contact is held up about every second time
constexpr double kStallAlone = -5;      // [ln] a cap without visible contact is hardly ever held up
constexpr double kStallGoesOn = -0.02;  // [ln]
constexpr double kOneOfThree = 1.1;     // [ln] the change may be inside, before or after the slice
constexpr double kTurnsAnew = 3;  // [ln] least likelihood of a change of a foreign cap's turn rate
constexpr double kStallEnds = -0.7;       // [ln]
constexpr double kStallEndsAlone = -2.3;  // [ln]
const double kLogTwoPi = std::log(2 * std::numbers::pi);
constexpr double kPushed = -9.2;   // [ln] one slice in 10000: moved by something else
constexpr double kSlips = -1;      // [ln] in contact, every third slice: by what it touches
constexpr double kForget = 0.998;  // [1] per slice: forgets within a minute

double square(double x) { return x * x; }

/// Whether a travel lies between 0 and the reported one.
bool isSlower(double travel, double reported, double tolerance) {
  return travel >= std::min(0.0, reported) - tolerance &&
         travel <= std::max(0.0, reported) + tolerance;
}

}  // namespace

void MotionPrior::add(std::span<const WheelPath> paths, double duration) {
  for (double* sum :
       {&weight_, &left_, &right_, &left_left_, &left_right_, &right_right_, &changes_, &slices_}) {
    *sum *= kFade;
  }
  int known = 0;
  int changed = 0;
  for (const WheelPath& path : paths) {
    if (!path.known) continue;
    addNormal(path, duration);
    ++known;
    changed += path.changed ? 1 : 0;
  }
  together_ = changed > 1 ? static_cast<double>(changed - 1) / known : 0;
  for (std::size_t i = 0; i < std::min(kSamplesASlice, paths.size()); ++i) {
    const WheelPath& path = paths[next_robot_++ % paths.size()];
    if (!path.known) continue;
    if (samples_.size() < kSamples) samples_.emplace_back();
    samples_[next_sample_++ % kSamples] = {path.left / duration, path.right / duration};
  }
}

void MotionPrior::addNormal(const WheelPath& path, double duration) {
  const double left = path.left / duration;
  const double right = path.right / duration;
  weight_ += 1;
  left_ += left;
  right_ += right;
  left_left_ += left * left;
  left_right_ += left * right;
  right_right_ += right * right;
  slices_ += 1;
  if (path.changed) changes_ += 1;
}

double MotionPrior::normalDensity(const Wheels& travel, double variance, double duration) const {
  if (weight_ <= 0) return 0;
  const double left = left_ / weight_;
  const double right = right_ / weight_;
  const double time2 = duration * duration;
  const double ll = std::max(0.0, left_left_ / weight_ - left * left) * time2 + variance;
  const double rr = std::max(0.0, right_right_ / weight_ - right * right) * time2 + variance;
  const double lr = (left_right_ / weight_ - left * right) * time2;
  const double determinant = std::max(ll * rr - lr * lr, variance * variance);
  const double dl = travel.left - left * duration;
  const double dr = travel.right - right * duration;
  return std::exp(-(dl * dl * rr - 2 * dl * dr * lr + dr * dr * ll) / (2 * determinant)) /
         (2 * std::numbers::pi * std::sqrt(determinant));
}

double MotionPrior::density(const Wheels& travel, double variance, double duration,
                            double fastest) const {
  double sampled = 0;
  for (const Wheels& sample : samples_) {
    const double z = (square(travel.left - sample.left * duration) +
                      square(travel.right - sample.right * duration)) /
                     (2 * variance);
    if (z < 15) sampled += std::exp(-z);
  }
  if (!samples_.empty()) {
    sampled /= 2 * std::numbers::pi * variance * static_cast<double>(samples_.size());
  }
  return kLikeOthers / 2 * (sampled + normalDensity(travel, variance, duration)) +
         (1 - kLikeOthers) / square(2 * fastest);
}

void PairEvidence::add(const SliceMotion& cap, const WheelPath& robot, double highest) {
  Driven driven =
      compare(cap, {robot.left, robot.right},
              {robot.left_variance + cap.variance, robot.right_variance + cap.variance});
  if (robot.changed) {
    // The speeds changed in the slice, or just before or after it.
    driven.value -= kOneOfThree;
    for (const Wheels& travel :
         {Wheels{robot.first_left, robot.first_right}, Wheels{robot.last_left, robot.last_right}}) {
      Driven steady =
          compare(cap, travel,
                  {WheelLog::randomVariance(travel.left, cap.duration) + cap.variance,
                   WheelLog::randomVariance(travel.right, cap.duration) + cap.variance});
      steady.value -= kOneOfThree;
      if (steady.value > driven.value) driven = steady;
    }
  }
  if (stalled_) driven.value += cap.touching ? kStallEnds : kStallEndsAlone;
  const double variance = robot.left_variance + robot.right_variance + 2 * cap.variance;
  const double otherwise = std::max(kPushed, heldUp(cap, robot, variance));

  rest_ *= kForget;
  left_uu_ *= kForget;
  left_ue_ *= kForget;
  right_uu_ *= kForget;
  right_ue_ *= kForget;
  stalled_ = otherwise > driven.value && otherwise > kPushed;
  pushed_ = std::max(driven.value, otherwise) < kPushed / 2;
  if (driven.value >= otherwise) {
    addDriven(cap, driven);
  } else {
    rest_ += otherwise;
  }
  sum(highest);
}

PairEvidence::Driven PairEvidence::compare(const SliceMotion& cap, const Wheels& travel,
                                           const Wheels& variance) {
  const double gain2 = square(DeadReckoner::kGainError);
  const double error =
      (square(cap.travel.left - travel.left) / (variance.left + gain2 * square(travel.left)) +
       square(cap.travel.right - travel.right) / (variance.right + gain2 * square(travel.right))) /
      2;
  const double normaliser = kLogTwoPi + std::log(variance.left * variance.right) / 2;
  return {-error - normaliser - cap.foreign, error, travel, variance};
}

/// In contact a robot moves forward less than its wheels, by an amount as unknown as that of a
/// foreign cap, or backwards if it reverses more often than it reports. It turns as its wheels, or
/// less. It may also slip: others push and turn it.
double PairEvidence::heldUp(const SliceMotion& cap, const WheelPath& robot, double variance) const {
  const double tolerance = 3 * std::sqrt(variance);
  const double forward = (cap.travel.left + cap.travel.right) / 2;
  const double turn = cap.travel.right - cap.travel.left;
  const double full_turn = robot.right - robot.left;
  const double slips = cap.touching ? kSlips : kPushed;
  const bool faster = std::abs(forward) > std::abs(robot.left + robot.right) / 2 + tolerance / 2;
  if (faster && !cap.touching) return kPushed;
  const double before = cap.before.right - cap.before.left;
  // An agreement of the turn is evidence only if a turn was reported.
  const double turns_anew = std::abs(full_turn) < tolerance
                                ? 0
                                : std::min(square(turn - before) / (2 * variance), kTurnsAnew);
  const double turning = turns_anew - square(turn - full_turn) / (2 * variance);
  const double resting = isSlower(turn, full_turn, tolerance) ? 0 : slips;
  // Foreign caps get into contact too: if the cap slowed down, this is no evidence.
  const double begins =
      std::min(0.0, (cap.touching ? kStallBegins : kStallAlone) + cap.speed_change_log_ratio);
  return (stalled_ ? kStallGoesOn : begins) + (faster ? slips : std::max(turning, resting));
}

void PairEvidence::addDriven(const SliceMotion& cap, const Driven& driven) {
  const double left_error = cap.travel.left - driven.travel.left;
  const double right_error = cap.travel.right - driven.travel.right;
  // The error without the contribution of the gains, which is in the sums.
  rest_ +=
      driven.value + driven.error -
      (square(left_error) / driven.variance.left + square(right_error) / driven.variance.right) / 2;
  left_uu_ += square(driven.travel.left) / driven.variance.left;
  left_ue_ += driven.travel.left * left_error / driven.variance.left;
  right_uu_ += square(driven.travel.right) / driven.variance.right;
  right_ue_ += driven.travel.right * right_error / driven.variance.right;
}

void PairEvidence::sum(double highest) {
  // Integrates the two gains over their normal prior: the gain in likelihood of the best gains,
  // minus the cost of their freedom.
  const double inverse = 1 / square(DeadReckoner::kGainError);
  value_ =
      rest_ +
      (square(left_ue_) / (inverse + left_uu_) + square(right_ue_) / (inverse + right_uu_)) / 2 -
      std::log((1 + left_uu_ / inverse) * (1 + right_uu_ / inverse)) / 2;
  const double limited = std::clamp(value_, kLowest, highest);
  rest_ += limited - value_;
  value_ = limited;
}

void IdentityEvidence::forget() {
  robot = -1;
  std::fill(pairs.begin(), pairs.end(), PairEvidence());
  motions = {};
  begun = false;
  speeds = {};
  speed_change_log_ratio = 0;
  candidate = -1;
  confirmed = 0;
  proven = false;
  suspect = false;
  contrary = 0;
}

}  // namespace lab::tracker
