#include "tests/benchmarks/marker_baselines.hpp"

#include <apriltag/apriltag.h>
#include <apriltag/common/zarray.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#ifdef LAB_HAS_OPENCV
#include <opencv2/features2d.hpp>
#endif

#include "light/optics/tag_pattern.hpp"
#include "tracker_svc/plane_pose.hpp"

namespace lab::cases {
namespace {

constexpr double kHalf = 0.5;  // [px] libapriltag counts from the corner of the first pixel

std::vector<detector::Detection> findTags(const MarkerKind& kind, const optics::GreyView& picture) {
  const optics::CameraModel camera = cameraOf(kind.settings);
  const optics::TagFamily family(kind.settings.family);
  apriltag_detector_t* detector = apriltag_detector_create();
  apriltag_detector_add_family_bits(detector, family.get(), 1);
  detector->nthreads = 1;
  detector->quad_decimate = 1;
  image_u8_t image = {.width = picture.width,
                      .height = picture.height,
                      .stride = static_cast<std::int32_t>(picture.stride),
                      .buf = const_cast<std::uint8_t*>(picture.data)};
  zarray_t* tags = apriltag_detector_detect(detector, &image);
  std::vector<detector::Detection> poses;
  for (int i = 0; i < zarray_size(tags); ++i) {
    apriltag_detection_t* tag = nullptr;
    zarray_get(tags, i, &tag);
    std::array<optics::Place, 4> corners;
    for (std::size_t k = 0; k < 4; ++k) {
      corners[k] = camera.toPlane({tag->p[k][0] - kHalf, tag->p[k][1] - kHalf}, kind.settings.plane)
                       .value_or(optics::Place{});
    }
    detector::Detection pose;
    for (const optics::Place& corner : corners) {
      pose.x += corner.x / 4;
      pose.y += corner.y / 4;
    }
    pose.theta = std::atan2(corners[1].y + corners[2].y - corners[0].y - corners[3].y,
                            corners[1].x + corners[2].x - corners[0].x - corners[3].x);
    pose.tag = tag->id;
    pose.quality = 1;
    poses.push_back(pose);
  }
  apriltag_detections_destroy(tags);
  apriltag_detector_destroy(detector);
  return poses;
}

#ifdef LAB_HAS_OPENCV
std::vector<detector::Detection> findBlobs(const MarkerKind& kind,
                                           const optics::GreyView& picture) {
  const optics::CameraModel camera = cameraOf(kind.settings);
  const optics::Place middle{kind.settings.arena_width / 2, kind.settings.arena_height / 2};
  const double scale =
      std::sqrt(std::abs(detector::determinant(camera.scaleAt(middle, kind.settings.plane))));
  const double area = std::numbers::pi * kind.long_axis * kind.short_axis * scale * scale;
  cv::SimpleBlobDetector::Params params;
  params.filterByArea = true;
  params.minArea = static_cast<float>(0.4 * area);
  params.maxArea = static_cast<float>(1.8 * area);
  params.filterByCircularity = false;
  params.filterByConvexity = false;
  params.filterByInertia = false;
  params.filterByColor = true;
  params.blobColor = kind.bright ? 255 : 0;
  params.minThreshold = 5;
  params.maxThreshold = 250;
  params.thresholdStep = 5;
  params.minDistBetweenBlobs = static_cast<float>(1.2 * kind.short_axis * scale);
  const cv::Mat grey(picture.height, picture.width, CV_8UC1,
                     const_cast<std::uint8_t*>(picture.data),
                     static_cast<std::size_t>(picture.stride));
  std::vector<cv::KeyPoint> points;
  cv::SimpleBlobDetector::create(params)->detect(grey, points);
  std::vector<detector::Detection> poses;
  for (const cv::KeyPoint& point : points) {
    const auto place = camera.toPlane(
        {static_cast<double>(point.pt.x), static_cast<double>(point.pt.y)}, kind.settings.plane);
    if (!place || place->x < 0 || place->y < 0 || place->x > kind.settings.arena_width ||
        place->y > kind.settings.arena_height) {
      continue;
    }
    detector::Detection pose;
    pose.x = place->x;
    pose.y = place->y;
    pose.quality = 1;
    pose.heading = detector::HeadingKind::kUnknown;
    poses.push_back(pose);
  }
  return poses;
}
#endif

}  // namespace

#ifdef LAB_HAS_OPENCV
bool hasBlobBaseline() { return true; }
#else
bool hasBlobBaseline() { return false; }
#endif

std::vector<detector::Detection> baseline(const MarkerKind& kind, const optics::GreyView& picture) {
  if (kind.tags) return findTags(kind, picture);
#ifdef LAB_HAS_OPENCV
  return findBlobs(kind, picture);
#else
  return {};
#endif
}

}  // namespace lab::cases
