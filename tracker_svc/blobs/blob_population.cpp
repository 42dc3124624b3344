#include "tracker_svc/blobs/blob_population.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "light/median.hpp"
#include "tracker_svc/blobs/blob_groups.hpp"

namespace lab::detector {
namespace {

constexpr double kFilled = 0.95;  // [1] of the ellipse with the same second moments
constexpr double kHollow = 0.5;   // [1] of that ellipse
constexpr double kHidden = 0.7;   // [1] of the usual area: partly hidden

}  // namespace

double Blob::size() const { return region.pixels * std::abs(determinant(at.per_pixel)); }

bool BlobPopulation::isClean(const Blob& blob) const {
  return blob.moments && !blob.area.cut && blob.area.neighbours.empty() &&
         blob.diameter >= settings_.smallest && blob.diameter <= settings_.largest;
}

void BlobPopulation::learn(const std::vector<Blob>& blobs) {
  constexpr std::size_t kFewest = 3;
  constexpr double kAlike = 0.15;        // [1] median deviation of areas
  constexpr double kEqual = 0.06;        // [1]
  constexpr double kNormal = 1.4826;     // standard deviation over median deviation
  constexpr double kLeastSpread = 0.02;  // [1] of lengths
  constexpr double kLeastBlur = 0.5;     // [px]
  std::vector<double> areas;
  std::vector<double> longs;
  std::vector<double> shorts;
  std::vector<double> blurs;
  for (const Blob& blob : blobs) {
    if (!isClean(blob)) continue;
    const BlobAxes axes = axesOf(*blob.moments);
    const double pixels = blob.region.pixels;
    areas.push_back(blob.size());
    // A blurred ellipse has the second moments a^2 / 4 + s^2 and b^2 / 4 + s^2, and its outline at
    // half of the contrast the area pi a b: this gives s.
    const double quarter_area = pixels / (4 * std::numbers::pi);
    const double sum = axes.major + axes.minor;
    const double rest = axes.major * axes.minor - quarter_area * quarter_area;
    blurs.push_back((sum - std::sqrt(std::max(0.0, sum * sum - 4 * rest))) / 2);
  }
  if (areas.size() < kFewest) return;
  blur_ = std::sqrt(std::max(kLeastBlur * kLeastBlur, medianOf(blurs)));
  std::vector<double> copy = areas;
  area_ = medianOf(copy);
  for (double& area : areas) area = std::abs(area / area_ - 1);
  const double deviation = medianOf(areas);
  alike_ = deviation < kAlike;
  equal_ = deviation < kEqual;
  // The standard deviation of lengths is half that of areas.
  spread_ = std::max(kLeastSpread, kNormal * deviation / 2);
  for (const Blob& blob : blobs) {
    if (!isClean(blob)) continue;
    const double unit = std::sqrt(std::abs(determinant(blob.at.per_pixel)));
    const BlobAxes axes = axesOf(*blob.moments).sharpened(blur_);
    longs.push_back(2 * std::sqrt(axes.major) * unit);
    shorts.push_back(2 * std::sqrt(axes.minor) * unit);
  }
  long_ = medianOf(longs);
  short_ = medianOf(shorts);
}

bool BlobPopulation::isHollow(const Blob& blob) const {
  if (!blob.moments) return false;
  const BlobAxes axes = axesOf(*blob.moments).sharpened(blur_);
  return blob.region.pixels < kHollow * 4 * std::numbers::pi * std::sqrt(axes.major * axes.minor);
}

int BlobPopulation::countIn(const Blob& blob) const {
  const double area = blob.size();
  const bool large = blob.diameter > settings_.largest;
  if (!large && !(alike_ && blob.moments)) return 1;
  if (!large) {
    // A single one fills the ellipse with its second moments.
    const BlobAxes axes = axesOf(*blob.moments).sharpened(blur_);
    const double ellipse = 4 * std::numbers::pi * std::sqrt(axes.major * axes.minor);
    if (blob.region.pixels > kFilled * ellipse) return 1;
  }
  const double one =
      area_ > 0 ? area_ : std::numbers::pi / 4 * settings_.largest * settings_.largest;
  return std::max(large ? 2 : 1, static_cast<int>(std::lround(area / one)));
}

bool BlobPopulation::isHidden(double area) const { return equal_ && area < kHidden * area_; }

}  // namespace lab::detector
