/// Summary of `lab track` about a film and its calibration.
#pragma once

#include <cstdint>

#include "common/calibration/camera_file.hpp"
#include "tracker_svc/calibration/spacing_check.hpp"
#include "tracker_svc/film_tracking.hpp"
#include "tracker_svc/marker_detector.hpp"

namespace lab::runner {

/// Prints one line about the poses that were found, and notes about those that were left out.
/// @param seconds processing time
void printFilmSummary(const tracker::FilmSummary& film, const CameraCalibration& calibration,
                      const detector::MarkerSettings& markers, std::int64_t dropped,
                      double seconds);

/// Checks the calibration with the detected poses: the spacing of the two circles of a cap, and
/// poses outside the arena.
class CalibrationVerdict {
 public:
  explicit CalibrationVerdict(const CameraCalibration& calibration);

  void add(const tracker::FilmRow& row);

  /// Prints one warning per problem.
  void print(const tracker::FilmSummary& film) const;

 private:
  const CameraCalibration& calibration_;
  calibration::SpacingCheck spacing_;
  std::int64_t outside_ =
      0;                 ///< poses whose centre is farther outside the arena than a robot's radius
  double farthest_ = 0;  ///< [m] largest distance outside the arena
};

}  // namespace lab::runner
