/// Detection of tags: libapriltag finds and decodes them, fitTag() measures their poses.
#include <apriltag/apriltag.h>
#include <apriltag/common/zarray.h>

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

#include "light/optics/tag_pattern.hpp"
#include "light/photometry/camera_response.hpp"
#include "tracker_svc/marker_detector.hpp"
#include "tracker_svc/plane_pose.hpp"
#include "tracker_svc/tags/tag_fit.hpp"

namespace lab::detector {
namespace {

constexpr double kCornerError = 0.3;  // [px] of libapriltag's corners
constexpr double kMisfit = 0.2;       // [1] largest misfit besides noise
constexpr float kPoor = 0.4F;         // [1] quality of a pose without a fit: not analysed
constexpr double kCoarse = 60;        // [px] side of tags that are searched at half resolution
constexpr double kLoose = 5;          // [1] standard deviations of noise, least contrast of edges
constexpr double kLeastEdge = 8;      // [DN]
constexpr double kMostEdge = 20;      // [DN]

struct ReleaseDetector {
  void operator()(apriltag_detector_t* detector) const { apriltag_detector_destroy(detector); }
};
struct ReleaseDetections {
  void operator()(zarray_t* detections) const { apriltag_detections_destroy(detections); }
};

class TagDetector final : public MarkerDetector {
 public:
  TagDetector(const optics::CameraModel& camera, const optics::Imaging& imaging,
              const TagSettings& settings)
      : camera_(camera),
        imaging_(imaging),
        settings_(settings),
        response_(imaging),
        family_(settings.family),
        detector_(apriltag_detector_create()) {
    // More corrected bits would need gigabytes for large families and find tags in noise.
    constexpr int kCorrectedBits = 1;
    apriltag_detector_add_family_bits(detector_.get(), family_.get(), kCorrectedBits);
    detector_->nthreads = 1;
    const optics::CameraParameters& p = camera_.parameters();
    double side = 0;
    if (const auto at = camera_.toPlane({p.width / 2.0, p.height / 2.0}, settings.height)) {
      side =
          settings.size * std::sqrt(std::abs(determinant(camera_.scaleAt(*at, settings.height))));
    }
    detector_->quad_decimate = side > kCoarse ? 2.0F : 1.0F;
    const double noise =
        std::sqrt(imaging.read_noise * imaging.read_noise + imaging.shot_gain * kMostEdge);
    detector_->qtp.min_white_black_diff =
        static_cast<int>(std::clamp(kLoose * noise, kLeastEdge, kMostEdge));
  }

  const std::vector<Detection>& search(const optics::GreyView& grey,
                                       std::vector<Rejection>* rejected,
                                       std::span<const Expected> /*expected*/) override {
    found_.clear();
    if (rejected != nullptr) rejected->clear();
    if (!canRead(grey)) return found_;
    const optics::GreyView picture = response_.linear(grey);
    look(picture, 0, 0, picture.width - 1, picture.height - 1, rejected);
    return found_;
  }

  const std::vector<Detection>& follow(const optics::GreyView& grey,
                                       std::span<const Expected> expected) override {
    followed_.assign(expected.size(), Detection{});
    found_.clear();
    if (!canRead(grey)) return followed_;
    const optics::GreyView picture = response_.linear(grey);
    const double margin = family_.pattern(0).cells / (2 * family_.pattern(0).half_square);
    for (const Expected& place : expected) {
      optics::PlaneScale scale;
      const optics::Pixel at = camera_.project(place.x, place.y, settings_.height, scale);
      const double reach =
          settings_.size / std::numbers::sqrt2 * margin + std::max(0.0, place.reach);
      const double across = reach * std::hypot(scale.ux, scale.uy) + 2;
      const double along = reach * std::hypot(scale.vx, scale.vy) + 2;
      if (!picture.contains(at.x, at.y, -across - along)) continue;
      const int left = std::max(0, static_cast<int>(at.x - across));
      const int top = std::max(0, static_cast<int>(at.y - along));
      const int right = std::min(picture.width - 1, static_cast<int>(at.x + across));
      const int bottom = std::min(picture.height - 1, static_cast<int>(at.y + along));
      if (right - left > kLeastSide && bottom - top > kLeastSide) {
        look(picture, left, top, right, bottom, nullptr);
      }
    }
    for (std::size_t i = 0; i < expected.size(); ++i) {
      double least = expected[i].reach;
      Detection* nearest = nullptr;
      for (Detection& one : found_) {
        const double distance = std::hypot(one.x - expected[i].x, one.y - expected[i].y);
        if (one.quality <= 0 || distance > least) continue;
        least = distance;
        nearest = &one;
      }
      if (nearest == nullptr) continue;
      followed_[i] = *nearest;
      nearest->quality = 0;
    }
    return followed_;
  }

  void setCompressed(bool compressed) override { imaging_.compressed = compressed; }

  void setGamma(double gamma) override {
    imaging_.gamma = gamma;
    response_ = optics::CameraResponse(imaging_);
  }

  [[nodiscard]] const optics::CameraModel& camera() const override { return camera_; }

 private:
  static constexpr int kLeastSide = 16;  // [px] of a part that libapriltag can search

  [[nodiscard]] bool canRead(const optics::GreyView& picture) const {
    const optics::CameraParameters& p = camera_.parameters();
    return picture.data != nullptr && picture.width == p.width && picture.height == p.height;
  }

  /// Adds the tags of a part of the picture, except those already found.
  void look(const optics::GreyView& picture, int left, int top, int right, int bottom,
            std::vector<Rejection>* rejected) {
    // libapriltag reads the pixels only.
    image_u8_t image = {.width = right - left + 1,
                        .height = bottom - top + 1,
                        .stride = static_cast<std::int32_t>(picture.stride),
                        .buf = const_cast<std::uint8_t*>(picture.row(top)) + left};
    const std::unique_ptr<zarray_t, ReleaseDetections> tags(
        apriltag_detector_detect(detector_.get(), &image));
    for (int i = 0; i < zarray_size(tags.get()); ++i) {
      apriltag_detection_t* tag = nullptr;
      zarray_get(tags.get(), i, &tag);
      for (double(&corner)[2] : tag->p) {
        corner[0] += left;
        corner[1] += top;
      }
      add(picture, *tag, rejected);
    }
  }

  void add(const optics::GreyView& picture, const apriltag_detection_t& tag,
           std::vector<Rejection>* rejected) {
    const std::optional<Detection> measured = measure(picture, tag, rejected);
    if (!measured) return;
    for (Detection& other : found_) {
      if (other.tag != measured->tag) continue;
      // One tag twice: in overlapping parts of the picture, or there are two with one number.
      const bool better = measured->quality > other.quality;
      const Detection& worse = better ? other : *measured;
      if (rejected != nullptr) {
        rejected->push_back({worse.middle, Reason::kTaken, worse.quality, 0});
      }
      if (better) other = *measured;
      return;
    }
    found_.push_back(*measured);
  }

  [[nodiscard]] std::optional<Detection> measure(const optics::GreyView& picture,
                                                 const apriltag_detection_t& tag,
                                                 std::vector<Rejection>* rejected) const {
    // Corners of the upright tag: bottom left, bottom right, top right, top left.
    std::array<optics::Place, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) {
      // libapriltag counts from the corner of the first pixel.
      const auto place =
          camera_.toPlane({tag.p[i][0] - kHalf, tag.p[i][1] - kHalf}, settings_.height);
      if (!place) return {};
      corners[i] = *place;
    }
    TagPose start;
    for (const optics::Place& corner : corners) {
      start.x += corner.x / 4;
      start.y += corner.y / 4;
    }
    const double right = corners[1].x + corners[2].x - corners[0].x - corners[3].x;
    const double up = corners[1].y + corners[2].y - corners[0].y - corners[3].y;
    start.theta = std::atan2(up, right);
    start.size = settings_.size;
    const std::optional<TagPose> fit =
        fitTag(picture, camera_, imaging_, family_.pattern(tag.id), settings_.height, start);
    Detection one;
    one.tag = tag.id;
    one.used = kUsedTag;
    const optics::PlaneScale scale = camera_.scaleAt({start.x, start.y}, settings_.height);
    const double error = kCornerError * kCornerError / std::abs(determinant(scale));
    if (fit && fit->misfit < kMisfit + noiseShare(*fit)) {
      one.x = fit->x;
      one.y = fit->y;
      one.theta = fit->theta;
      one.covariance = fit->covariance;
      one.length = one.width = static_cast<float>(fit->size);
      one.white = static_cast<float>(fit->white);
      one.ratio = static_cast<float>(1 - fit->contrast);
      one.blur = static_cast<float>(fit->blur);
      one.quality = static_cast<float>(
          std::clamp(0.99 - 0.1 * (std::sqrt(fit->chi2) - 1) - 0.2 * tag.hamming, 0.5, 0.99));
    } else {
      // The pose of the corners alone.
      if (rejected != nullptr) {
        rejected->push_back({{tag.c[0], tag.c[1]},
                             Reason::kPattern,
                             fit ? static_cast<float>(fit->misfit) : 1.0F,
                             static_cast<float>(kMisfit)});
      }
      one.x = start.x;
      one.y = start.y;
      one.theta = start.theta;
      one.covariance = {error, 0, 0, error, 0, error * 4 / (settings_.size * settings_.size)};
      one.quality = kPoor;
    }
    one.middle = camera_.project(one.x, one.y, settings_.height);
    return one;
  }

  /// [1] noise of a white pixel over the contrast of the tag.
  [[nodiscard]] double noiseShare(const TagPose& fit) const {
    return std::sqrt(imaging_.read_noise * imaging_.read_noise + imaging_.shot_gain * fit.white) /
           (fit.white * fit.contrast);
  }

  static constexpr double kHalf = 0.5;  // [px]

  optics::CameraModel camera_;
  optics::Imaging imaging_;
  TagSettings settings_;
  optics::CameraResponse response_;
  optics::TagFamily family_;
  std::unique_ptr<apriltag_detector_t, ReleaseDetector> detector_;
  std::vector<Detection> found_;
  std::vector<Detection> followed_;
};

}  // namespace

std::unique_ptr<MarkerDetector> makeTagDetector(const optics::CameraModel& camera,
                                                const optics::Imaging& imaging,
                                                const TagSettings& settings) {
  return std::make_unique<TagDetector>(camera, imaging, settings);
}

}  // namespace lab::detector
