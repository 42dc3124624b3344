#include "tracker_svc/circle_fit/circle_fit_edge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "tracker_svc/circle_fit/circle_fit_edge_guess.hpp"
#include "tracker_svc/circle_fit/circle_fit_edge_model.hpp"
#include "tracker_svc/circle_fit/circle_fit_sectors.hpp"
#include "tracker_svc/circle_fit/circle_fit_solve.hpp"

namespace lab::detector::fit {
namespace {

// Above this ratio it is no circle. Slightly above the limit in circle_fit.cpp.
constexpr float kHopelessRatio = 0.35F;
constexpr float kHopelessScale = 0.2F;
constexpr float kHopelessWeight = 0.35F;
constexpr int kMostMoves = 6;
constexpr int kPasses = 8;
// passes before the robust cutoff applies: the guess may have one level wrong
constexpr int kTrusting = 2;
constexpr double kSettled = 0.003;  // [px]
// [1/px] of the white level: between edges the light is nearly even
constexpr float kSlopeLines = 0.005F;
constexpr float kSlopeBent = 0.1F;
constexpr double kDoubt = 0.03;  // [px] as in the plain fit
// [px] as in the plain fit; light edges are not quite straight
constexpr double kFloor = 0.003;
constexpr float kClean = 0.25F;  // correlation of residuals below which one line is enough
constexpr float kFits = 0.82F;   // and share of the pixels that fit the model
// [lens blurs] a softer edge may be a light gradient
constexpr float kSoftEdge = 1.2F;
// [expected deviations] of residuals that indicate another edge
constexpr float kMissesEdge = 2.5F;
constexpr float kBetter = 0.9F;  // [1] of the cost, to justify three more unknowns

template <std::size_t kLines>
void know(Sums<litUnknowns(kLines)>& sums, std::size_t i, float off, float spread) {
  const double weight = 1.0 / (static_cast<double>(spread) * static_cast<double>(spread));
  sums.normal[i * (i + 1) / 2 + i] += weight;
  sums.right[i] += weight * static_cast<double>(off);
}

void turn(Line& line, float by) {
  const float nx = line.nx - by * line.ny;
  const float ny = line.ny + by * line.nx;
  const float length = std::sqrt(nx * nx + ny * ny);
  line.nx = nx / length;
  line.ny = ny / length;
}

/// Without an edge: the level in the middle. With edges: the brightest side.
template <std::size_t kLines>
std::size_t brightest(const LitDisc& lit) {
  if constexpr (kLines == 0) return 0;
  constexpr std::size_t levels = levelsOf(kLines);
  return static_cast<std::size_t>(
      std::max_element(lit.level.begin(), lit.level.begin() + static_cast<std::ptrdiff_t>(levels)) -
      lit.level.begin());
}

struct LitFit {
  Outcome outcome;
  LitDisc lit;
  float cutoff = kNoCutoff;  ///< [expected deviations] of its last pass
};

template <std::size_t kLines>
LitFit fitLines(const Task& task, Window& window, const LitDisc& from) {
  constexpr std::size_t kCount = litUnknowns(kLines);
  constexpr std::size_t kLevels = levelsOf(kLines);
  LitFit out;
  out.lit = from;
  LitDisc& lit = out.lit;
  const Constants& constants = task.constants;
  const float sigma = task.sigma;
  const float most_step = 0.25F * constants.radius;
  float cutoff = kNoCutoff;
  for (int pass = 0; pass < kPasses; ++pass) {
    Sums<kCount> sums;
    out.cutoff = cutoff;
    sumLitDisc<kLines>(window, constants, lit, cutoff, sums);
    const float white = std::max(1.0F, lit.level[brightest<kLines>(lit)]);
    const float slope = (kLines == 0 ? kSlopeBent : kSlopeLines) * white;
    know<kLines>(sums, kLitSlopeX, -lit.disc.slope_x, slope);
    know<kLines>(sums, kLitSlopeY, -lit.disc.slope_y, slope);
    know<kLines>(sums, kLitScale, 1 - lit.disc.scale, 0.03F);
    know<kLines>(sums, kLitRatio, kUsualRatio - lit.disc.ratio, 0.05F);
    know<kLines>(sums, kLitSigma, sigma - lit.disc.sigma, 0.25F * sigma);
    for (std::size_t i = 0; i < kLevels; ++i) {
      const bool bends = kLines == 0 && i > 0;
      know<kLines>(sums, kLitLevel + i, (bends ? 0.0F : 0.5F * white) - lit.level[i],
                   (bends ? 0.5F : 2.0F) * white);
    }
    for (std::size_t i = 0; i < kLines; ++i) {
      know<kLines>(sums, kLitLevel + kLevels + 2 * i, 0, 0.5F);
      know<kLines>(sums, kLitLevel + kLevels + 2 * i + 1, 0, 2.0F);
    }
    if constexpr (kLines > 0) {
      know<kLines>(sums, kLitLevel + kLevels + 2 * kLines, 1.2F * sigma - lit.edge_sigma,
                   0.3F * sigma);
    }
    if constexpr (kLines == 1) know<kLines>(sums, kCount - 1, -lit.bend, 0.02F);
    const Factor<kCount> factor(sums.normal);
    if (!factor.good()) return out;
    const auto by = factor.solve(sums.right);
    double left = sums.squares;
    for (std::size_t i = 0; i < kCount; ++i) left -= by[i] * sums.right[i];
    const bool robust = pass > kTrusting;
    const float noise = noiseOver(
        left, (robust ? sums.counts.weight : sums.counts.pixels) - static_cast<double>(kCount),
        robust);
    if (pass >= kTrusting) cutoff = kCutoff * std::max(1.0F, noise);

    const auto step = [&](std::size_t i, float most) {
      return std::clamp(static_cast<float>(by[i]), -most, most);
    };
    lit.disc.x += step(kLitX, most_step);
    lit.disc.y += step(kLitY, most_step);
    lit.disc.slope_x += step(kLitSlopeX, white);
    lit.disc.slope_y += step(kLitSlopeY, white);
    lit.disc.scale = std::clamp(lit.disc.scale + step(kLitScale, 0.1F), 0.7F, 1.4F);
    lit.disc.ratio = std::clamp(lit.disc.ratio + step(kLitRatio, 0.1F), -0.2F, 0.9F);
    lit.disc.sigma =
        std::clamp(lit.disc.sigma + step(kLitSigma, 0.3F * sigma), 0.5F * sigma, 2 * sigma);
    for (std::size_t i = 0; i < kLevels; ++i) lit.level[i] += step(kLitLevel + i, white);
    for (std::size_t i = 0; i < kLines; ++i) {
      turn(lit.line[i], step(kLitLevel + kLevels + 2 * i, 0.3F));
      lit.line[i].offset += step(kLitLevel + kLevels + 2 * i + 1, most_step);
    }
    if constexpr (kLines > 0) {
      lit.edge_sigma =
          std::clamp(lit.edge_sigma + step(kLitLevel + kLevels + 2 * kLines, 0.3F * sigma),
                     0.8F * sigma, 3 * sigma);
    }
    if constexpr (kLines == 1) {
      lit.bend = std::clamp(lit.bend + step(kCount - 1, 0.03F), -0.1F, 0.1F);
    }
    // Newton steps shrink quadratically: the size of the last step predicts the next one.
    const double moved = by[kLitX] * by[kLitX] + by[kLitY] * by[kLitY];
    const bool settled = pass > kTrusting && moved < kSettled * kSettled;
    if (pass == kPasses - 1 || settled) {
      Outcome& o = out.outcome;
      const auto cx = factor.inverseColumn(kLitX);
      const auto cy = factor.inverseColumn(kLitY);
      const double size = static_cast<double>(noise * noise);
      o.floor = kFloor * kFloor;
      o.covariance = {size * cx[kLitX] + o.floor, size * cx[kLitY], size * cy[kLitY] + o.floor};
      o.ratio_error = static_cast<float>(std::sqrt(factor.inverseColumn(kLitRatio)[kLitRatio]));
      o.x = window.base_x + static_cast<double>(lit.disc.x);
      o.y = window.base_y + static_cast<double>(lit.disc.y);
      o.white = lit.level[brightest<kLines>(lit)];
      o.ratio = lit.disc.ratio;
      o.scale = lit.disc.scale;
      o.sigma = lit.disc.sigma;
      o.noise = noise;
      o.cost = static_cast<float>(sums.counts.cost);
      o.pixels = static_cast<int>(sums.counts.pixels);
      o.weight = static_cast<float>(sums.counts.weight / std::max(1.0, sums.counts.pixels));
      o.correlation = static_cast<float>(correlation(window));
      o.good = std::isfinite(o.x) && std::isfinite(o.y);
      break;
    }
  }
  return out;
}

LitDisc expectedAt(const Disc& disc, float sigma) {
  LitDisc lit;
  lit.disc = disc;
  lit.disc.slope_x = 0;
  lit.disc.slope_y = 0;
  lit.disc.scale = 1;
  lit.disc.ratio = kUsualRatio;
  lit.disc.sigma = sigma;
  return lit;
}

LitDisc bentFrom(const Disc& disc, const EdgeGuess& split, float sigma) {
  LitDisc lit = expectedAt(disc, sigma);
  lit.level[0] = 0.5F * (split.level[0] + split.level[1]);
  return lit;
}

LitDisc litFrom(const Disc& disc, const EdgeGuess& split, float sigma) {
  LitDisc lit = expectedAt(disc, sigma);
  std::copy(split.level.begin(), split.level.end(), lit.level.begin());
  lit.line = split.line;
  lit.edge_sigma = 1.2F * sigma;
  return lit;
}

/// Writes the light on white and the weighted residuals of a fit to the window.
template <std::size_t kLines>
void light(const Task& task, Window& window, const LitFit& fit) {
  Sums<litUnknowns(kLines)> sums;
  sumLitDisc<kLines>(window, task.constants, fit.lit, fit.cutoff, sums);
}

bool isClean(const Outcome& outcome) {
  return outcome.good && outcome.correlation < kClean && outcome.weight > kFits;
}

Outcome fitLit(const Task& task, Window& window, const Disc& rough) {
  const Surroundings around(window, task.constants, rough, Pick::kAll);
  LitFit best;
  std::size_t count = 1;  // lines of the best model
  bool is_last = true;    // whether the window holds the residuals of the best model
  if (const EdgeGuess split = around.oneLine(); split.good) {
    best = fitLines<1>(task, window, litFrom(rough, split, task.sigma));
    const Outcome& one = best.outcome;
    const bool soft = best.lit.edge_sigma > kSoftEdge * task.sigma;
    if (one.good && soft && one.noise < kMissesEdge) {
      const LitFit bent = fitLines<0>(task, window, bentFrom(rough, split, task.sigma));
      if (isClean(bent.outcome) && bent.outcome.cost < one.cost) return bent.outcome;
      is_last = false;
    }
    if (isClean(one)) {
      if (!is_last) light<1>(task, window, best);
      return one;
    }
  }
  const Disc better = best.outcome.good ? best.lit.disc : rough;
  const TwoEdgeGuesses lines = around.twoLines();
  // The better guess first: if it explains everything, the other one is not tried.
  std::array<EdgeGuess, 2> likely{lines.parallel, lines.crossing};
  if (likely[1].gain > likely[0].gain) std::swap(likely[0], likely[1]);
  for (const EdgeGuess& split : likely) {
    if (!split.good) continue;
    const LitFit two = fitLines<2>(task, window, litFrom(better, split, task.sigma));
    is_last =
        two.outcome.good && (!best.outcome.good || two.outcome.cost < kBetter * best.outcome.cost);
    if (!is_last) continue;
    best = two;
    count = 2;
    if (isClean(two.outcome)) break;
  }
  if (best.outcome.good && !is_last) {
    if (count == 1) {
      light<1>(task, window, best);
    } else {
      light<2>(task, window, best);
    }
  }
  return best.outcome;
}

}  // namespace

bool edgeMayCross(const Task& task, const Outcome& plain, bool sound, const Window& window) {
  Disc disc;  // the expected disc: the plain fit is unreliable with an edge across it
  disc.sigma = task.sigma;
  const Constants& c = task.constants;
  const float grain = plain.white * plain.white * c.texture;
  return Surroundings(window, c, disc, sound ? Pick::kWellFitted : Pick::kAll)
      .uneven(c.noiseAt(std::max(0.0F, plain.white)) + grain);
}

std::optional<GridPoint> settleLit(const Task& task, GridPoint start, Window& window,
                                   Outcome& outcome) {
  GridPoint last;
  const auto estimate = [&](GridPoint point) -> std::optional<optics::Pixel> {
    last = point;
    outcome = {};
    if (!task.gather(point, window)) return std::nullopt;
    Disc rough;
    rough.sigma = task.sigma;
    if (point == start && !darkInside(window, task.constants, task.sigma)) return std::nullopt;
    outcome = fitLit(task, window, rough);
    if (!outcome.good || outcome.ratio > kHopelessRatio ||
        std::abs(outcome.scale - 1) > kHopelessScale || outcome.weight < kHopelessWeight) {
      outcome.good = false;
      return std::nullopt;
    }
    return optics::Pixel{outcome.x, outcome.y};
  };
  const std::optional<GridPoint> chosen = settle(start, kDoubt, kMostMoves, estimate);
  if (chosen && !(last == *chosen)) static_cast<void>(estimate(*chosen));
  return chosen;
}

}  // namespace lab::detector::fit
