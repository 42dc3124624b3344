#include "tracker_svc/detector/fitted_circles.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace lab::detector {
namespace {

constexpr double kMostUncertain = 0.06;  // [radii] standard deviation of a centre

// [px] The outline is constant within a cell. A fit usually starts and ends in the same cell, and
// the outline of a neighbouring cell would change the result far less than its error.
constexpr int kCell = 8;

double middleOfCell(double at) {
  return static_cast<double>(static_cast<int>(at) / kCell * kCell + kCell / 2);
}

}  // namespace

void FittedCircles::begin(const optics::GreyView& picture) {
  picture_ = picture;
  spots_.clear();
  circles_.clear();
  assigned_.clear();
}

void FittedCircles::admit() {
  circles_.resize(2 * spots_.size());
  assigned_.resize(spots_.size(), 0);
}

int FittedCircles::add(const Spot& spot) {
  spots_.push_back(spot);
  admit();
  return static_cast<int>(spots_.size()) - 1;
}

void FittedCircles::removeLast() {
  spots_.pop_back();
  admit();
}

const FittedCircles::Circle& FittedCircles::fit(int spot, bool big) {
  const Circle& circle = of(spot, big);
  if (circle.fitted) return circle;
  const Spot& from = spots_[static_cast<std::size_t>(spot)];
  return fitFrom({static_cast<double>(from.x), static_cast<double>(from.y)}, spot, big);
}

const FittedCircles::Circle& FittedCircles::fitFrom(optics::Pixel start, int spot, bool big,
                                                    bool glare) {
  Circle& circle = at(spot, big);
  circle = Circle{};
  circle.fitted = true;
  const double radius = big ? setup_.cap.big_radius : setup_.cap.small_radius;
  struct {
    const ScaleMap& scales;
    double radius;
    optics::Pixel where{-1, -1};  // middle of a cell
    LocalScale scale{};           // scale at `where`
  } last{setup_.scale, radius};
  const auto shapeAt = [&last](optics::Pixel at) {
    const optics::Pixel where{middleOfCell(at.x), middleOfCell(at.y)};
    if (where.x != last.where.x || where.y != last.where.y) {
      last.where = where;
      last.scale = last.scales.at(where.x, where.y);
    }
    return discShape(last.scale, last.radius);
  };
  circle.fit = fitCircle(picture_, start, shapeAt, setup_.imaging);
  if (glare && circle.fit.glare) circle.fit.fault = FitFault::kNone;
  if (circle.fit.fault != FitFault::kNone) return circle;
  const LocalScale scale =
      circle.fit.edge ? setup_.scale.at(circle.fit.x, circle.fit.y) : last.scale;
  const auto bent = static_cast<float>(radius * radius);
  const optics::Pixel centre{circle.fit.x - static_cast<double>(scale.bend[0] * bent),
                             circle.fit.y - static_cast<double>(scale.bend[1] * bent)};
  const std::optional<optics::Place> place = setup_.camera.toPlane(centre, setup_.cap.height);
  if (!place) {
    circle.fit.fault = FitFault::kOutside;
    return circle;
  }
  circle.place = *place;
  const auto& c = circle.fit.covariance;
  // So uncertain that any spacing would fit: noise, not a circle.
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

bool FittedCircles::fitBoth(const CirclePair& pair) {
  const Circle& big = fit(pair.big, true);
  const Circle& small = fit(pair.small, false);
  const bool big_good = big.fit.fault == FitFault::kNone;
  const bool small_good = small.fit.fault == FitFault::kNone;
  if (big_good == small_good) return big_good;
  // A light edge may have displaced the spot; the good circle predicts where the other one is.
  const Circle& good = big_good ? big : small;
  const Spot& other = spots_[static_cast<std::size_t>(big_good ? pair.small : pair.big)];
  const std::optional<optics::Place> seen = setup_.camera.toPlane(
      {static_cast<double>(other.x), static_cast<double>(other.y)}, setup_.cap.height);
  if (!seen) return false;
  const double dx = seen->x - good.place.x;
  const double dy = seen->y - good.place.y;
  const double share = setup_.cap.spacing() / std::max(std::hypot(dx, dy), 1e-9);
  const optics::Pixel start = setup_.camera.project(good.place.x + share * dx,
                                                    good.place.y + share * dy, setup_.cap.height);
  if (!picture_.contains(start.x, start.y)) return false;
  return fitFrom(start, big_good ? pair.small : pair.big, !big_good).fit.fault == FitFault::kNone;
}

}  // namespace lab::detector
