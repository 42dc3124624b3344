#include "tracker_svc/cap_spacings.hpp"

#include <algorithm>
#include <cmath>

#include "light/optics/camera_model.hpp"

namespace lab::tracker {
namespace {

// [m] smallest standard error of a spacing: avoids a division by zero
constexpr double kLeastSigma = 1e-6;

}  // namespace

calibration::SpacingSettings spacingSettings(const CameraCalibration& calibration) {
  calibration::SpacingSettings settings;
  settings.spacing = calibration.cap.spacing();
  settings.arena_width = calibration.arena_width;
  settings.arena_height = calibration.arena_height;
  settings.camera_height =
      optics::CameraModel(calibration.camera).centre()[2] - calibration.cap.height;
  return settings;
}

bool addSpacing(calibration::SpacingCheck& check, double time, const detector::Detection& cap,
                double spacing) {
  if (cap.spacing <= 0 || (cap.used & detector::kUsedEdge) != 0) return false;
  const double turn = std::sqrt(std::max(0.0, cap.covariance[5]));
  check.add(time, cap.x, cap.y, static_cast<double>(cap.spacing),
            std::max(turn * spacing, kLeastSigma));
  return true;
}

}  // namespace lab::tracker
