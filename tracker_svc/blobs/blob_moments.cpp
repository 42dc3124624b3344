#include "tracker_svc/blobs/blob_moments.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lab::detector {
namespace {

constexpr double kDarkGround = 10;  // [DN] below which the ground does not tell the light
constexpr double kLeastRing = 12;   // [px] for a plane
constexpr double kLevel = 0.7;      // quantile of the contrasts inside a blob
constexpr double kLow = 0.15;       // [1] of the contrast: below it nothing counts
constexpr double kClear = 3;        // [1] standard deviations of noise below that
constexpr double kMostLow = 0.35;   // [1]
constexpr double kFloor = 0.003;    // [px] errors that noise does not explain: pixels, lens
constexpr double kOutlier = 4;      // [1] standard deviations of the ring

/// The ground as a plane, and what is known about it.
struct Plane {
  double x0 = 0, y0 = 0;                            ///< [px] origin
  Eigen::Vector3d value = Eigen::Vector3d::Zero();  ///< [DN] level, and slopes per px
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double excess = 1;  ///< [1] variance of the ring over that of the camera's noise

  [[nodiscard]] double at(double x, double y) const {
    return value[0] + value[1] * (x - x0) + value[2] * (y - y0);
  }
};

Plane groundPlane(const optics::GreyView& picture, const std::vector<const BlobArea*>& areas,
                  int edge, const BlobGround& ground) {
  Plane plane;
  double count = 0;
  for (const BlobArea* area : areas) {
    for (const AreaPixel& pixel : area->pixels) {
      if (pixel.steps > edge) continue;
      plane.x0 += pixel.x;
      plane.y0 += pixel.y;
      ++count;
    }
  }
  plane.x0 /= std::max(count, 1.0);
  plane.y0 /= std::max(count, 1.0);
  const auto middle = static_cast<std::size_t>(
      std::clamp(std::lround(plane.x0), 0L, static_cast<long>(picture.width) - 1));
  const int row = static_cast<int>(
      std::clamp(std::lround(plane.y0), 0L, static_cast<long>(picture.height) - 1));
  plane.value[0] = static_cast<double>(ground.row(row)[middle]);
  const double variance = ground.variance(plane.value[0]);
  // Twice: the second time without dust and the tails of other blobs.
  for (int pass = 0; pass < 2; ++pass) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double squares = 0;
    double used = 0;
    for (const BlobArea* area : areas) {
      for (const AreaPixel& pixel : area->pixels) {
        if (pixel.steps <= edge) continue;
        const ColumnSpan& span = ground.columns()[static_cast<std::size_t>(pixel.y)];
        if (pixel.x < span.first || pixel.x > span.last) continue;
        const double grey = picture.row(pixel.y)[pixel.x];
        const double off = grey - plane.at(pixel.x, pixel.y);
        if (pass > 0 && off * off > kOutlier * kOutlier * plane.excess * variance) continue;
        const Eigen::Vector3d by(1, pixel.x - plane.x0, pixel.y - plane.y0);
        information += by * by.transpose();
        sum += by * grey;
        squares += grey * grey;
        ++used;
      }
    }
    if (used < kLeastRing) break;
    const Eigen::LDLT<Eigen::Matrix3d> solver(information);
    const Eigen::Vector3d value = solver.solve(sum);
    if (!value.allFinite() || solver.rcond() < 1e-9) break;
    plane.value = value;
    const double residual = std::max(0.0, squares - value.dot(sum)) / (used - 3);
    plane.excess = std::max(1.0, residual / variance);
    plane.covariance = solver.solve(Eigen::Matrix3d::Identity()) * plane.excess * variance;
  }
  return plane;
}

/// The contrast of a pixel relative to a plane.
struct Contrast {
  const optics::GreyView& picture;
  const BlobGround& ground;
  const Plane& plane;
  double sign;
  bool relative;

  [[nodiscard]] double light(const AreaPixel& pixel) const {
    return std::max(1.0, plane.at(pixel.x, pixel.y) - ground.imaging().black);
  }
  [[nodiscard]] ContrastPixel at(const AreaPixel& pixel) const {
    const double grey = picture.row(pixel.y)[pixel.x];
    const double scale = relative ? 1 / light(pixel) : 1;
    const double value = sign * (grey - plane.at(pixel.x, pixel.y)) * scale;
    const double variance = ground.variance(grey) * plane.excess * scale * scale;
    return {static_cast<double>(pixel.x), static_cast<double>(pixel.y), value, variance};
  }
};

Contrast contrastOver(const Plane& plane, const optics::GreyView& picture, const BlobGround& ground,
                      bool bright) {
  return {picture, ground, plane, bright ? 1.0 : -1.0,
          !bright && plane.value[0] - ground.imaging().black > kDarkGround};
}

/// Contrasts below `low` count as nothing, those above `high` as one. Not clipped: both 0.
struct Clip {
  double low = 0;
  double high = 0;

  [[nodiscard]] double weight(double contrast) const {
    return high > low ? std::clamp((contrast - low) / (high - low), 0.0, 1.0) : contrast;
  }
  [[nodiscard]] double slope(double contrast) const {
    if (!(high > low)) return 1;
    return contrast > low && contrast < high ? 1 / (high - low) : 0;
  }
};

struct Moments {
  double mass = 0;
  optics::Pixel centre;
  std::array<double, 3> second{};
};

std::optional<Moments> momentsOf(const std::vector<ContrastPixel>& pixels, const Clip& clip) {
  Moments sum;
  for (const ContrastPixel& pixel : pixels) {
    const double weight = clip.weight(pixel.contrast);
    sum.mass += weight;
    sum.centre.x += weight * pixel.x;
    sum.centre.y += weight * pixel.y;
  }
  if (!(sum.mass > 0)) return {};
  sum.centre.x /= sum.mass;
  sum.centre.y /= sum.mass;
  for (const ContrastPixel& pixel : pixels) {
    const double weight = clip.weight(pixel.contrast) / sum.mass;
    const double u = pixel.x - sum.centre.x;
    const double v = pixel.y - sum.centre.y;
    sum.second[0] += weight * u * u;
    sum.second[1] += weight * u * v;
    sum.second[2] += weight * v * v;
  }
  return sum;
}

}  // namespace

std::optional<BlobMoments> blobMoments(const optics::GreyView& picture, const BlobArea& area,
                                       int edge, const BlobGround& ground, bool bright) {
  const Plane plane = groundPlane(picture, {&area}, edge, ground);
  const Contrast contrast = contrastOver(plane, picture, ground, bright);
  BlobMoments result;
  result.relative = contrast.relative;
  std::vector<ContrastPixel> pixels;
  std::vector<double> inside;
  double noise = 0;
  for (const AreaPixel& pixel : area.pixels) {
    if (pixel.steps > edge) continue;
    pixels.push_back(contrast.at(pixel));
    if (pixel.steps > 0) continue;
    inside.push_back(pixels.back().contrast);
    noise += pixels.back().variance;
  }
  if (inside.empty()) return {};
  const auto level =
      inside.begin() + static_cast<std::ptrdiff_t>(kLevel * static_cast<double>(inside.size()));
  std::nth_element(inside.begin(), level, inside.end());
  result.contrast = *level;
  result.noise = std::sqrt(noise / static_cast<double>(inside.size()));
  result.ground = plane.value[0] - ground.imaging().black;
  if (!(result.contrast > 0)) return {};
  const std::optional<Moments> all = momentsOf(pixels, {0, 0});
  // Noise must not reach the clipped ends.
  const double low = std::max(kLow, kClear * result.noise / result.contrast);
  const bool clipped = low < kMostLow;
  const Clip clip = clipped ? Clip{low * result.contrast, (1 - low) * result.contrast} : Clip{0, 0};
  const std::optional<Moments> outline = clipped ? momentsOf(pixels, clip) : all;
  if (!all || !outline) return {};
  result.mass = all->mass;
  result.second = all->second;
  result.outline = outline->second;
  result.centre = outline->centre;

  // Derivatives of centre and axis by each pixel, and by the plane below all of them.
  const optics::Pixel& at = outline->centre;
  const double half = (outline->second[0] - outline->second[2]) / 2;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> by_plane = Eigen::Matrix<double, 4, 3>::Zero();
  for (const ContrastPixel& pixel : pixels) {
    const double slope = clip.slope(pixel.contrast);
    if (slope == 0) continue;
    const double u = pixel.x - at.x;
    const double v = pixel.y - at.y;
    const Eigen::Vector4d by =
        Eigen::Vector4d(u, v, (u * u - v * v) / 2 - half, u * v - outline->second[1]) *
        (slope / outline->mass);
    covariance += by * by.transpose() * pixel.variance;
    const double light = std::max(1.0, plane.at(pixel.x, pixel.y) - ground.imaging().black);
    const double scale = contrast.relative ? 1 / light : 1;
    by_plane += scale * by * Eigen::RowVector3d(1, pixel.x - plane.x0, pixel.y - plane.y0);
  }
  covariance += by_plane * plane.covariance * by_plane.transpose();
  const double floor = kFloor * kFloor;
  result.covariance = {covariance(0, 0) + floor, covariance(0, 1), covariance(1, 1) + floor};
  result.outline_covariance = {covariance(2, 2), covariance(2, 3), covariance(3, 3)};
  return result;
}

std::vector<ContrastPixel> contrastPixels(const optics::GreyView& picture,
                                          const std::vector<const BlobArea*>& areas, int edge,
                                          const BlobGround& ground, bool bright) {
  const Plane plane = groundPlane(picture, areas, edge, ground);
  const Contrast contrast = contrastOver(plane, picture, ground, bright);
  std::vector<ContrastPixel> pixels;
  for (const BlobArea* area : areas) {
    for (const AreaPixel& pixel : area->pixels) {
      if (pixel.steps <= edge) pixels.push_back(contrast.at(pixel));
    }
  }
  return pixels;
}

}  // namespace lab::detector
