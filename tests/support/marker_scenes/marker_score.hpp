/// Compares detections of blobs and tags with the ground truth.
#pragma once

#include <string>
#include <vector>

#include "tests/support/marker_scenes/marker_scene.hpp"
#include "tracker_svc/detection.hpp"
#include "tracker_svc/marker_detector.hpp"

namespace lab::cases {

/// Sums over pictures. Hidden markers count for the recall, and not for the errors.
struct MarkerScore {
  int pictures = 0;
  int markers = 0;
  int found = 0;         ///< with a quality of at least 0.5, or hidden and found at all
  int wrong = 0;         ///< detections of that quality without a marker
  int ids = 0;           ///< tags found with a wrong number
  int measured = 0;      ///< markers of the errors
  double position2 = 0;  ///< [px^2] sum of the squares of the errors, both axes
  int headings = 0;
  double heading2 = 0;  ///< [rad^2]
  double nees = 0;      ///< sum of e^T C^-1 e / n of position, or of position and heading
  double nees_x = 0;    ///< sum of e_x^2 / C_xx
  double nees_theta = 0;
  double seconds = 0;  ///< sum of the times of detection

  void add(const MarkerKind& kind, const std::vector<TrueMarker>& truth,
           const std::vector<detector::Detection>& poses, double time);

  [[nodiscard]] double recall() const { return markers > 0 ? 1.0 * found / markers : 1; }
  [[nodiscard]] double precision() const {
    return found + wrong > 0 ? 1.0 * found / (found + wrong) : 1;
  }
  [[nodiscard]] double positionRms() const;  ///< [px] 2-D
  [[nodiscard]] double headingRms_deg() const;

  [[nodiscard]] std::string text() const;
  [[nodiscard]] static std::string header();
};

/// Scores a detector on pictures of a kind, with the seeds 1, 2, ...
[[nodiscard]] MarkerScore scoreOf(MarkerKind kind, detector::MarkerDetector& detector,
                                  int pictures);

/// A mean of n squares of errors over their variances deviates from 1 by sqrt(2 / n).
[[nodiscard]] double fourSigmas(int squares);

}  // namespace lab::cases
