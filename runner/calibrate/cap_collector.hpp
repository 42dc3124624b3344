/// Finds caps in pictures of a camera that is not calibrated yet. Pure: no files, no bus.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "light/optics/grey_image.hpp"
#include "light/photometry/imaging.hpp"
#include "tracker_svc/calibration/camera_fit.hpp"
#include "tracker_svc/detector.hpp"

namespace lab::runner {

/// First estimate of a camera.
struct RoughCamera {
  optics::CameraParameters camera;
  std::size_t caps = 0;  ///< number of caps found with it
};

/// Tries cameras at several heights with several distortions, all fitted to the corners, and
/// returns the one with which most caps are found; if several find as many, the one with the
/// smallest variance of the spacings.
/// @return `caps` is 0 if no cap was found
[[nodiscard]] RoughCamera roughCamera(const calibration::CameraObservations& observations,
                                      const std::vector<optics::GreyImage>& pictures,
                                      const optics::Imaging& imaging = {});

/// Collects caps, one per place and heading: further frames of a robot at rest add no information,
/// and their errors are not independent.
class CapCollector {
 public:
  CapCollector(const optics::CameraParameters& camera, const optics::CapGeometry& cap,
               const optics::Imaging& imaging = {});

  void take(const optics::GreyView& picture);

  [[nodiscard]] const std::vector<calibration::CapObservation>& caps() const { return caps_; }

  /// Standard deviation of the point spread function [px], median over the caps; nothing if there
  /// are too few.
  [[nodiscard]] std::optional<double> blur() const;

 private:
  detector::Detector detector_;
  std::set<std::int64_t> taken_;  // keys of places and headings
  std::vector<calibration::CapObservation> caps_;
  std::vector<float> blurs_;  // [px] one per cap
};

}  // namespace lab::runner
