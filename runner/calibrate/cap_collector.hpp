/// Caps from pictures of a camera that is not known yet. Pictures in, sightings out.
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

/// A first idea of a camera.
struct RoughCamera {
  optics::CameraParameters camera;
  std::size_t caps = 0;  ///< found with it
};

/// The camera from which most caps are found in these pictures, of cameras at several heights with
/// several distortions that all fit to the corners: a first idea of the true one. Where as many are
/// found, the one with which their spacings are most alike.
/// @return without a cap where none finds one
[[nodiscard]] RoughCamera roughCamera(const calibration::CameraObservations& sights,
                                      const std::vector<optics::GreyImage>& pictures,
                                      const optics::Imaging& imaging = {});

/// Collects caps, one for each place and heading: robots that stand tell nothing new, and what is
/// wrong with their picture stays wrong in every frame.
class CapCollector {
 public:
  CapCollector(const optics::CameraParameters& camera, const optics::CapGeometry& cap,
               const optics::Imaging& imaging = {});

  void take(const optics::GreyView& picture);

  [[nodiscard]] const std::vector<calibration::CapObservation>& caps() const { return caps_; }

  /// Standard deviation of the point spread [px]: the median over the caps; empty for too few.
  [[nodiscard]] std::optional<double> blur() const;

 private:
  detector::Detector detector_;
  std::set<std::int64_t> taken_;  // places and headings
  std::vector<calibration::CapObservation> caps_;
  std::vector<float> blurs_;  // [px] of the caps
};

}  // namespace lab::runner
