#include "tracker_svc/circle_fit/circle_fit_plain.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tracker_svc/circle_fit/circle_fit_saturated.hpp"
#include "tracker_svc/circle_fit/circle_fit_solve.hpp"

namespace lab::detector::fit {
namespace {

// [px] bound on the difference between coarse estimates from neighbouring grid points
constexpr double kDoubt = 0.06;
constexpr float kMostMargin = 0.8F;          // [radius]
constexpr float kTexture = 0.006F * 0.006F;  // grain of paint and sensor, variance over signal^2

constexpr double kFreedoms = kUnknowns;
constexpr int kMostPasses = 6;
constexpr int kMostMoves = 8;          // grid moves
constexpr double kSettled = 0.06;      // [px] the last step of the whole disc must be shorter
constexpr double kSettledBlur = 0.15;  // [1] and change the blur by less
constexpr double kSettledScale = 0.03;
constexpr double kSettledFull = 0.1;    // [1] factor on both if some pixels are saturated
constexpr double kSettledWhite = 0.01;  // [1] and change the white level by less
constexpr float kRoughCutoff = 0.3F;    // [1] of the white level, as kCutoff for the coarse disc
constexpr float kLeastNoise = 0.5F;

// Error that residuals do not show: paint that is not quite round. A larger value would be too
// pessimistic for large circles, since the error does not shrink with their size.
constexpr double kFloor = 0.0008;  // [px]
// Reduction of the scatter by the biweight (1.39 at a cutoff of 5 deviations) and by the unknowns.
constexpr double kScatterLoss = 1.5;

// Weak priors, which keep fits to other objects or overexposed circles finite.
constexpr double kScaleSpread = 0.1;
constexpr double kRatioSpread = 0.15;
constexpr double kSlopeSpread = 0.02;  // [1/px] of the white level
// [1] factor on the slope's prior weight if every pixel is saturated: no slope is visible then, and
// vignetting over a whole picture is a few ten-thousandths per pixel.
constexpr double kFullSlope = 150;
constexpr double kSigmaSpread = 0.5;  // [of sigma]
// [1] as kFullSlope: only the few unsaturated pixels separate white, dark and size
constexpr double kFullShape = 4;

// Mean biweight of a normal residual, for a cutoff in deviations.
double beliefAt(float cutoff) {
  const double over = 1.0 / static_cast<double>(cutoff * cutoff);
  return 1 - 2 * over + 3 * over * over;
}

struct Rough {
  bool good = false;
  Disc disc;
};

Rough roughAt(const Task& task, GridPoint point) {
  Rough out;
  const PixelLayout::Rough u = task.pixels->rough(*task.picture, point);
  const double contrast = u.white - u.dark;
  if (!(contrast > 0.5)) return out;
  // A longer step is outside the linear range.
  const double most = 0.3 * static_cast<double>(task.constants.radius);
  const double length = std::sqrt(u.x * u.x + u.y * u.y) / contrast;
  const double shortened = (length > most ? most / length : 1.0) / contrast;
  const double white = u.white - static_cast<double>(task.constants.black);
  out.disc.x = static_cast<float>(u.x * shortened);
  out.disc.y = static_cast<float>(u.y * shortened);
  out.disc.white = static_cast<float>(white);
  out.disc.ratio = static_cast<float>(std::clamp(1 - contrast / white, 0.0, 0.5));
  out.disc.sigma = task.sigma;
  out.good = white > 0;
  return out;
}

// A prior: unknown i deviates by `off` from its mean.
struct Known {
  std::size_t i;
  double off;
  double weight;  // 1 / variance
};

constexpr double weightOf(double spread) { return 1 / (spread * spread); }

// @param full saturated pixels per unsaturated pixel: they are consistent with even light
std::array<Known, 5> knownOf(const Disc& disc, float sigma, double full) {
  const double slope = weightOf(kSlopeSpread * std::max(1.0, static_cast<double>(disc.white)) /
                                (1 + kFullSlope * full));
  const double shape = (1 + kFullShape * full) * (1 + kFullShape * full);
  const auto off = [](float v) { return static_cast<double>(v); };
  return {{{kSlopeX, off(-disc.slope_x), slope},
           {kSlopeY, off(-disc.slope_y), slope},
           {kScale, off(1.0F - disc.scale), shape * weightOf(kScaleSpread)},
           {kRatio, off(kUsualRatio - disc.ratio), shape * weightOf(kRatioSpread)},
           {kSigma, off(sigma - disc.sigma), weightOf(kSigmaSpread * static_cast<double>(sigma))}}};
}

void step(Disc& disc, const Row& by, float sigma) {
  disc.x += static_cast<float>(by[kX]);
  disc.y += static_cast<float>(by[kY]);
  disc.white += static_cast<float>(by[kWhite]);
  disc.slope_x += static_cast<float>(by[kSlopeX]);
  disc.slope_y += static_cast<float>(by[kSlopeY]);
  disc.scale = std::clamp(disc.scale + static_cast<float>(by[kScale]), 0.6F, 1.5F);
  disc.ratio = std::clamp(disc.ratio + static_cast<float>(by[kRatio]), -0.5F, 0.9F);
  disc.sigma = std::clamp(disc.sigma + static_cast<float>(by[kSigma]), 0.4F * sigma, 3.0F * sigma);
}

}  // namespace

Task::Task(const optics::GreyView& the_picture, const DiscShape& the_shape,
           const optics::Imaging& imaging, bool is_sparse)
    : picture(&the_picture),
      sigma(static_cast<float>(std::sqrt(imaging.blur * imaging.blur + optics::kPixelBox))),
      sparse(is_sparse) {
  constants.black = static_cast<float>(imaging.black);
  constants.floor_variance =
      static_cast<float>(imaging.read_noise * imaging.read_noise + 1.0 / 12.0);
  constants.shot_gain = static_cast<float>(imaging.shot_gain);
  constants.texture = kTexture;
  constants.compressed = imaging.compressed;
  setShape(the_shape);
}

bool Task::setShape(const DiscShape& the_shape) {
  if (pixels != nullptr && the_shape == shape) return false;
  shape = the_shape;
  constants.radius = shape.radius();
  const float* m = shape.m;
  const float square = constants.radius * constants.radius;
  constants.outline = {square * (m[0] * m[0] + m[2] * m[2]), square * (m[0] * m[1] + m[2] * m[3]),
                       square * (m[1] * m[1] + m[3] * m[3])};
  return setSigma(sigma);
}

bool Task::setSigma(float the_sigma) {
  sigma = the_sigma;
  return choosePixels();
}

bool Task::setMargin(float sigmas) {
  margin_sigmas = sigmas;
  return choosePixels();
}

bool Task::setSparse(bool is_sparse) {
  sparse = is_sparse;
  return choosePixels();
}

bool Task::choosePixels() {
  const float sigmas = sparse ? kMarginSparse : margin_sigmas;
  const float margin =
      std::max(2.0F * sigma, std::min(sigmas * sigma, kMostMargin * constants.radius));
  const std::shared_ptr<const PixelLayout>& found =
      PixelLayout::about(shape, sigma, margin, sparse);
  if (pixels == found) return false;
  pixels = found;
  return true;
}

bool Task::gather(GridPoint point, Window& window) const {
  if (window.pixels != pixels) window.pixels = pixels;
  return pixels->gather(*picture, point, window);
}

float noiseOver(double squares, double freedom, bool robust) {
  constexpr double kLeft = 0.848;  // variance left by a biweight with a cutoff of 5 deviations
  const double variance = std::max(0.0, squares) / std::max(1.0, freedom);
  return std::max(kLeastNoise, static_cast<float>(std::sqrt(robust ? variance / kLeft : variance)));
}

std::array<double, 3> covarianceOf(const std::array<double, 3>& expected,
                                   const std::array<double, 3>& scatter) {
  // The normal matrix is right if the noise is as expected. The pull of the residuals on the centre
  // is always right, but estimated from few pixels. So the former gives the shape and the latter
  // the size.
  const double size = kScatterLoss * 0.5 * (scatter[0] / expected[0] + scatter[2] / expected[2]);
  return {size * expected[0] + kFloor * kFloor, size * expected[1],
          size * expected[2] + kFloor * kFloor};
}

std::optional<GridPoint> settlePlain(const Task& task, GridPoint start, Window& window,
                                     Disc& disc) {
  GridPoint last;
  const auto estimate = [&](GridPoint point) -> std::optional<optics::Pixel> {
    const Rough rough = roughAt(task, point);
    if (!rough.good) return std::nullopt;
    last = point;
    disc = rough.disc;
    const optics::Pixel at = point.pixel();
    return optics::Pixel{at.x + static_cast<double>(disc.x), at.y + static_cast<double>(disc.y)};
  };
  const std::optional<GridPoint> chosen = settle(start, kDoubt, kMostMoves, estimate);
  if (!chosen) return chosen;
  if (!(last == *chosen)) static_cast<void>(estimate(*chosen));
  return task.gather(*chosen, window) ? chosen : std::nullopt;
}

Outcome fitPlain(const Task& task, Window& window, const Disc& rough) {
  Outcome out;
  Disc disc = rough;
  if (!window.plain) startSaturated(window, task.constants, disc);
  // Holes and hot pixels deviate strongly even from the coarse disc.
  const float deviation = std::sqrt(task.constants.noiseAt(rough.white));
  float cutoff = std::max(kCutoff, kRoughCutoff * rough.white / deviation);
  const auto cutoffAfter = [](double squares, const Row& by, const Row& right, double pixels,
                              bool robust) {
    // Predicts the sum of squares after the step.
    for (std::size_t i = 0; i < kUnknowns; ++i) squares -= by[i] * right[i];
    return kCutoff * std::max(1.0F, noiseOver(squares, pixels - kFreedoms, robust));
  };
  // Full steps until they are small: usually one.
  std::optional<Factor<kBlock, DoublePair>> factor;  // odd and even block
  const auto solve = [&](const Row& right) {
    std::array<DoublePair, kBlock> both;
    for (std::size_t i = 0; i < kBlock; ++i) both[i] = DoublePair{right[i], right[i + kBlock]};
    both = factor->solve(both);
    Row steps;
    for (std::size_t i = 0; i < kBlock; ++i) {
      steps[i] = both[i][0];
      steps[i + kBlock] = both[i][1];
    }
    return steps;
  };
  float matrix_cutoff = cutoff;
  Row by{};
  double pixels = 0;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    matrix_cutoff = cutoff;
    Blocks blocks;
    sumBlocks(window, task.constants, disc, cutoff, blocks);
    Row& right = blocks.right;
    const Counts& counts = blocks.counts;
    pixels = counts.pixels;
    const double full = counts.full / std::max(1.0, pixels);
    const auto known = knownOf(disc, task.sigma, full);
    for (const Known& k : known) {
      const std::size_t i = k.i % kBlock;
      right[k.i] += k.off * k.weight;
      (k.i < kBlock ? blocks.odd : blocks.even)[i * (i + 1) / 2 + i] += k.weight;
    }
    std::array<DoublePair, 10> normal;
    for (std::size_t i = 0; i < normal.size(); ++i) {
      normal[i] = DoublePair{blocks.odd[i], blocks.even[i]};
    }
    factor.emplace(normal);
    if (!factor->good()) return out;
    by = solve(right);
    cutoff = cutoffAfter(blocks.squares, by, right, pass > 0 ? counts.weight : pixels, pass > 0);
    step(disc, by, task.sigma);
    // The set of unsaturated pixels changes while the white level is found.
    const double strict = counts.full < 0.5 ? 1 : kSettledFull;
    if (by[kX] * by[kX] + by[kY] * by[kY] < strict * strict * kSettled * kSettled &&
        std::abs(by[kSigma]) < strict * kSettledBlur * static_cast<double>(disc.sigma) &&
        std::abs(by[kScale]) < strict * kSettledScale &&
        (strict == 1 || std::abs(by[kWhite]) < kSettledWhite * static_cast<double>(disc.white))) {
      break;
    }
  }
  // Then a robust step of the centre alone, which also gives its covariance.
  const auto column = [&](std::size_t unknown, bool even) {
    const std::array<DoublePair, kBlock> both = factor->inverseColumn(unknown % kBlock);
    BlockRow out_row;
    for (std::size_t i = 0; i < kBlock; ++i) out_row[i] = both[i][even ? 1 : 0];
    return out_row;
  };
  BlockRow row_x = column(kX, false);
  BlockRow row_y = column(kY, false);
  const double ratio_variance = column(kRatio, true)[kRatio - kBlock];
  const double pixel_weight = beliefAt(kCutoff) / beliefAt(matrix_cutoff);
  for (double& r : row_x) r /= pixel_weight;
  for (double& r : row_y) r /= pixel_weight;
  LastStep last;
  sumLast(window, by, cutoff, row_x, row_y, last);
  disc.x += static_cast<float>(last.x);
  disc.y += static_cast<float>(last.y);
  // A light gradient g across an edge blurred by sigma displaces it by sigma^2 g / white: the blur
  // of a product is not the product of the blurs.
  const float white = disc.white + disc.slope_x * disc.x + disc.slope_y * disc.y;
  const float moved = white > 0 ? disc.sigma * disc.sigma / white : 0.0F;
  out.x = window.base_x + static_cast<double>(disc.x + moved * disc.slope_x);
  out.y = window.base_y + static_cast<double>(disc.y + moved * disc.slope_y);
  out.floor = kFloor * kFloor;
  out.covariance = covarianceOf({row_x[kX], row_x[kY], row_y[kY]}, last.variance);
  out.white = white;
  out.ratio = disc.ratio;
  out.scale = disc.scale;
  out.sigma = disc.sigma;
  out.slope_x = disc.slope_x;
  out.slope_y = disc.slope_y;
  const double weight = last.weight - (window.count - pixels);
  out.noise = noiseOver(last.squares, weight - kFreedoms, true);
  out.weight = static_cast<float>(weight / std::max(1.0, pixels));
  out.pixels = static_cast<int>(pixels);
  out.cost = static_cast<float>(last.cost);
  out.correlation = static_cast<float>(correlation(window));
  out.ratio_error = static_cast<float>(std::sqrt(ratio_variance));
  out.good = std::isfinite(out.x) && std::isfinite(out.y);
  return out;
}

}  // namespace lab::detector::fit
