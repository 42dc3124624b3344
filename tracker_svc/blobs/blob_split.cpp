#include "tracker_svc/blobs/blob_split.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "light/optics/levenberg_marquardt.hpp"

namespace lab::detector {
namespace {

constexpr double kModelError = 0.02;    // [1] of the contrast: shapes are not quite ellipses
constexpr double kTouch = 0.01;         // [px] error where blurred outlines meet
constexpr double kUnusual = 4;          // [1] standard deviations of the sizes
constexpr double kLeastUnusual = 0.35;  // [1] of the size
constexpr double kSingular = 1e-9;
constexpr double kFar = 4;  // [1] beyond it an edge is not seen
constexpr int kEvaluations = 40;
constexpr double kGoodMisfit = 0.05;  // [1] no other start is tried
constexpr int kTries = 8;
constexpr int kRoundTries = 5;
constexpr std::size_t kMostPixels = 10'000;  // of a fit; with more it takes minutes

/// Pixels and the shape, with the unknowns: x, y, the logarithm of the size and perhaps the angle
/// of each blob, then the contrast.
class Fit {
 public:
  Fit(const std::vector<ContrastPixel>& pixels, int count, const BlobShape& shape)
      : pixels_(pixels), count_(count), shape_(shape), each_(shape.isRound() ? 3 : 4) {
    for (const ContrastPixel& pixel : pixels) level_ = std::max(level_, pixel.contrast);
    for (const ContrastPixel& pixel : pixels) {
      const double model = kModelError * level_;
      sigmas_.push_back(std::sqrt(pixel.variance + model * model));
    }
  }

  [[nodiscard]] int unknowns() const { return each_ * count_ + 1; }
  [[nodiscard]] int each() const { return each_; }
  [[nodiscard]] double level() const { return level_; }

  /// The share of a pixel that an ellipse covers, by the distance of the pixel from its outline.
  [[nodiscard]] double coverage(const ContrastPixel& pixel, const double* blob) const {
    const double dx = pixel.x - blob[0];
    const double dy = pixel.y - blob[1];
    double u = dx;
    double v = dy;
    if (each_ > 3) {
      const double cosine = std::cos(blob[3]);
      const double sine = std::sin(blob[3]);
      u = cosine * dx + sine * dy;
      v = -sine * dx + cosine * dy;
    }
    const double size = std::exp(blob[2]);
    const double a = shape_.long_axis * size;
    const double b = shape_.short_axis * size;
    const double p = u / a;
    const double q = v / b;
    const double r = std::sqrt(p * p + q * q);
    if (r < 1e-6) return 1;
    const double slope = std::sqrt(p * p / (a * a) + q * q / (b * b)) / r;
    const double inside = (1 - r) / slope;
    const double z = inside / (std::numbers::sqrt2 * shape_.blur);
    if (std::abs(z) > kFar) return z > 0 ? 1 : 0;
    return 0.5 * std::erfc(-z);
  }

  void residuals(const Eigen::VectorXd& x, Eigen::Ref<Eigen::VectorXd> out) const {
    const double level = x[unknowns() - 1];
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      double sum = 0;
      for (int k = 0; k < count_; ++k) sum += coverage(pixels_[i], &x[each_ * k]);
      out[static_cast<Eigen::Index>(i)] = residual(i, level, sum);
    }
    const auto last = static_cast<Eigen::Index>(pixels_.size());
    for (int k = 0; k < count_; ++k) out[last + k] = x[each_ * k + 2] / shape_.spread;
  }

  void jacobian(const Eigen::VectorXd& x, Eigen::Ref<Eigen::MatrixXd> out) const {
    constexpr double kStep = 1e-4;
    const double level = x[unknowns() - 1];
    const auto last = static_cast<Eigen::Index>(pixels_.size());
    out.setZero();
    std::array<double, 4> blob{};
    std::vector<double> parts(static_cast<std::size_t>(count_));
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      double sum = 0;
      for (int k = 0; k < count_; ++k) {
        sum += parts[static_cast<std::size_t>(k)] = coverage(pixels_[i], &x[each_ * k]);
      }
      const double here = residual(i, level, sum);
      for (int k = 0; k < count_; ++k) {
        for (int j = 0; j < each_; ++j) {
          std::copy_n(&x[each_ * k], each_, blob.begin());
          blob[static_cast<std::size_t>(j)] += kStep;
          const double moved =
              sum - parts[static_cast<std::size_t>(k)] + coverage(pixels_[i], blob.data());
          out(row, each_ * k + j) = (residual(i, level, moved) - here) / kStep;
        }
      }
      out(row, unknowns() - 1) = shown(sum) / sigmas_[i];
    }
    for (int k = 0; k < count_; ++k) out(last + k, each_ * k + 2) = 1 / shape_.spread;
  }

  [[nodiscard]] int residualCount() const { return static_cast<int>(pixels_.size()) + count_; }

  /// Whether no blob shrank or grew to fill a gap.
  [[nodiscard]] bool hasUsualSizes(const Eigen::VectorXd& x) const {
    const double most = std::max(kUnusual * shape_.spread, kLeastUnusual);
    for (int k = 0; k < count_; ++k) {
      if (!(std::abs(x[each_ * k + 2]) < most)) return false;
    }
    return true;
  }

  /// The rms of the residuals without their weights, over the contrast.
  [[nodiscard]] double misfit(const Eigen::VectorXd& residuals, double level) const {
    double sum = 0;
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      const double r = residuals[static_cast<Eigen::Index>(i)] * sigmas_[i];
      sum += r * r;
    }
    return std::sqrt(sum / static_cast<double>(pixels_.size())) / std::max(level, 1e-9);
  }

 private:
  /// Bodies beside each other add up. Those that overlap are not darker, but a fit must not hide
  /// one below the others, so they count half.
  [[nodiscard]] static double shown(double coverage) {
    return coverage <= 1 ? coverage : 1 + (coverage - 1) / 2;
  }

  [[nodiscard]] double residual(std::size_t i, double level, double coverage) const {
    return (level * shown(coverage) - pixels_[i].contrast) / sigmas_[i];
  }

  const std::vector<ContrastPixel>& pixels_;
  int count_;
  BlobShape shape_;
  int each_;
  double level_ = 0;
  std::vector<double> sigmas_;
};

/// Centres of `count` clusters of the pixels that stand out (Lloyd's algorithm, starting with
/// pixels far from each other).
std::vector<optics::Pixel> clusters(const std::vector<ContrastPixel>& pixels, int count,
                                    double level, std::size_t seed) {
  std::vector<const ContrastPixel*> inside;
  for (const ContrastPixel& pixel : pixels) {
    if (pixel.contrast > 0.5 * level) inside.push_back(&pixel);
  }
  if (inside.size() < static_cast<std::size_t>(count)) return {};
  const auto square = [](const ContrastPixel& pixel, const optics::Pixel& centre) {
    return (pixel.x - centre.x) * (pixel.x - centre.x) +
           (pixel.y - centre.y) * (pixel.y - centre.y);
  };
  const ContrastPixel& first = *inside[seed * 7919 % inside.size()];
  std::vector<optics::Pixel> centres{{first.x, first.y}};
  const auto nearest = [&](const ContrastPixel& pixel, std::size_t& which) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < centres.size(); ++k) {
      const double here = square(pixel, centres[k]);
      if (here >= least) continue;
      least = here;
      which = k;
    }
    return least;
  };
  std::size_t which = 0;
  while (centres.size() < static_cast<std::size_t>(count)) {
    const ContrastPixel* farthest = inside.front();
    double most = -1;
    for (const ContrastPixel* pixel : inside) {
      const double here = nearest(*pixel, which);
      if (here <= most) continue;
      most = here;
      farthest = pixel;
    }
    centres.push_back({farthest->x, farthest->y});
  }
  constexpr int kRounds = 12;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<std::array<double, 3>> sums(centres.size());
    for (const ContrastPixel* pixel : inside) {
      nearest(*pixel, which);
      sums[which][0] += 1;
      sums[which][1] += pixel->x;
      sums[which][2] += pixel->y;
    }
    for (std::size_t k = 0; k < centres.size(); ++k) {
      if (sums[k][0] > 0) centres[k] = {sums[k][1] / sums[k][0], sums[k][2] / sums[k][0]};
    }
  }
  return centres;
}

/// The direction in which the pixels nearest to each centre extend.
std::vector<double> directions(const std::vector<ContrastPixel>& pixels,
                               const std::vector<optics::Pixel>& centres, double level) {
  std::vector<std::array<double, 2>> sums(centres.size());
  for (const ContrastPixel& pixel : pixels) {
    if (pixel.contrast < 0.5 * level) continue;
    std::size_t which = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < centres.size(); ++k) {
      const double here = std::hypot(pixel.x - centres[k].x, pixel.y - centres[k].y);
      if (here < least) {
        least = here;
        which = k;
      }
    }
    const double u = pixel.x - centres[which].x;
    const double v = pixel.y - centres[which].y;
    sums[which][0] += u * u - v * v;
    sums[which][1] += 2 * u * v;
  }
  std::vector<double> angles;
  for (const auto& sum : sums) angles.push_back(0.5 * std::atan2(sum[1], sum[0]));
  return angles;
}

/// Where a fit begins.
struct Start {
  std::vector<optics::Pixel> centres;
  std::vector<double> angles;
};

/// Long blobs side by side, in a row that is turned against the long axis of the whole group.
Start rowOf(const std::vector<ContrastPixel>& pixels, int count, double level,
            const BlobShape& shape, double turn) {
  optics::Pixel middle;
  double sum = 0;
  for (const ContrastPixel& pixel : pixels) {
    if (pixel.contrast < 0.5 * level) continue;
    middle.x += pixel.x;
    middle.y += pixel.y;
    ++sum;
  }
  middle.x /= std::max(sum, 1.0);
  middle.y /= std::max(sum, 1.0);
  const double way = directions(pixels, {middle}, level).front() + turn;
  const double apart = 2 * shape.short_axis;
  Start start;
  for (int k = 0; k < count; ++k) {
    const double from = (k - (count - 1) / 2.0) * apart;
    start.centres.push_back({middle.x + from * std::cos(way), middle.y + from * std::sin(way)});
    start.angles.push_back(way + std::numbers::pi / 2);
  }
  return start;
}

Start startOf(int attempt, const std::vector<ContrastPixel>& pixels, int count, double level,
              const BlobShape& shape) {
  constexpr int kRows = 4;
  if (!shape.isRound() && attempt < kRows) {
    // First across the group. Two blobs may also extend farther across than along.
    const double turn = std::numbers::pi * (0.5 + static_cast<double>(attempt) / kRows);
    return rowOf(pixels, count, level, shape, turn);
  }
  Start start;
  start.centres = clusters(pixels, count, level,
                           static_cast<std::size_t>(shape.isRound() ? attempt : attempt / 2));
  if (start.centres.empty()) return start;
  start.angles = directions(pixels, start.centres, level);
  // Long blobs side by side form clusters that extend across them.
  for (double& angle : start.angles) angle += attempt % 2 == 0 ? 0 : std::numbers::pi / 2;
  return start;
}

/// Every n-th pixel, so many that a fit is quick.
std::vector<ContrastPixel> thinned(const std::vector<ContrastPixel>& pixels) {
  const std::size_t step = 1 + (pixels.size() - 1) / kMostPixels;
  std::vector<ContrastPixel> fewer;
  for (std::size_t i = 0; i < pixels.size(); i += step) fewer.push_back(pixels[i]);
  return fewer;
}

}  // namespace

std::optional<BlobSplit> splitBlob(const std::vector<ContrastPixel>& pixels, int count,
                                   const BlobShape& shape,
                                   const std::vector<optics::Pixel>& starts) {
  if (pixels.size() > kMostPixels) return splitBlob(thinned(pixels), count, shape, starts);
  const Fit fit(pixels, count, shape);
  if (fit.residualCount() < 2 * fit.unknowns()) return {};
  const bool separate = starts.size() == static_cast<std::size_t>(count);
  const int tries = separate ? 1 : shape.isRound() ? kRoundTries : kTries;
  Eigen::VectorXd best;
  Eigen::VectorXd residuals(fit.residualCount());
  double least = std::numeric_limits<double>::infinity();
  for (int attempt = 0; attempt < tries; ++attempt) {
    const Start start = separate ? Start{starts, directions(pixels, starts, fit.level())}
                                 : startOf(attempt, pixels, count, fit.level(), shape);
    if (start.centres.empty()) continue;
    Eigen::VectorXd x(fit.unknowns());
    for (int k = 0; k < count; ++k) {
      const auto one = static_cast<std::size_t>(k);
      x[fit.each() * k] = start.centres[one].x;
      x[fit.each() * k + 1] = start.centres[one].y;
      x[fit.each() * k + 2] = 0;
      if (fit.each() > 3) x[fit.each() * k + 3] = start.angles[one];
    }
    x[fit.unknowns() - 1] = fit.level();
    x = optics::solveLeastSquares(
        {.residuals = fit.residualCount(),
         .residuals_at = [&](const Eigen::VectorXd& at,
                             Eigen::Ref<Eigen::VectorXd> out) { fit.residuals(at, out); },
         .jacobian_at = [&](const Eigen::VectorXd& at,
                            Eigen::Ref<Eigen::MatrixXd> out) { fit.jacobian(at, out); },
         .tolerance = 1e-6,
         .evaluations = kEvaluations},
        x);
    fit.residuals(x, residuals);
    if (!fit.hasUsualSizes(x)) continue;
    const double sum = residuals.squaredNorm();
    if (!(sum < least)) continue;
    least = sum;
    best = x;
    if (fit.misfit(residuals, x[fit.unknowns() - 1]) < kGoodMisfit) break;
  }
  if (!(least < std::numeric_limits<double>::infinity())) return {};
  fit.residuals(best, residuals);
  Eigen::MatrixXd jacobian(fit.residualCount(), fit.unknowns());
  fit.jacobian(best, jacobian);
  const std::optional<Eigen::MatrixXd> inverse =
      optics::covarianceOf(jacobian.transpose() * jacobian, kSingular);
  if (!inverse) return {};
  const double freedom = fit.residualCount() - fit.unknowns();
  const Eigen::MatrixXd covariance = *inverse * std::max(1.0, least / freedom);
  BlobSplit split;
  split.contrast = best[fit.unknowns() - 1];
  split.misfit = fit.misfit(residuals, split.contrast);
  for (int k = 0; k < count; ++k) {
    const Eigen::Index i = fit.each() * k;
    BlobPart part;
    part.centre = {best[i], best[i + 1]};
    const double floor = kTouch * kTouch;
    part.covariance = {
        covariance(i, i) + floor, covariance(i, i + 1), 0, covariance(i + 1, i + 1) + floor, 0, 0};
    if (fit.each() > 3) {
      part.angle = best[i + 3];
      part.covariance[2] = covariance(i, i + 3);
      part.covariance[4] = covariance(i + 1, i + 3);
      part.covariance[5] = covariance(i + 3, i + 3);
    }
    split.parts.push_back(part);
  }
  return split;
}

}  // namespace lab::detector
