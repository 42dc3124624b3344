#include "tracker_svc/detector.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "tracker_svc/detector/cap_check.hpp"

namespace lab::detector {
namespace {

constexpr double kMostUncertain = 0.06;  // [radii] standard deviation of a centre
constexpr double kClear = 0.6;           // [big radii] from a neighbour's circle's centre

// Outlines are the same all over a cell of so many pixels: where a fit begins and where it ends is
// in one cell, mostly, and what another outline would change is far less than what is fitted.
constexpr int kCell = 8;

double middleOfCell(double at) {
  return static_cast<double>(static_cast<int>(at) / kCell * kCell + kCell / 2);
}

}  // namespace

std::string_view toText(Reason reason) {
  switch (reason) {
    case Reason::kCircleFit:
      return "no clean circle";
    case Reason::kSize:
      return "wrong size";
    case Reason::kNoPartner:
      return "no partner";
    case Reason::kSpacing:
      return "wrong spacing";
    case Reason::kNoCap:
      return "no cap around it";
    case Reason::kTaken:
      return "belongs to another";
  }
  return "?";
}

Detector::Detector(const optics::CameraModel& camera, const optics::CapGeometry& cap,
                   const optics::Imaging& imaging)
    : camera_(camera),
      cap_(cap),
      imaging_(imaging),
      response_(imaging),
      scale_(camera, cap),
      search_(scale_, cap, imaging, camera.parameters().width, camera.parameters().height) {}

void Detector::setGamma(double gamma) {
  if (gamma == imaging_.gamma) return;
  imaging_.gamma = gamma;
  response_ = optics::CameraResponse(imaging_);
}

const std::vector<Detection>& Detector::search(const optics::GreyView& seen,
                                               std::vector<Rejection>* rejected,
                                               std::span<const Expected> expected) {
  if (rejected != nullptr) rejected->clear();
  found_.clear();
  if (!canRead(seen)) return found_;
  const optics::GreyView picture = response_.linear(seen);
  const Region all{0, 0, picture.width - 1, picture.height - 1};
  seen_.clear();
  look(picture, {&all, 1}, rejected);
  found_ = seen_;
  for (const DegradedPose& one : degradedPoses(picture, expected)) found_.push_back(one.pose);
  return found_;
}

bool Detector::canRead(const optics::GreyView& picture) const {
  return picture.data != nullptr && picture.width == camera_.parameters().width &&
         picture.height == camera_.parameters().height && picture.stride >= picture.width;
}

void Detector::look(const optics::GreyView& picture, std::span<const Region> regions,
                    std::vector<Rejection>* rejected) {
  rejected_spots_.clear();
  std::vector<RejectedSpot>* refused = rejected != nullptr ? &rejected_spots_ : nullptr;
  search_.findRound(picture, regions, spots_, refused);
  for (const Detection& pose : seen_) cover(pose);
  circles_.assign(2 * spots_.size(), Circle{});
  taken_.assign(spots_.size(), 0);
  gatherPairs(picture, 0, rejected);
  settlePairs(picture, rejected);
  // What shows only a part of its outline, as far as it is no part of a cap that is known by now.
  const std::size_t first = spots_.size();
  search_.findRest(isLightEven() ? Rows::kSome : Rows::kAll, spots_, refused);
  circles_.resize(2 * spots_.size());
  taken_.resize(spots_.size(), 0);
  gatherPairs(picture, first, rejected);
  settlePairs(picture, rejected);
  lookAgain(picture, rejected);
  settlePairs(picture, rejected);
  lookBeside(picture, rejected);
  if (rejected != nullptr) explainTheRest(*rejected);
}

double Detector::alone() const {
  const double offset = std::max(std::abs(cap_.big_offset), std::abs(cap_.small_offset));
  return 2 * cap_.robot_radius - offset - kClear * cap_.big_radius;
}

void Detector::cover(const Detection& pose) {
  const LocalScale& scale = scale_.near(pose.middle.x, pose.middle.y);
  search_.cover(pose.middle.x, pose.middle.y, alone() * static_cast<double>(scale.mean));
}

Detector::Circle& Detector::circleOf(int spot, bool big) {
  return circles_[2 * static_cast<std::size_t>(spot) + (big ? 0 : 1)];
}

const Detector::Circle& Detector::circleOf(int spot, bool big) const {
  return circles_[2 * static_cast<std::size_t>(spot) + (big ? 0 : 1)];
}

const Detector::Circle& Detector::fit(const optics::GreyView& picture, int spot, bool big) {
  const Circle& circle = circleOf(spot, big);
  if (circle.fitted) return circle;
  const Spot& from = spots_[static_cast<std::size_t>(spot)];
  return fitFrom(picture, {static_cast<double>(from.x), static_cast<double>(from.y)}, spot, big);
}

const Detector::Circle& Detector::fitFrom(const optics::GreyView& picture, optics::Pixel start,
                                          int spot, bool big, bool glare) {
  Circle& circle = circleOf(spot, big);
  circle = Circle{};
  circle.fitted = true;
  const double radius = big ? cap_.big_radius : cap_.small_radius;
  struct {
    const ScaleMap& scales;
    double radius;
    optics::Pixel where{-1, -1};  // a cell's middle
    LocalScale scale{};           // there
  } last{scale_, radius};
  const auto shapeAt = [&last](optics::Pixel at) {
    const optics::Pixel where{middleOfCell(at.x), middleOfCell(at.y)};
    if (where.x != last.where.x || where.y != last.where.y) {
      last.where = where;
      last.scale = last.scales.at(where.x, where.y);
    }
    return discShape(last.scale, last.radius);
  };
  circle.fit = fitCircle(picture, start, shapeAt, imaging_);
  if (glare && circle.fit.glare) circle.fit.fault = FitFault::kNone;
  if (circle.fit.fault != FitFault::kNone) return circle;
  const LocalScale scale = circle.fit.edge ? scale_.at(circle.fit.x, circle.fit.y) : last.scale;
  const auto bent = static_cast<float>(radius * radius);
  const optics::Pixel centre{circle.fit.x - static_cast<double>(scale.bend[0] * bent),
                             circle.fit.y - static_cast<double>(scale.bend[1] * bent)};
  const std::optional<optics::Place> place = camera_.toPlane(centre, cap_.height);
  if (!place) {
    circle.fit.fault = FitFault::kOutside;
    return circle;
  }
  circle.place = *place;
  const auto& c = circle.fit.covariance;
  // Known so badly that the spacing would fit too easily: noise, not a circle.
  const double doubtful = kMostUncertain * static_cast<double>(discShape(scale, radius).radius());
  if (c[0] + c[2] > 2 * doubtful * doubtful) {
    circle.fit.fault = FitFault::kLowContrast;
    return circle;
  }
  const double a = static_cast<double>(scale.inverse[0]);
  const double b = static_cast<double>(scale.inverse[1]);
  const double d = static_cast<double>(scale.inverse[2]);
  const double e = static_cast<double>(scale.inverse[3]);
  circle.covariance = {a * a * c[0] + 2 * a * b * c[1] + b * b * c[2],
                       a * d * c[0] + (a * e + b * d) * c[1] + b * e * c[2],
                       d * d * c[0] + 2 * d * e * c[1] + e * e * c[2]};
  return circle;
}

bool Detector::fitBoth(const optics::GreyView& picture, const CirclePair& couple) {
  const Circle& big = fit(picture, couple.big, true);
  const Circle& small = fit(picture, couple.small, false);
  const bool big_good = big.fit.fault == FitFault::kNone;
  const bool small_good = small.fit.fault == FitFault::kNone;
  if (big_good == small_good) return big_good;
  // A light edge may have led the search astray; the good one says where the other must be.
  const Circle& good = big_good ? big : small;
  const Spot& other = spots_[static_cast<std::size_t>(big_good ? couple.small : couple.big)];
  const std::optional<optics::Place> seen =
      camera_.toPlane({static_cast<double>(other.x), static_cast<double>(other.y)}, cap_.height);
  if (!seen) return false;
  const double dx = seen->x - good.place.x;
  const double dy = seen->y - good.place.y;
  const double share = cap_.spacing() / std::max(std::hypot(dx, dy), 1e-9);
  const optics::Pixel start =
      camera_.project(good.place.x + share * dx, good.place.y + share * dy, cap_.height);
  if (!picture.contains(start.x, start.y)) return false;
  return fitFrom(picture, start, big_good ? couple.small : couple.big, !big_good).fit.fault ==
         FitFault::kNone;
}

MeasuredPoint Detector::measuredPointOf(const Circle& circle, const Circle& other) const {
  const auto lookOf = [](const CircleFit& fit) {
    return PaintEstimate{static_cast<double>(fit.white), static_cast<double>(fit.ratio),
                         static_cast<double>(fit.ratio_error), static_cast<double>(fit.blur)};
  };
  MeasuredPoint out{circle.place, circle.covariance};
  const double moved = shiftByGlare(lookOf(circle.fit), lookOf(other.fit));
  if (moved > 0) {
    const double metres = moved / static_cast<double>(scale_.at(circle.fit.x, circle.fit.y).mean);
    out.covariance[0] += metres * metres;
    out.covariance[2] += metres * metres;
  }
  return out;
}

Detection Detector::poseOf(const CirclePair& couple, float rim) const {
  const Circle& big = circleOf(couple.big, true);
  const Circle& small = circleOf(couple.small, false);
  const CapPose pose =
      poseFromCircles(measuredPointOf(big, small), measuredPointOf(small, big), cap_);
  Detection out;
  out.x = pose.x;
  out.y = pose.y;
  out.theta = pose.theta;
  out.covariance = pose.covariance;
  const double across = big.place.x - small.place.x;
  const double along = big.place.y - small.place.y;
  out.spacing = static_cast<float>(std::sqrt(across * across + along * along));
  out.white = (big.fit.white + small.fit.white) / 2;
  out.ratio = (big.fit.ratio + small.fit.ratio) / 2;
  const float blur = (big.fit.blur + small.fit.blur) / 2;
  out.blur = std::sqrt(std::max(0.0F, blur * blur - static_cast<float>(optics::kPixelBox)));
  out.big = {big.fit.x, big.fit.y};
  out.small = {small.fit.x, small.fit.y};
  out.middle = camera_.project(out.x, out.y, cap_.height);
  out.used = kUsedBig | kUsedSmall;
  if (big.fit.edge || small.fit.edge) out.used |= kUsedEdge;
  const float clean = 1 / std::max({1.0F, big.fit.residual, small.fit.residual});
  out.quality =
      0.5F + 0.5F * std::min(1.0F, rim / kUsualRim) * std::exp(-couple.cost / 2) * std::sqrt(clean);
  return out;
}

void Detector::explainTheRest(std::vector<Rejection>& rejected) const {
  for (std::size_t i = 0; i < spots_.size(); ++i) {
    const optics::Pixel where{static_cast<double>(spots_[i].x), static_cast<double>(spots_[i].y)};
    const Circle& big = circles_[2 * i];
    const Circle& small = circles_[2 * i + 1];
    if (!big.fitted && !small.fitted) {
      rejected.push_back({where, Reason::kNoPartner, 0, 0});
    }
    // As a big circle and as a small one; said once where both have the same fault.
    for (const Circle* circle : {&big, &small}) {
      const FitFault fault = circle->fit.fault;
      if (fault == FitFault::kNone || (circle == &small && fault == big.fit.fault)) continue;
      rejected.push_back({where, Reason::kCircleFit, static_cast<float>(fault), 0});
    }
  }
  for (const RejectedSpot& spot : rejected_spots_) {
    rejected.push_back({{static_cast<double>(spot.x), static_cast<double>(spot.y)},
                        Reason::kSize,
                        spot.seen,
                        spot.wanted});
  }
}

}  // namespace lab::detector
