/// What `lab track` says of a film at its end, and of the calibration that it was read with.
#pragma once

#include <cstdint>

#include "common/calibration/camera_file.hpp"
#include "tracker_svc/calibration/spacing_check.hpp"
#include "tracker_svc/film_tracking.hpp"

namespace lab::runner {

/// Prints one line of what was found, and notes of what was left out.
/// @param seconds that it took
void printFilmSummary(const tracker::FilmSummary& film, const CameraCalibration& calibration,
                      std::int64_t dropped, double seconds);

/// What the poses themselves say against the calibration.
class CalibrationVerdict {
 public:
  explicit CalibrationVerdict(const CameraCalibration& calibration);

  void add(const tracker::FilmRow& row);

  /// Prints a line for each doubt.
  void tell(const tracker::FilmSummary& film) const;

 private:
  const CameraCalibration& calibration_;
  calibration::SpacingCheck spacing_;
  std::int64_t beyond_ = 0;  ///< poses with the axis farther beyond a wall than a robot's radius
  double farthest_ = 0;      ///< [m] behind the wall
};

}  // namespace lab::runner
