#include "tracker_svc/tracking/reappearance_density.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/math/angle.hpp"

namespace lab::tracker {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFree = 0.4;  // [1] probability that it drove as reckoned; low in a crowd
// [1] probability that it was in contact; used if its wheel motion is known
constexpr double kHeldUp = 0.59;
constexpr double kAnywhere = 0.01;    // [1]
constexpr double kByHand = 1e-4;      // [1]
constexpr double kSlack = 0.02;       // [m]
constexpr double kPlaceNoise = 2e-4;  // [m] of any detection, in addition to its covariance
constexpr double kTurnNoise = 5e-3;   // [rad]

double square(double x) { return x * x; }

/// Density of a normal distribution of place and heading.
double normalDensity(const std::array<double, 3>& d, const std::array<double, 6>& c) {
  // Cholesky: c = L L^T; z = L^-1 d.
  const double l00 = std::sqrt(c[0]);
  const double l10 = c[1] / l00;
  const double l20 = c[2] / l00;
  const double l11 = std::sqrt(std::max(c[3] - l10 * l10, 1e-12));
  const double l21 = (c[4] - l20 * l10) / l11;
  const double l22 = std::sqrt(std::max(c[5] - l20 * l20 - l21 * l21, 1e-9));
  const double z0 = d[0] / l00;
  const double z1 = (d[1] - l10 * z0) / l11;
  const double z2 = (d[2] - l20 * z0 - l21 * z1) / l22;
  return std::exp(-(z0 * z0 + z1 * z1 + z2 * z2) / 2) / (std::pow(2 * kPi, 1.5) * l00 * l11 * l22);
}

/// Distance uniform up to `reach`, direction and heading uniform: prefers near places without a
/// length scale.
double anywhereDensity(double distance, double reach) {
  if (distance > reach) return 0;
  return 1 / (2 * kPi * std::max(distance, kSlack) * reach) / (2 * kPi);
}

}  // namespace

ReappearanceDensity::ReappearanceDensity(const dynamics::Pose& from, const Reckoning& free,
                                         double reach, double speed)
    : from_(from), free_(free), reach_(reach) {
  const double time = free.known + free.assumed;
  known_ = time > 0 ? free.known / time : 0;
  kept_ = std::exp(-free.assumed / DeadReckoner::kMemory);
  drift_ = speed * free.assumed + kSlack;
}

double ReappearanceDensity::logDensity(const detector::Detection& detection) const {
  const double distance = std::hypot(detection.x - from_.x, detection.y - from_.y);
  if (distance > 2 * reach_) return -1e9;
  std::array<double, 6> c = free_.covariance;
  for (std::size_t i = 0; i < c.size(); ++i) c[i] += detection.covariance[i];
  c[0] += square(kPlaceNoise);
  c[3] += square(kPlaceNoise);
  c[5] += square(kTurnNoise);
  const double dx = detection.x - free_.pose.x;
  const double dy = detection.y - free_.pose.y;
  const double turned = wrapAngle(detection.theta - free_.pose.theta);
  double density = kept_ * kFree * normalDensity({dx, dy, turned}, c);
  // Held up: anywhere within the distance it could not drive; contacts may or may not prevent
  // turning.
  const double held = free_.travel + kSlack;
  if (distance <= held) {
    const double heading = std::exp(-square(turned) / (2 * c[5])) / std::sqrt(2 * kPi * c[5]);
    density += kept_ * known_ * kHeldUp / (kPi * square(held)) * (heading + 1 / (2 * kPi)) / 2;
  }
  // Unknown new speeds: anywhere they can have taken it since, with a heavy tail, so that a large
  // distance never excludes it.
  const double away2 = (dx * dx + dy * dy) / square(drift_);
  if (away2 <= 1) {
    const double all = kPi * square(drift_) / 2 * (1 - std::exp(-2.0)) * 2 * kPi;
    density += (1 - kept_) * std::exp(-2 * away2) / all;
  }
  density += kAnywhere * anywhereDensity(distance, reach_);
  density += kByHand * anywhereDensity(distance, 2 * reach_);
  return std::log(density);
}

}  // namespace lab::tracker
