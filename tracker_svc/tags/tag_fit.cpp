#include "tracker_svc/tags/tag_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/math/angle.hpp"
#include "tracker_svc/plane_pose.hpp"

namespace lab::detector {
namespace {

constexpr double kRounding = 1.0 / 12;  // [DN^2]
constexpr double kMargin = 0.5;         // [cells] at the rim of the pattern that are not used
constexpr double kReach = 3.5;          // [1] blurs at which an edge is not seen any more
constexpr double kFloor = 0.003;        // [px] errors that noise does not explain: pixels, lens
constexpr double kLossyErrors = 2;      // [1] variance in compressed pictures: correlated residuals
constexpr int kIterations = 30;
constexpr int kUnknowns = 12;

enum Unknown { kX, kY, kTheta, kSize, kBlur, kWhite, kAlongX, kAlongY, kContrast, kXX, kXY, kYY };

using Vector = Eigen::Matrix<double, kUnknowns, 1>;
using Matrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;

struct FitPixel {
  double x = 0;     ///< [m] on the plane, from the start
  double y = 0;     ///< [m]
  double grey = 0;  ///< [DN] without black level
};

/// Darkness of a blurred pattern, with its derivatives by column, row and blur [1/cells].
struct Darkness {
  double value = 0;
  double by_column = 0;
  double by_row = 0;
  double by_blur = 0;
};

/// How much of each column (or row) of cells is seen at a place.
struct Window {
  static constexpr int kMost = 16;
  int first = 0;
  int count = 0;
  double weight[kMost] = {};
  double by_place[kMost] = {};
  double by_blur[kMost] = {};

  Window(double place, double blur) {
    constexpr double kPerRoot = std::numbers::inv_sqrtpi / std::numbers::sqrt2;
    first = static_cast<int>(std::floor(place - kReach * blur));
    const int last = static_cast<int>(std::floor(place + kReach * blur));
    count = std::min(last - first + 1, kMost);
    double before[3] = {};
    for (int i = 0; i <= count; ++i) {
      const double z = (first + i - place) / blur;
      const double share = 0.5 * std::erfc(-z / std::numbers::sqrt2);
      const double density = kPerRoot * std::exp(-z * z / 2) / blur;
      if (i > 0) {
        weight[i - 1] = share - before[0];
        by_place[i - 1] = before[1] - density;
        by_blur[i - 1] = before[2] - z * density;
      }
      before[0] = share;
      before[1] = density;
      before[2] = z * density;
    }
  }
};

Darkness darknessAt(const optics::TagPattern& pattern, double column, double row, double blur) {
  const Window columns(column, blur);
  const Window rows(row, blur);
  Darkness sum;
  for (int j = 0; j < rows.count; ++j) {
    const int v = rows.first + j;
    if (v < 0 || v >= pattern.cells) continue;
    double value = 0;
    double by_column = 0;
    double by_blur = 0;
    for (int i = 0; i < columns.count; ++i) {
      const int u = columns.first + i;
      if (u < 0 || u >= pattern.cells) continue;
      const auto dark = static_cast<double>(pattern.at(u, v));
      value += dark * columns.weight[i];
      by_column += dark * columns.by_place[i];
      by_blur += dark * columns.by_blur[i];
    }
    sum.value += rows.weight[j] * value;
    sum.by_column += rows.weight[j] * by_column;
    sum.by_row += rows.by_place[j] * value;
    sum.by_blur += rows.weight[j] * by_blur + rows.by_blur[j] * value;
  }
  return sum;
}

class TagFit {
 public:
  TagFit(const optics::GreyView& picture, const optics::CameraModel& camera,
         const optics::Imaging& imaging, const optics::TagPattern& pattern, double height,
         const TagPose& start)
      : picture_(picture),
        camera_(camera),
        imaging_(imaging),
        pattern_(pattern),
        height_(height),
        start_(start) {}

  [[nodiscard]] std::optional<TagPose> fit() {
    if (!collect()) return {};
    Vector x = begin();
    Matrix information;
    Vector gradient;
    double sum = evaluate(x, &information, &gradient);
    double damping = 1e-3;
    for (int i = 0; i < kIterations; ++i) {
      Matrix damped = information;
      damped.diagonal() *= 1 + damping;
      const Vector step = damped.ldlt().solve(-gradient);
      const Vector next = x + step;
      const bool possible = step.allFinite() && next[kBlur] > 0.02 * pixel_ &&
                            next[kBlur] < 2 * cell_ && std::abs(next[kSize]) < 0.3;
      const double there = possible ? evaluate(next, nullptr, nullptr) : sum;
      if (possible && there < sum) {
        const bool done = sum - there < 1e-6 * sum;
        x = next;
        sum = evaluate(x, &information, &gradient);
        damping *= 0.2;
        if (done) break;
      } else {
        damping *= 8;
        if (damping > 1e6) break;
      }
    }
    return result(x, sum, information);
  }

 private:
  /// Chooses the pixels whose light comes from inside the pattern.
  bool collect() {
    const std::optional<PlanePoint> middle =
        planePoint(camera_, camera_.project(start_.x, start_.y, height_), height_);
    if (!middle) return false;
    cell_ = start_.size / (2 * pattern_.half_square);
    pixel_ = std::sqrt(std::abs(determinant(middle->per_pixel)));
    const double half = pattern_.cells / 2.0 * cell_;
    const double reach = std::numbers::sqrt2 * half / pixel_ * 1.2;
    const optics::Pixel at = camera_.project(start_.x, start_.y, height_);
    if (!picture_.contains(at.x, at.y)) return false;
    const double limit = half - kMargin * cell_;
    const double cosine = std::cos(start_.theta);
    const double sine = std::sin(start_.theta);
    const int top = static_cast<int>(std::floor(at.y - reach));
    const int left = static_cast<int>(std::floor(at.x - reach));
    for (int v = top; v <= top + static_cast<int>(2 * reach) + 1; ++v) {
      for (int u = left; u <= left + static_cast<int>(2 * reach) + 1; ++u) {
        const std::optional<optics::Place> place =
            camera_.toPlane({static_cast<double>(u), static_cast<double>(v)}, height_);
        if (!place) continue;
        const double x = place->x - start_.x;
        const double y = place->y - start_.y;
        if (std::abs(cosine * x + sine * y) > limit || std::abs(-sine * x + cosine * y) > limit) {
          continue;
        }
        if (!picture_.contains(u, v)) return false;
        pixels_.push_back({x, y, picture_.row(v)[u] - imaging_.black});
      }
    }
    return pixels_.size() > 4 * kUnknowns;
  }

  [[nodiscard]] Vector begin() const {
    std::vector<double> greys;
    for (const FitPixel& pixel : pixels_) greys.push_back(pixel.grey);
    const auto at = [&](double share) {
      const auto place = greys.begin() +
                         static_cast<std::ptrdiff_t>(share * static_cast<double>(greys.size() - 1));
      std::nth_element(greys.begin(), place, greys.end());
      return *place;
    };
    const double dark = at(0.1);
    const double bright = std::max(at(0.9), 1.0);
    Vector x = Vector::Zero();
    x[kTheta] = start_.theta;
    x[kBlur] = std::sqrt(imaging_.blur * imaging_.blur + optics::kPixelBox) * pixel_;
    x[kWhite] = bright;
    x[kContrast] = std::clamp(1 - dark / bright, 0.2, 0.98);
    return x;
  }

  /// @return the sum of squares of the residuals over the noise
  double evaluate(const Vector& x, Matrix* information, Vector* gradient) const {
    if (information != nullptr) {
      information->setZero();
      gradient->setZero();
    }
    const double cosine = std::cos(x[kTheta]);
    const double sine = std::sin(x[kTheta]);
    const double cell = cell_ * std::exp(x[kSize]);
    const double blur = x[kBlur] / cell;
    const double middle = pattern_.cells / 2.0;
    double sum = 0;
    Vector by;
    for (const FitPixel& pixel : pixels_) {
      const double dx = pixel.x - x[kX];
      const double dy = pixel.y - x[kY];
      const double along = (cosine * dx + sine * dy) / cell;
      const double up = (-sine * dx + cosine * dy) / cell;
      const Darkness dark = darknessAt(pattern_, middle + along, middle - up, blur);
      const double light = x[kWhite] + x[kAlongX] * pixel.x + x[kAlongY] * pixel.y +
                           x[kXX] * pixel.x * pixel.x + x[kXY] * pixel.x * pixel.y +
                           x[kYY] * pixel.y * pixel.y;
      const double share = 1 - x[kContrast] * dark.value;
      const double model = light * share;
      const double variance = imaging_.read_noise * imaging_.read_noise + kRounding +
                              imaging_.shot_gain * std::max(0.0, pixel.grey);
      const double residual = model - pixel.grey;
      sum += residual * residual / variance;
      if (information == nullptr) continue;
      const double d = -light * x[kContrast];
      const double c = d * dark.by_column;
      const double r = d * dark.by_row;
      by[kX] = (-cosine * c - sine * r) / cell;
      by[kY] = (-sine * c + cosine * r) / cell;
      by[kTheta] = up * c + along * r;
      by[kSize] = -along * c + up * r - d * dark.by_blur * blur;
      by[kBlur] = d * dark.by_blur / cell;
      by[kWhite] = share;
      by[kAlongX] = share * pixel.x;
      by[kAlongY] = share * pixel.y;
      by[kContrast] = -light * dark.value;
      by[kXX] = share * pixel.x * pixel.x;
      by[kXY] = share * pixel.x * pixel.y;
      by[kYY] = share * pixel.y * pixel.y;
      information->noalias() += by * by.transpose() / variance;
      gradient->noalias() += by * (residual / variance);
    }
    return sum;
  }

  [[nodiscard]] std::optional<TagPose> result(const Vector& x, double sum,
                                              const Matrix& information) const {
    constexpr double kLeastContrast = 0.3;
    constexpr double kLeastChi2 = 0.1;
    if (!(x[kWhite] > 0) || !(x[kContrast] > kLeastContrast)) return {};
    const Eigen::LDLT<Matrix> solver(information);
    if (solver.info() != Eigen::Success || !solver.isPositive()) return {};
    TagPose pose;
    pose.chi2 = sum / static_cast<double>(pixels_.size() - kUnknowns);
    const double scale = std::max(pose.chi2, kLeastChi2) * (imaging_.compressed ? kLossyErrors : 1);
    const Matrix covariance = solver.solve(Matrix::Identity()) * scale;
    const double floor = kFloor * pixel_ * kFloor * pixel_;
    pose.x = start_.x + x[kX];
    pose.y = start_.y + x[kY];
    pose.theta = wrapAngle(x[kTheta]);
    pose.size = start_.size * std::exp(x[kSize]);
    pose.covariance = {covariance(kX, kX) + floor, covariance(kX, kY),
                       covariance(kX, kTheta),     covariance(kY, kY) + floor,
                       covariance(kY, kTheta),     covariance(kTheta, kTheta)};
    pose.white = x[kWhite];
    pose.contrast = x[kContrast];
    pose.blur = x[kBlur] / pixel_;
    double squares = 0;
    double variances = 0;
    for (const FitPixel& pixel : pixels_) {
      variances += imaging_.read_noise * imaging_.read_noise + kRounding +
                   imaging_.shot_gain * std::max(0.0, pixel.grey);
    }
    squares = pose.chi2 * variances / static_cast<double>(pixels_.size());
    pose.misfit = std::sqrt(squares) / (pose.white * pose.contrast);
    const bool finite = std::isfinite(pose.x) && std::isfinite(pose.y) &&
                        std::isfinite(pose.theta) && covariance.allFinite() &&
                        pose.covariance[0] > 0 && pose.covariance[5] > 0;
    if (!finite || std::hypot(x[kX], x[kY]) > cell_) return {};
    return pose;
  }

  const optics::GreyView& picture_;
  const optics::CameraModel& camera_;
  const optics::Imaging& imaging_;
  const optics::TagPattern& pattern_;
  double height_;
  TagPose start_;
  double cell_ = 0;   ///< [m]
  double pixel_ = 0;  ///< [m]
  std::vector<FitPixel> pixels_;
};

}  // namespace

std::optional<TagPose> fitTag(const optics::GreyView& picture, const optics::CameraModel& camera,
                              const optics::Imaging& imaging, const optics::TagPattern& pattern,
                              double height, const TagPose& start) {
  return TagFit(picture, camera, imaging, pattern, height, start).fit();
}

}  // namespace lab::detector
