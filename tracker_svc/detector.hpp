/// Finds the caps in one picture. Keeps no memory of earlier pictures.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"
#include "light/optics/grey_image.hpp"
#include "light/photometry/imaging.hpp"
#include "tracker_svc/circle_fit.hpp"
#include "tracker_svc/detection.hpp"
#include "tracker_svc/marker_detector.hpp"

namespace lab::detector {

/// Order of work: find spots (CircleSearch), fit circles to them (FittedCircles), pair the circles
/// and verify the cap's rim (PairBuilder), find missing partners (UnpairedCircles), and compute
/// poses from one circle and the rim (DegradedPoses).
class Detector final : public MarkerDetector {
 public:
  Detector(const optics::CameraModel& camera, const optics::CapGeometry& cap,
           const optics::Imaging& imaging = {});
  ~Detector() override;
  Detector(Detector&&) noexcept;
  Detector& operator=(Detector&&) noexcept;

  /// Finds every cap in the picture.
  /// @param rejected if not null, receives the rejected candidates
  /// @param expected where caps are expected from earlier pictures. If one circle and the rim of an
  ///   expected cap are found, and the other circle is not, its degraded pose is appended.
  /// @return valid until the next call
  const std::vector<Detection>& search(const optics::GreyView& picture,
                                       std::vector<Rejection>* rejected = nullptr,
                                       std::span<const Expected> expected = {}) override;

  /// Finds only the caps near expected poses. Result i belongs to expected[i]; its quality is 0 if
  /// no cap was found there. A cap found this way is bit-equal to the result of search(); where a
  /// light edge crosses a circle, the two results may differ. No cap is returned twice. If only one
  /// circle of a cap is seen, its pose is degraded (kUsedRim).
  const std::vector<Detection>& follow(const optics::GreyView& picture,
                                       std::span<const Expected> expected) override;

  /// Says whether the following pictures went through a lossy codec.
  void setCompressed(bool compressed) override;

  /// Sets the gamma of the following pictures (Imaging::gamma).
  void setGamma(double gamma) override;

  [[nodiscard]] const optics::CameraModel& camera() const override;
  [[nodiscard]] const optics::CapGeometry& cap() const;

 private:
  struct Steps;

  std::unique_ptr<Steps> steps_;
};

}  // namespace lab::detector
