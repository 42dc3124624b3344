#include "tracker_svc/circle_fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tracker_svc/circle_fit/circle_fit_correlation.hpp"
#include "tracker_svc/circle_fit/circle_fit_edge.hpp"
#include "tracker_svc/circle_fit/circle_fit_plain.hpp"
#include "tracker_svc/circle_fit/circle_fit_sectors.hpp"

namespace lab::detector {
namespace {

using fit::GridPoint;
using fit::Outcome;
using fit::Task;
using fit::Window;

constexpr double kMostWay = 0.5;  // [radius] distance of the centre from the start
// [radius] the same with light edges, which displace the spot that the search finds
constexpr double kMostWayLit = 1;
constexpr double kMostError = 0.08;  // [radius] standard error of the centre in x or y
// [1] dark / white: 0.08 for black paint on white, more with glare over both
constexpr float kMostRatio = 0.3F;
constexpr float kMostScale = 0.15F;  // [1]
// [1] structured residuals over the white level
constexpr float kMostMisfit = 0.025F;
// [1] dark / white with glare: still darker than the surroundings
constexpr float kMostGlareRatio = 0.85F;
constexpr float kMostGlareMisfit = 0.08F;  // [1] structured residuals with glare
// [1] variance of the residuals over that of the sensor's noise: up to this ratio a codec may have
// caused them
constexpr float kMostOfCodecs = 2.5F;
constexpr double kSlope = 2.5;        // [sigma] width of a blurred outline
constexpr float kLeastWeight = 0.6F;  // [1] share of the pixels that fit the model
// [radius] standard error of the centre above which the fit is checked closely
constexpr double kDoubtful = 0.02;
constexpr float kDim = 25;  // [noise] white level below which the light counts as dim
// [1] of the white level: allowed deviation of the centre pixel from the fitted black
constexpr float kMiddleOff = 0.05F;
// autocorrelation of the residuals above which something is missing in the model
constexpr float kOddCorrelation = 0.25F;
constexpr double kUneven = 0.06;      // [1] and the residuals differ between the two sides
constexpr float kEvenMisfit = 0.01F;  // [1] or they exceed this share of the white level
constexpr float kOddWeight = 0.87F;
constexpr float kOddScale = 0.04F;
// [1] relative error of a blur's square because its shape is not Gaussian
constexpr float kOddBlur = 0.3F;
// [px] blur above which a circle of another size is not one that a light edge cuts
constexpr float kDefocused = 2;
constexpr float kOtherWeight = 0.8F;  // [1] share of the pixels that fit that circle
// [1] of the cost that a model with a light edge may leave
constexpr float kEdgePays = 0.7F;
constexpr float kBlurOff = 1.3F;     // [1] fitted over expected blur at which the fit is repeated
constexpr float kEdgeDoubt = 0.05F;  // [1] of the ratio
constexpr float kBlurStep = 0.25F;   // [px]

/// Mean squares of residuals that noise cannot explain, over the square of the white level.
struct Structure {
  float codec = 0;   // possibly caused by a codec
  float misfit = 0;  // the rest
};

// The noise of a sensor is independent between neighbouring pixels. Correlated residuals mean
// another shape, unless a codec caused them.
Structure structureOf(const Outcome& o, const fit::Constants& constants) {
  const float expected = constants.noiseAt(0.5F * o.white);
  const float unit = expected / (std::max(o.white, 1.0F) * std::max(o.white, 1.0F));
  const float square = o.noise * o.noise;
  const float shared = square * std::max(0.0F, o.correlation - fit::correlationByChance(o.pixels));
  if (!constants.compressed) return {.misfit = shared * unit};
  const float misfit = std::clamp(square - kMostOfCodecs, 0.0F, shared);
  return {(shared - misfit) * unit, misfit * unit};
}

float misfitOf(const Outcome& o, const fit::Constants& constants) {
  return std::sqrt(structureOf(o, constants).misfit);
}

FitFault faultOf(const Outcome& o, bool edge, const fit::Constants& constants) {
  if (!o.good) return FitFault::kDiverged;
  const double radius = static_cast<double>(constants.radius);
  const float noise = std::max(1.0F, o.noise);
  if (o.covariance[0] + o.covariance[2] > 2 * kMostError * kMostError * radius * radius) {
    return FitFault::kLowContrast;
  }
  // The black level may be off by one grey step, which matters in dim light. With an edge in the
  // model the ratio is accurate in any light, but the model may be wrong.
  const float doubt = std::min(edge ? kEdgeDoubt : 1.0F, 3 * noise * o.ratio_error) + 1 / o.white;
  if (o.ratio - doubt > kMostRatio) return FitFault::kNotDark;
  if (std::abs(o.scale - 1) > kMostScale || o.weight < kLeastWeight) {
    return FitFault::kNotRound;
  }
  const float misfit = misfitOf(o, constants);
  // Another size together with structured residuals means another shape. If the blur is as wide as
  // the circle, a non-Gaussian blur looks like another size: by the ratio of its square to the
  // square of the radius.
  const float blur = o.sigma / constants.radius;
  const float odd = std::max(kOddScale, kOddBlur * blur * blur);
  const bool left_over =
      o.correlation > kOddCorrelation && (misfit > kEvenMisfit || !constants.compressed);
  if (std::abs(o.scale - 1) > odd && left_over) return FitFault::kNotRound;
  return misfit > kMostMisfit ? FitFault::kNotRound : FitFault::kNone;
}

// Glare (reflected light on top of the paint) reduces the contrast and adds a gradient.
bool mayBeGlare(const Outcome& o, FitFault fault, const fit::Constants& constants) {
  return (fault == FitFault::kNotDark || fault == FitFault::kNotRound) &&
         o.ratio < kMostGlareRatio && std::abs(o.scale - 1) < kOddScale &&
         o.weight >= kLeastWeight && misfitOf(o, constants) < kMostGlareMisfit;
}

// Out of focus: uses a wider band, with a blur that does not depend on how the first one was found.
std::optional<Task> widerFor(const Task& task, const Outcome& outcome) {
  if (!outcome.good || outcome.sigma < kBlurOff * task.sigma) return std::nullopt;
  Task wide = task;
  wide.setSigma(kBlurStep * std::round(outcome.sigma / kBlurStep));
  return wide;
}

// Out of focus it is another circle. With sharp outlines it may be a circle of which a light edge
// hides a part.
bool hasAnotherSize(const Outcome& o, const fit::Constants& constants) {
  return o.good && std::abs(o.scale - 1) > kMostScale && o.sigma > kDefocused &&
         o.weight > kOtherWeight && misfitOf(o, constants) < kMostMisfit;
}

// The disc fits well, whatever else the window contains.
bool isSound(const Outcome& o) {
  return o.good && o.weight >= kOddWeight && std::abs(o.scale - 1) <= kOddScale;
}

bool isOdd(const Outcome& o, const Task& task, const Window& window) {
  if (hasAnotherSize(o, task.constants)) return false;
  if (!isSound(o)) return true;
  if (o.correlation <= kOddCorrelation) return false;
  const float misfit = misfitOf(o, task.constants);
  if (task.constants.compressed && misfit <= 0) return false;
  return misfit > kEvenMisfit || fit::antisymmetricCorrelation(window) > kUneven;
}

bool isDoubtful(const Outcome& o, const fit::Constants& constants) {
  const double radius = static_cast<double>(constants.radius);
  return o.covariance[0] + o.covariance[2] > 2 * kDoubtful * kDoubtful * radius * radius;
}

// The disc has no fault, only noise is left, and its centre, which the fit did not use, is black.
bool isClear(const Outcome& o, const Task& task, const Window& window, GridPoint point) {
  if (!window.plain || !isSound(o) || o.correlation > fit::correlationByChance(o.pixels) ||
      isDoubtful(o, task.constants) || faultOf(o, false, task.constants) != FitFault::kNone) {
    return false;
  }
  const std::optional<float> middle = task.pixels->middle(*task.picture, point);
  if (!middle) return false;
  const float black = *middle - task.constants.black;
  return black < kMostRatio * o.white && std::abs(black - o.ratio * o.white) < kMiddleOff * o.white;
}

bool isDim(float white, const fit::Constants& constants) {
  return white * white < kDim * kDim * constants.noiseAt(white);
}

Outcome plainFrom(Task& task, const ShapeAt& shape_at, GridPoint start, Window& window,
                  std::optional<GridPoint>& point) {
  fit::Disc disc;
  point = fit::settlePlain(task, start, window, disc);
  if (!point) return {};
  // If some pixels are saturated, all others are needed; so are all pixels in dim light.
  if ((!window.plain || isDim(disc.white, task.constants)) && task.setSparse(false)) {
    point = fit::settlePlain(task, *point, window, disc);
    if (!point) return {};
  }
  // Uses the outline at the centre, which no longer depends on the start.
  if (task.setShape(shape_at(point->pixel()))) {
    point = fit::settlePlain(task, *point, window, disc);
    if (!point) return {};
    task.setShape(shape_at(point->pixel()));
  }
  const Outcome out = fit::fitPlain(task, window, disc);
  const std::optional<Task> wide = widerFor(task, out);
  if (!wide) return out;
  const std::optional<GridPoint> again =
      fit::settlePlain(*wide, fit::nearest({out.x, out.y}), window, disc);
  if (!again) return out;
  const Outcome better = fit::fitPlain(*wide, window, disc);
  if (!better.good) return out;
  point = again;
  return better;
}

Outcome litFrom(const Task& task, GridPoint start, Window& window) {
  Outcome out;
  fit::settleLit(task, start, window, out);
  const std::optional<Task> wide = widerFor(task, out);
  if (!wide) return out;
  Outcome better;
  fit::settleLit(*wide, fit::nearest({out.x, out.y}), window, better);
  if (better.good &&
      better.cost * static_cast<float>(out.pixels) < out.cost * static_cast<float>(better.pixels)) {
    return better;
  }
  fit::settleLit(task, start, window, out);  // repeats it to fill the window and its light
  return out;
}

}  // namespace

CircleFit fitCircle(const optics::GreyView& picture, optics::Pixel start, const DiscShape& shape,
                    const optics::Imaging& imaging) {
  return fitCircle(
      picture, start, [&](optics::Pixel) { return shape; }, imaging);
}

CircleFit fitCircle(const optics::GreyView& picture, optics::Pixel start, const ShapeAt& shape_at,
                    const optics::Imaging& imaging) {
  CircleFit out;
  out.x = start.x;
  out.y = start.y;
  // A sparse subset of the pixels is usually enough.
  Task task(picture, shape_at(start), imaging, !imaging.compressed);
  const double radius = static_cast<double>(task.constants.radius);
  if (!picture.contains(start.x, start.y, 0.5 * radius)) {
    out.fault = FitFault::kOutside;
    return out;
  }
  Window window;
  std::optional<GridPoint> point;
  Outcome best = plainFrom(task, shape_at, fit::nearest(start), window, point);
  const bool clear = best.good && isClear(best, task, window, *point);
  if (!clear && task.setSparse(false)) {
    best = plainFrom(task, shape_at, fit::nearest(start), window, point);
  }
  const bool odd = isOdd(best, task, window);
  if (odd && !(best.good && !fit::edgeMayCross(task, best, isSound(best), window))) {
    const GridPoint first = fit::nearest(start);
    Task wider = task;
    wider.setSparse(false);
    wider.setMargin(fit::kMarginLit);
    Outcome lit = litFrom(wider, point.value_or(first), window);
    if (!lit.good && point && !(*point == first)) lit = litFrom(wider, first, window);
    if (lit.good && (!best.good || lit.cost * static_cast<float>(best.pixels) <
                                       kEdgePays * best.cost * static_cast<float>(lit.pixels))) {
      best = lit;
      out.edge = true;
    } else {
      // repeated for its residuals in the window
      best = plainFrom(task, shape_at, fit::nearest(start), window, point);
    }
  }
  out.fault = faultOf(best, out.edge, task.constants);
  if (!best.good) return out;
  if (out.fault == FitFault::kNone && (odd || isDoubtful(best, task.constants))) {
    fit::Disc disc;
    disc.x = static_cast<float>(best.x - window.base_x);
    disc.y = static_cast<float>(best.y - window.base_y);
    disc.scale = best.scale;
    disc.sigma = best.sigma;
    if (!out.edge) {
      disc.slope_x = best.slope_x;
      disc.slope_y = best.slope_y;
      disc.white = best.white - best.slope_x * disc.x - best.slope_y * disc.y;
      fit::layLight(window, disc);
    }
    if (!fit::darkAllAround(window, task.constants, disc, std::max(1.0F, best.noise))) {
      out.fault = FitFault::kNotRound;
    }
  }
  out.glare = !out.edge && mayBeGlare(best, out.fault, task.constants);
  const double way_x = best.x - start.x;
  const double way_y = best.y - start.y;
  const double most = (out.edge ? kMostWayLit : kMostWay) * radius;
  if (way_x * way_x + way_y * way_y > most * most) {
    out.fault = FitFault::kDiverged;
    out.glare = false;
  }
  out.x = best.x;
  out.y = best.y;
  out.covariance = best.covariance;
  if (best.correlation > fit::correlationByChance(best.pixels)) {
    const double size = fit::varianceInflation(window, best.pixels);
    out.covariance[0] = best.floor + size * (best.covariance[0] - best.floor);
    out.covariance[1] *= size;
    out.covariance[2] = best.floor + size * (best.covariance[2] - best.floor);
  }
  // A residual on one side of the outline displaces the outline by residual / slope. For glare the
  // whole residual counts, for codec artefacts half of the squares.
  const Structure structure = structureOf(best, task.constants);
  const double on_one_side =
      static_cast<double>(0.5F * structure.codec + (out.glare ? structure.misfit : 0.0F));
  if (on_one_side > 0) {
    const double moved =
        kSlope * static_cast<double>(best.sigma) / (1 - static_cast<double>(best.ratio));
    out.covariance[0] += on_one_side * moved * moved;
    out.covariance[2] += on_one_side * moved * moved;
  }
  out.white = best.white;
  out.ratio = best.ratio;
  out.ratio_error = std::max(1.0F, best.noise) * best.ratio_error;
  out.blur = best.sigma;
  out.scale = best.scale;
  out.residual = best.noise;
  return out;
}

}  // namespace lab::detector
