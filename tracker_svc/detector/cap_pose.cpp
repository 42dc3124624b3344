#include "tracker_svc/detector/cap_pose.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/math/angle.hpp"

namespace lab::detector {
namespace {

constexpr double kUsualRatio = 0.08;  // [1] dark / white, of black paint on white
constexpr double kPaintDoubt = 0.02;  // [1] uncertainty of that ratio
constexpr double kSure = 3;           // [standard errors]
// [blurs] contrast over the slope of the outline
const double kSlope = std::sqrt(2 * std::numbers::pi);

// [DN] brightness of the circle in excess of that of paint.
double onTop(const PaintEstimate& look) { return (look.ratio - kUsualRatio) * look.white; }

}  // namespace

double shiftByGlare(const PaintEstimate& circle, const PaintEstimate& other) {
  const double contrast = (1 - circle.ratio) * circle.white;
  const double more =
      onTop(circle) - onTop(other) - kPaintDoubt * std::max(circle.white, other.white);
  if (!(more > 0 && contrast > 0)) return 0;
  const double doubt = kSure * std::hypot(circle.error * circle.white, other.error * other.white);
  return kSlope * circle.blur * std::max(0.0, more - doubt) / contrast;
}

CapPose poseFromCircles(const MeasuredPoint& big, const MeasuredPoint& small,
                        const optics::CapGeometry& cap) {
  CapPose out;
  const double dx = big.place.x - small.place.x;
  const double dy = big.place.y - small.place.y;
  const double square = dx * dx + dy * dy;
  // The axis divides the line between the centres in the ratio of the offsets.
  const double of_big = -cap.small_offset / cap.spacing();
  const double of_small = 1 - of_big;
  out.x = of_big * big.place.x + of_small * small.place.x;
  out.y = of_big * big.place.y + of_small * small.place.y;
  out.theta = std::atan2(dy, dx);
  // d theta = (-dy, dx) / square (d big - d small).
  const double tx = -dy / square;
  const double ty = dx / square;
  const auto& b = big.covariance;
  const auto& s = small.covariance;
  const double sum[3] = {b[0] + s[0], b[1] + s[1], b[2] + s[2]};
  const double mix[3] = {of_big * b[0] - of_small * s[0], of_big * b[1] - of_small * s[1],
                         of_big * b[2] - of_small * s[2]};
  const double bb = of_big * of_big;
  const double ss = of_small * of_small;
  out.covariance = {
      bb * b[0] + ss * s[0],     bb * b[1] + ss * s[1],
      mix[0] * tx + mix[1] * ty, bb * b[2] + ss * s[2],
      mix[1] * tx + mix[2] * ty, sum[0] * tx * tx + 2 * sum[1] * tx * ty + sum[2] * ty * ty};
  const double off = std::sqrt(square) - cap.spacing();
  const double variance = (sum[0] * dx * dx + 2 * sum[1] * dx * dy + sum[2] * dy * dy) / square;
  out.spacing_chi2 = off * off / variance;
  return out;
}

CapPose poseFromRim(const MeasuredPoint& circle, double offset, const MeasuredPoint& middle) {
  // The component of the vector between the two points across the axis determines theta. The
  // component along the axis is redundant: it shifts both points by their relative weights.
  const double sx = circle.place.x - middle.place.x;
  const double sy = circle.place.y - middle.place.y;
  const double length = std::max(std::hypot(sx, sy), 1e-9);
  const double ux = sx / length;
  const double uy = sy / length;
  const auto& c = circle.covariance;
  const auto& m = middle.covariance;
  const double along =
      (c[0] + m[0]) * ux * ux + 2 * (c[1] + m[1]) * ux * uy + (c[2] + m[2]) * uy * uy;
  // Covariance of the middle, and of the transverse component, with the longitudinal one.
  const double mx = -(m[0] * ux + m[1] * uy);
  const double my = -(m[1] * ux + m[2] * uy);
  const double of_cross = -uy * ((c[0] + m[0]) * ux + (c[1] + m[1]) * uy) +
                          ux * ((c[1] + m[1]) * ux + (c[2] + m[2]) * uy);
  const double cross =
      (c[0] + m[0]) * uy * uy - 2 * (c[1] + m[1]) * ux * uy + (c[2] + m[2]) * ux * ux;
  const double off = length - std::abs(offset);
  const double share = off / along;
  CapPose out;
  out.spacing_chi2 = off * share;
  out.x = middle.place.x - mx * share;
  out.y = middle.place.y - my * share;
  const double turn = -of_cross * share / std::abs(offset);
  const double sign = offset < 0 ? -1 : 1;
  out.theta = wrapAngle(std::atan2(sign * sy, sign * sx) + turn);
  // Conditional on the longitudinal component.
  const double per = 1 / std::abs(offset);
  const double mcx = -(m[0] * -uy + m[1] * ux);
  const double mcy = -(m[1] * -uy + m[2] * ux);
  out.covariance = {m[0] - mx * mx / along,
                    m[1] - mx * my / along,
                    (mcx - mx * of_cross / along) * per,
                    m[2] - my * my / along,
                    (mcy - my * of_cross / along) * per,
                    (cross - of_cross * of_cross / along) * per * per};
  return out;
}

}  // namespace lab::detector
