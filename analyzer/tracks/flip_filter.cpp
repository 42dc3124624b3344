#include "analyzer/tracks/flip_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analyzer/tracks/track_stitcher.hpp"
#include "common/math/angle.hpp"

namespace lab::analysis {
namespace {

constexpr double kSigmas = 7;
constexpr double kSlack = 0.2;            // rad beyond the possible turn and the noise
constexpr double kLogOdds = 20.7;         // ln 1e9
constexpr double kLeastDistance = 0.005;  // m: far beyond the noise of any tracker in use

}  // namespace

double senseDistance(const ProgramLaw& law) {
  if (const auto speed = law->constantSpeed()) {
    return *speed == 0 ? 0 : std::copysign(kLeastDistance, *speed);
  }
  const auto wheels = law->drawnWheels();
  if (!wheels || !(std::abs(wheels->mean) > 0)) return 0;
  const double rate = law->drawTime() * wheels->half_width * wheels->half_width / 6;
  return std::copysign(std::max(kLeastDistance, kLogOdds * rate / (2 * std::abs(wheels->mean))),
                       wheels->mean);
}

double FlipFilter::reach(const Reference& from, const Reference& to) const {
  return config_.max_turn_rate * (to.time - from.time) +
         kSigmas * std::hypot(from.sigma, to.sigma) + kSlack;
}

FlipFilter::Relation FlipFilter::relate(const Reference& from, const Reference& to) const {
  const double most = reach(from, to);
  const double turn = wrapAngle(to.theta - from.theta);
  if (std::abs(turn) <= most) return Relation::kSame;
  return std::abs(wrapAngle(turn - std::numbers::pi)) <= most ? Relation::kFlipped
                                                              : Relation::kNone;
}

void FlipFilter::accept(const Reference& reference) {
  older_ = last_;
  last_ = reference;
  suspect_.reset();
}

bool FlipFilter::correct(TrackPoint& point) {
  Reference now{point.time, point.theta, point.sigma_theta};
  if (turned_) now.theta = wrapAngle(now.theta + std::numbers::pi);
  Relation relation = last_ ? relate(*last_, now) : Relation::kSame;
  if (relation != Relation::kSame && older_) {
    const Relation other = relate(*older_, now);
    if (other == Relation::kSame || relation == Relation::kNone) relation = other;
  }
  if (relation == Relation::kFlipped) {
    ++jumps_;
    turned_ = !turned_;
    now.theta = turned_ ? wrapAngle(point.theta + std::numbers::pi) : point.theta;
  }
  if (relation != Relation::kNone) {
    // After so long a gap the wheels could have made either jump.
    const bool either = last_ && reach(*last_, now) > std::numbers::pi / 2;
    chain_ += either ? 1 : 0;
    accept(now);
  } else if (suspect_ && relate(*suspect_, now) == Relation::kSame) {
    // Two headings agree with each other and not with the track: begin a new chain.
    last_.reset();
    forward_drive_ = 0;
    ++chain_;
    accept(now);
  } else {
    suspect_ = now;
  }
  if (turned_) point.theta = now.theta;
  return turned_;
}

bool FlipFilter::addMotion(double forward, double sense_distance) {
  if (sense_distance == 0) return false;
  const double enough = std::abs(sense_distance);
  forward_drive_ = std::min(forward_drive_ + (sense_distance < 0 ? -forward : forward), enough);
  if (forward_drive_ > -enough) return false;
  turned_ = !turned_;
  forward_drive_ = 0;
  ++chain_;
  for (std::optional<Reference>* one : {&last_, &older_, &suspect_}) {
    if (*one) (*one)->theta = wrapAngle((*one)->theta + std::numbers::pi);
  }
  return true;
}

}  // namespace lab::analysis
