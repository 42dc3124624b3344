/// Detection of blobs: ground, regions, moments, and the splitting of groups.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "light/photometry/camera_response.hpp"
#include "tracker_svc/blobs/blob_areas.hpp"
#include "tracker_svc/blobs/blob_ground.hpp"
#include "tracker_svc/blobs/blob_groups.hpp"
#include "tracker_svc/blobs/blob_moments.hpp"
#include "tracker_svc/blobs/blob_population.hpp"
#include "tracker_svc/blobs/blob_split.hpp"
#include "tracker_svc/blobs/pixel_regions.hpp"
#include "tracker_svc/marker_detector.hpp"
#include "tracker_svc/plane_pose.hpp"

namespace lab::detector {
namespace {

constexpr double kHalf = 0.5;             // [1] of a blob's contrast: the level of its outline
constexpr double kInside = 0.8;           // quantile of the contrasts of a region, inside the blob
constexpr double kSmallest = 0.6;         // [1] of the smallest area: regions to look at
constexpr int kRing = 4;                  // [px] of ground around a blob
constexpr double kEdgeBlurs = 3;          // [1] blurs, half the width of a blurred edge
constexpr double kCloseBlurs = 2;         // [1] half the gap in which edges mix
constexpr int kWidestEdge = 14;           // [px]
constexpr double kHugeGroup = 60;         // [1] areas of the largest blob: not looked at
constexpr double kMisfit = 0.15;          // [1] largest misfit of a split
constexpr double kGoodMisfit = 0.05;      // [1] with which the number is not doubted
constexpr double kClearlyBetter = 0.7;    // [1] of the misfit, with another number
constexpr double kMisfitSeparate = 0.25;  // [1] the same, if the number of blobs is certain
constexpr int kMostParts = 12;            // of one group
constexpr double kTruncated = 0.1;        // [px] error of a centre whose edge ends at a neighbour
constexpr double kLong = 1.2;             // [1] length over width of a blob with an axis
constexpr double kKnownAxis = 0.2;        // [rad] largest error of an axis
constexpr float kPoor = 0.4F;             // [1] quality of a biased centre: not analysed
constexpr float kMergedQuality = 0.3F;

double blurOf(const optics::Imaging& imaging) {
  return std::sqrt(imaging.blur * imaging.blur + optics::kPixelBox);
}

int blockOf(const optics::CameraModel& camera, const BlobSettings& settings) {
  constexpr int kSmallestBlock = 24;
  constexpr int kLargestBlock = 128;
  const optics::CameraParameters& p = camera.parameters();
  const auto middle = camera.toPlane({p.width / 2.0, p.height / 2.0}, settings.height);
  if (!middle) return kLargestBlock;
  const double scale = std::sqrt(std::abs(determinant(camera.scaleAt(*middle, settings.height))));
  return static_cast<int>(std::clamp(1.5 * settings.largest * scale,
                                     static_cast<double>(kSmallestBlock),
                                     static_cast<double>(kLargestBlock)));
}

class BlobDetector final : public MarkerDetector {
 public:
  BlobDetector(const optics::CameraModel& camera, const optics::Imaging& imaging,
               const BlobSettings& settings)
      : camera_(camera),
        settings_(settings),
        response_(imaging),
        ground_(imaging,
                columnsOf(camera, settings.arena_width, settings.arena_height, settings.height),
                blockOf(camera, settings)),
        population_(settings, blurOf(imaging)) {}

  const std::vector<Detection>& search(const optics::GreyView& picture,
                                       std::vector<Rejection>* rejected,
                                       std::span<const Expected> expected) override;

  const std::vector<Detection>& follow(const optics::GreyView& picture,
                                       std::span<const Expected> expected) override;

  void setCompressed(bool compressed) override { ground_.setCompressed(compressed); }

  void setGamma(double gamma) override {
    optics::Imaging imaging = ground_.imaging();
    imaging.gamma = gamma;
    response_ = optics::CameraResponse(imaging);
  }

  [[nodiscard]] const optics::CameraModel& camera() const override { return camera_; }

 private:
  void findBlobs(const optics::GreyView& picture);
  void addBlobs(const PixelRegion& region);
  void measure(const optics::GreyView& picture);
  [[nodiscard]] int edge() const {
    return std::min(kWidestEdge, static_cast<int>(std::ceil(kEdgeBlurs * population_.blur())) + 1);
  }
  [[nodiscard]] bool leavesColumns(const PixelRegion& region) const;
  void addGroup(const optics::GreyView& picture, const std::vector<std::size_t>& group);
  void addSingle(const Blob& blob, bool alone);
  void addMerged(const Blob& blob, int count);
  [[nodiscard]] bool addSplit(const optics::GreyView& picture,
                              const std::vector<std::size_t>& group, int count);
  void refuse(const Blob& blob, Reason reason, double value, double limit);

  optics::CameraModel camera_;
  BlobSettings settings_;
  optics::CameraResponse response_;
  BlobGround ground_;
  RegionFinder finder_;
  BlobAreas areas_;
  std::vector<Blob> blobs_;
  std::vector<Detection> found_;
  std::vector<Detection> followed_;
  std::vector<Rejection>* rejected_ = nullptr;
  BlobPopulation population_;
};

const std::vector<Detection>& BlobDetector::search(const optics::GreyView& grey,
                                                   std::vector<Rejection>* rejected,
                                                   std::span<const Expected> /*expected*/) {
  found_.clear();
  rejected_ = rejected;
  if (rejected != nullptr) rejected->clear();
  const optics::CameraParameters& p = camera_.parameters();
  if (grey.data == nullptr || grey.width != p.width || grey.height != p.height) return found_;
  const optics::GreyView picture = response_.linear(grey);
  ground_.estimate(picture, settings_.bright);
  findBlobs(picture);
  const int before = edge();
  measure(picture);
  population_.learn(blobs_);
  if (edge() != before) {
    measure(picture);
    population_.learn(blobs_);
  }
  std::vector<std::vector<int>> neighbours;
  for (const Blob& blob : blobs_) neighbours.push_back(blob.area.neighbours);
  for (const std::vector<std::size_t>& group : groupsOf(neighbours)) addGroup(picture, group);
  return found_;
}

const std::vector<Detection>& BlobDetector::follow(const optics::GreyView& picture,
                                                   std::span<const Expected> expected) {
  search(picture, nullptr, expected);
  followed_.assign(expected.size(), Detection{});
  std::vector<bool> given(found_.size(), false);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    double least = expected[i].reach;
    std::size_t nearest = found_.size();
    for (std::size_t j = 0; j < found_.size(); ++j) {
      const double distance = std::hypot(found_[j].x - expected[i].x, found_[j].y - expected[i].y);
      if (given[j] || distance > least) continue;
      least = distance;
      nearest = j;
    }
    if (nearest == found_.size()) continue;
    given[nearest] = true;
    followed_[i] = found_[nearest];
  }
  return followed_;
}

void BlobDetector::findBlobs(const optics::GreyView& picture) {
  std::array<float, 257> thresholds{};
  for (std::size_t grey = 0; grey < thresholds.size(); ++grey) {
    thresholds[grey] = ground_.threshold(static_cast<float>(grey));
  }
  finder_.begin();
  for (int y = 0; y < picture.height; ++y) {
    const ColumnSpan& span = ground_.columns()[static_cast<std::size_t>(y)];
    const float* ground = ground_.row(y);
    const float* out = ground_.contrast(y);
    const auto stands = [&](int x) {
      const auto grey = static_cast<std::size_t>(std::clamp(ground[x], 0.0F, 256.0F));
      return out[x] > 2 && out[x] > thresholds[grey];
    };
    for (int x = span.first; x <= span.last; ++x) {
      if (!stands(x)) continue;
      const int first = x;
      while (x < span.last && stands(x + 1)) ++x;
      finder_.add({y, first, x});
    }
  }
  blobs_.clear();
  for (const PixelRegion& region : finder_.regions()) addBlobs(region);
}

/// Outlines the blobs of a region at half of its contrast.
void BlobDetector::addBlobs(const PixelRegion& region) {
  const optics::Pixel middle{(region.x0 + region.x1) / 2.0, (region.y0 + region.y1) / 2.0};
  const std::optional<PlanePoint> at = planePoint(camera_, middle, settings_.height);
  if (!at) return;
  const double unit = std::abs(determinant(at->per_pixel));
  const double quarter = std::numbers::pi / 4;
  const double smallest = quarter * settings_.smallest * settings_.smallest;
  const double largest = quarter * settings_.largest * settings_.largest;
  if (region.pixels * unit < kSmallest * smallest) return;
  if (region.pixels * unit > kHugeGroup * largest) {
    if (rejected_ != nullptr) {
      rejected_->push_back({middle, Reason::kSize,
                            static_cast<float>(std::sqrt(region.pixels * unit / largest)), 1});
    }
    return;
  }
  std::vector<float> contrasts;
  for (const PixelRun& run : region.runs) {
    const float* out = ground_.contrast(run.y);
    contrasts.insert(contrasts.end(), out + run.first, out + run.last + 1);
  }
  const auto inside = contrasts.begin() +
                      static_cast<std::ptrdiff_t>(kInside * static_cast<double>(contrasts.size()));
  std::nth_element(contrasts.begin(), inside, contrasts.end());
  const float level = static_cast<float>(kHalf) * *inside;
  RegionFinder finder;
  for (const PixelRun& run : region.runs) {
    const float* out = ground_.contrast(run.y);
    for (int x = run.first; x <= run.last; ++x) {
      if (out[x] <= level) continue;
      const int first = x;
      while (x < run.last && out[x + 1] > level) ++x;
      finder.add({run.y, first, x});
    }
  }
  for (PixelRegion& part : finder.regions()) {
    if (part.pixels * unit < kSmallest * smallest) continue;
    const optics::Pixel centre{(part.x0 + part.x1) / 2.0, (part.y0 + part.y1) / 2.0};
    const std::optional<PlanePoint> place = planePoint(camera_, centre, settings_.height);
    if (!place) continue;
    const double area = part.pixels * std::abs(determinant(place->per_pixel));
    blobs_.push_back({std::move(part), {}, {}, *place, std::sqrt(area / quarter)});
  }
}

void BlobDetector::measure(const optics::GreyView& picture) {
  std::vector<PixelRegion> regions;
  for (const Blob& blob : blobs_) regions.push_back(blob.region);
  std::vector<BlobArea> areas =
      areas_.grow(regions, picture.width, picture.height, edge(), kRing,
                  static_cast<int>(std::ceil(kCloseBlurs * population_.blur())));
  for (std::size_t i = 0; i < blobs_.size(); ++i) {
    blobs_[i].area = std::move(areas[i]);
    if (leavesColumns(blobs_[i].region)) blobs_[i].area.cut = true;
    blobs_[i].moments = blobMoments(picture, blobs_[i].area, edge(), ground_, settings_.bright);
  }
}

/// Whether a region touches the border of the arena.
bool BlobDetector::leavesColumns(const PixelRegion& region) const {
  const auto& columns = ground_.columns();
  const auto inside = [&](int y) {
    return y >= 0 && y < static_cast<int>(columns.size()) &&
           columns[static_cast<std::size_t>(y)].last >= columns[static_cast<std::size_t>(y)].first;
  };
  if (!inside(region.y0 - 1) || !inside(region.y1 + 1)) return true;
  return std::any_of(region.runs.begin(), region.runs.end(), [&](const PixelRun& run) {
    const ColumnSpan& span = columns[static_cast<std::size_t>(run.y)];
    return run.first <= span.first + 1 || run.last >= span.last - 1;
  });
}

void BlobDetector::addGroup(const optics::GreyView& picture,
                            const std::vector<std::size_t>& group) {
  int count = 0;
  for (const std::size_t one : group) count += population_.countIn(blobs_[one]);
  if (group.size() == 1 && population_.isHollow(blobs_[group.front()])) {
    return refuse(blobs_[group.front()], Reason::kSize,
                  blobs_[group.front()].diameter / settings_.largest, 1);
  }
  if (count == 1 && group.size() == 1) return addSingle(blobs_[group.front()], true);
  if (population_.area() > 0 && count <= kMostParts && addSplit(picture, group, count)) return;
  for (const std::size_t one : group) {
    const Blob& blob = blobs_[one];
    const int inside = population_.countIn(blob);
    if (inside == 1) {
      addSingle(blob, false);
    } else if (group.size() == 1 || inside > kMostParts || population_.area() <= 0 ||
               !addSplit(picture, {one}, inside)) {
      addMerged(blob, inside);
    }
  }
}

void BlobDetector::addSingle(const Blob& blob, bool alone) {
  if (blob.diameter < settings_.smallest || !blob.moments) {
    return refuse(blob, Reason::kSize, blob.diameter / settings_.smallest, 1);
  }
  const BlobMoments& m = *blob.moments;
  BlobMoments known = m;
  if (!alone) {
    known.covariance[0] += kTruncated * kTruncated;
    known.covariance[2] += kTruncated * kTruncated;
  }
  const std::optional<Detection> pose =
      blobPose(camera_, settings_.height, known, population_.blur());
  if (!pose) return;
  Detection one = *pose;
  one.area = static_cast<float>(blob.size());
  if (static_cast<double>(one.length) < kLong * static_cast<double>(one.width) ||
      one.covariance[5] > kKnownAxis * kKnownAxis) {
    forgetHeading(one);
  }
  one.used = kUsedBlob;
  const double signal = m.contrast / m.noise;
  one.quality = static_cast<float>(std::max(0.5, 0.98 * signal / (signal + 2)));
  if (!alone) {
    one.used |= kUsedSplit;
    one.quality = std::min(one.quality, 0.6F);
  }
  const bool hidden = population_.isHidden(static_cast<double>(one.area));
  if (blob.area.cut || hidden) one.quality = kPoor;
  found_.push_back(one);
}

void BlobDetector::addMerged(const Blob& blob, int count) {
  refuse(blob, Reason::kMerged, count, 1);
  if (!blob.moments || count > kMostParts) return;
  const std::optional<Detection> pose =
      blobPose(camera_, settings_.height, *blob.moments, population_.blur());
  if (!pose) return;
  Detection one = *pose;
  forgetHeading(one);
  // The blobs are somewhere in it.
  const double spread = static_cast<double>(one.length * one.length) / 16;
  one.covariance[0] += spread;
  one.covariance[3] += spread;
  one.area = static_cast<float>(blob.size());
  one.used = kUsedBlob;
  one.quality = kMergedQuality;
  one.merged = static_cast<std::uint8_t>(count);
  found_.push_back(one);
}

bool BlobDetector::addSplit(const optics::GreyView& picture, const std::vector<std::size_t>& group,
                            int count) {
  std::vector<const BlobArea*> areas;
  std::vector<optics::Pixel> starts;
  for (const std::size_t one : group) {
    if (blobs_[one].area.cut) return false;
    areas.push_back(&blobs_[one].area);
    if (blobs_[one].moments) starts.push_back(blobs_[one].moments->centre);
  }
  const std::vector<ContrastPixel> pixels =
      contrastPixels(picture, areas, edge(), ground_, settings_.bright);
  const double unit = std::sqrt(std::abs(determinant(blobs_[group.front()].at.per_pixel)));
  const BlobShape shape = population_.shape(unit);
  const bool certain = static_cast<std::size_t>(count) == group.size();
  std::optional<BlobSplit> split = splitBlob(pixels, count, shape, starts);
  // Sizes differ, so the area may say one too many or too few.
  for (const int other : {count - 1, count + 1}) {
    if (certain || (split && split->misfit < kGoodMisfit) || other < 2) continue;
    const std::optional<BlobSplit> next = splitBlob(pixels, other, shape, starts);
    if (next && (!split || next->misfit < kClearlyBetter * split->misfit)) split = next;
  }
  if (!split || split->misfit > (certain ? kMisfitSeparate : kMisfit)) return false;
  const double quality = 0.5 + 0.4 * (1 - split->misfit / kMisfitSeparate);
  for (const BlobPart& part : split->parts) {
    std::optional<Detection> one =
        partPose(camera_, settings_.height, part.centre, part.angle, part.covariance);
    if (!one) continue;
    if (shape.isRound() || one->covariance[5] > kKnownAxis * kKnownAxis) {
      forgetHeading(*one);
    } else {
      one->heading = HeadingKind::kAxis;
    }
    one->area = static_cast<float>(population_.area());
    one->length = static_cast<float>(2 * shape.long_axis * unit);
    one->width = static_cast<float>(2 * shape.short_axis * unit);
    one->used = kUsedBlob | kUsedSplit;
    one->quality = static_cast<float>(quality);
    found_.push_back(*one);
  }
  return true;
}

void BlobDetector::refuse(const Blob& blob, Reason reason, double value, double limit) {
  if (rejected_ == nullptr) return;
  const PixelRegion& region = blob.region;
  rejected_->push_back({{(region.x0 + region.x1) / 2.0, (region.y0 + region.y1) / 2.0},
                        reason,
                        static_cast<float>(value),
                        static_cast<float>(limit)});
}

}  // namespace

std::unique_ptr<MarkerDetector> makeBlobDetector(const optics::CameraModel& camera,
                                                 const optics::Imaging& imaging,
                                                 const BlobSettings& settings) {
  return std::make_unique<BlobDetector>(camera, imaging, settings);
}

}  // namespace lab::detector
