#include "runner/calibrate/cap_collector.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "light/median.hpp"

namespace lab::runner {
namespace {

constexpr double kHeights[] = {1.0, 1.4, 2.0, 3.0};  // [longer side of the arena]
constexpr double kDistortions[] = {-0.3, -0.24, -0.18, -0.12, -0.06, 0, 0.06};

constexpr std::size_t kMostCaps = 3000;
constexpr double kCellSize = 0.01;  // [m]
constexpr int kHeadings = 12;
constexpr std::size_t kFewestBlurs = 20;
constexpr double kLeastCapSigma = 0.003;  // [px]
constexpr double kMostSigma = 0.3;        // [px]

struct Found {
  std::size_t caps = 0;
  double spread = 0;  // [m^2] variance of the spacings
};

Found findWith(const optics::CameraParameters& camera, const optics::CapGeometry& cap,
               const std::vector<optics::GreyImage>& pictures, const optics::Imaging& imaging) {
  detector::Detector detector(optics::CameraModel(camera), cap, imaging);
  Found found;
  double sum = 0;
  double squares = 0;
  for (const optics::GreyImage& picture : pictures) {
    for (const detector::Detection& one : detector.search(picture.view())) {
      if (one.spacing <= 0) continue;
      ++found.caps;
      const double off = static_cast<double>(one.spacing) - cap.spacing();
      sum += off;
      squares += off * off;
    }
  }
  if (found.caps > 0) {
    const auto count = static_cast<double>(found.caps);
    found.spread = squares / count - sum * sum / (count * count);
  }
  return found;
}

}  // namespace

RoughCamera roughCamera(const calibration::CameraObservations& observations,
                        const std::vector<optics::GreyImage>& pictures,
                        const optics::Imaging& imaging) {
  RoughCamera best;
  Found best_found;
  const double side = std::max(observations.arena_width, observations.arena_height);
  std::vector<double> heights;
  for (const double height : kHeights) heights.push_back(height * side);
  if (observations.camera_height) heights = {*observations.camera_height};
  for (const double height : heights) {
    for (const double k1 : kDistortions) {
      const optics::CameraParameters camera =
          calibration::guessFromCorners(observations, height, k1);
      const Found found = findWith(camera, observations.cap, pictures, imaging);
      if (found.caps < best_found.caps || found.caps == 0) continue;
      if (found.caps == best_found.caps && found.spread >= best_found.spread) continue;
      best = {camera, found.caps};
      best_found = found;
    }
  }
  return best;
}

CapCollector::CapCollector(const optics::CameraParameters& camera, const optics::CapGeometry& cap,
                           const optics::Imaging& imaging)
    : detector_(optics::CameraModel(camera), cap, imaging) {}

std::optional<double> CapCollector::blur() const {
  if (blurs_.size() < kFewestBlurs) return std::nullopt;
  std::vector<float> sorted = blurs_;
  return static_cast<double>(medianOf(sorted));
}

void CapCollector::take(const optics::GreyView& picture) {
  for (const detector::Detection& one : detector_.search(picture)) {
    if (caps_.size() >= kMostCaps) return;
    if (one.used != (detector::kUsedBig | detector::kUsedSmall))
      continue;  // circles at the edge of a light are not used
    const auto cell = [](double value, double width) {
      return static_cast<std::int64_t>(std::floor(value / width));
    };
    const std::int64_t key = (cell(one.x, kCellSize) * 4096 + cell(one.y, kCellSize)) * kHeadings +
                             cell(one.theta + std::numbers::pi, 2 * std::numbers::pi / kHeadings);
    if (!taken_.insert(key).second) continue;
    // The position is the mean of two circles, so its variance is half of that of a circle.
    const optics::PlaneScale scale =
        detector_.camera().scaleAt({one.x, one.y}, detector_.cap().height);
    const double per_metre = std::sqrt(std::abs(scale.ux * scale.vy - scale.uy * scale.vx));
    const double sigma = per_metre * std::sqrt(one.covariance[0] + one.covariance[3]);
    caps_.push_back({one.big, one.small, std::clamp(sigma, kLeastCapSigma, kMostSigma)});
    blurs_.push_back(one.blur);
  }
}

}  // namespace lab::runner
