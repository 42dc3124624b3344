#include "tests/benchmarks/tracker_cases_opencv.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace lab::cases {
namespace {

constexpr double kBlock = 0.026;       // [m] window of the adaptive threshold
constexpr double kBelow = 8;           // [DN] below the mean
constexpr double kTolerance = 0.0025;  // [m] of the spacing
constexpr double kLeastShare = 0.6;    // [1] of the small circle's radius
constexpr double kMostShare = 1.5;     // [1] of the big circle's radius
constexpr double kLeastCircularity = 0.7;

struct Disc {
  optics::Place place;
  double radius = 0;  // [m]
};

double scaleOf(const optics::CameraModel& camera, const optics::CapGeometry& cap) {
  const auto& p = camera.parameters();
  const auto middle = camera.toPlane({p.width / 2.0, p.height / 2.0}, cap.height);
  if (!middle) return 1;
  const optics::PlaneScale s = camera.scaleAt(*middle, cap.height);
  return std::sqrt(std::abs(s.ux * s.vy - s.uy * s.vx));
}

void addDisc(std::vector<Disc>& discs, const optics::CameraModel& camera,
             const optics::CapGeometry& cap, double x, double y, double radius) {
  const auto place = camera.toPlane({x, y}, cap.height);
  if (!place) return;
  const optics::PlaneScale s = camera.scaleAt(*place, cap.height);
  discs.push_back({*place, radius / std::sqrt(std::abs(s.ux * s.vy - s.uy * s.vx))});
}

std::vector<Disc> byContours(const cv::Mat& grey, const optics::CameraModel& camera,
                             const optics::CapGeometry& cap) {
  const double scale = scaleOf(camera, cap);
  cv::Mat dark;
  cv::adaptiveThreshold(grey, dark, 255, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY_INV,
                        static_cast<int>(kBlock * scale / 2) * 2 + 1, kBelow);
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(dark, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  const double least = kLeastShare * cap.small_radius * scale;
  const double most = kMostShare * cap.big_radius * scale;
  std::vector<Disc> discs;
  for (const auto& contour : contours) {
    const cv::Moments moments = cv::moments(contour);
    // The contour passes through the centres of the outermost pixels, so half a pixel is added.
    const double radius = std::sqrt(moments.m00 / std::numbers::pi) + 0.5;
    if (!(moments.m00 > 0) || radius < least || radius > most) continue;
    const double length = cv::arcLength(contour, true);
    if (4 * std::numbers::pi * moments.m00 < kLeastCircularity * length * length) continue;
    addDisc(discs, camera, cap, moments.m10 / moments.m00, moments.m01 / moments.m00, radius);
  }
  return discs;
}

std::vector<Disc> byBlobs(const cv::Mat& grey, const optics::CameraModel& camera,
                          const optics::CapGeometry& cap) {
  const double scale = scaleOf(camera, cap);
  cv::SimpleBlobDetector::Params params;
  params.filterByArea = true;
  params.minArea =
      static_cast<float>(std::numbers::pi * std::pow(kLeastShare * cap.small_radius * scale, 2));
  params.maxArea =
      static_cast<float>(std::numbers::pi * std::pow(kMostShare * cap.big_radius * scale, 2));
  params.filterByCircularity = true;
  params.minCircularity = static_cast<float>(kLeastCircularity);
  params.minDistBetweenBlobs = static_cast<float>(0.02 * scale);
  std::vector<cv::KeyPoint> points;
  cv::SimpleBlobDetector::create(params)->detect(grey, points);
  std::vector<Disc> discs;
  for (const cv::KeyPoint& point : points) {
    addDisc(discs, camera, cap, static_cast<double>(point.pt.x), static_cast<double>(point.pt.y),
            static_cast<double>(point.size) / 2);
  }
  return discs;
}

}  // namespace

std::vector<detector::Detection> findPlainly(Plain kind, const optics::GreyView& picture,
                                             const optics::CameraModel& camera,
                                             const optics::CapGeometry& cap) {
  const cv::Mat grey(picture.height, picture.width, CV_8UC1,
                     const_cast<std::uint8_t*>(picture.data),
                     static_cast<std::size_t>(picture.stride));
  const std::vector<Disc> discs =
      kind == Plain::kAdaptive ? byContours(grey, camera, cap) : byBlobs(grey, camera, cap);
  struct Pair {
    double off;
    std::size_t big;
    std::size_t small;
  };
  const double between = std::sqrt(cap.big_radius * cap.small_radius) / cap.small_radius;
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < discs.size(); ++i) {
    for (std::size_t j = 0; j < discs.size(); ++j) {
      if (discs[i].radius < discs[j].radius * between) continue;
      const double off = std::abs(
          std::hypot(discs[i].place.x - discs[j].place.x, discs[i].place.y - discs[j].place.y) -
          cap.spacing());
      if (off < kTolerance) pairs.push_back({off, i, j});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.off < b.off; });
  std::vector<bool> taken(discs.size(), false);
  std::vector<detector::Detection> poses;
  for (const Pair& pair : pairs) {
    if (taken[pair.big] || taken[pair.small]) continue;
    taken[pair.big] = taken[pair.small] = true;
    const optics::Place& big = discs[pair.big].place;
    const optics::Place& small = discs[pair.small].place;
    detector::Detection pose;
    pose.x = (big.x + small.x) / 2;
    pose.y = (big.y + small.y) / 2;
    pose.theta = std::atan2(big.y - small.y, big.x - small.x);
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace lab::cases
