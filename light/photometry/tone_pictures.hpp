/// Estimates a projector's gamma and vignetting from a camera's pictures of uniform lights. No
/// input or output.
#pragma once

#include <string>
#include <vector>

#include "light/optics/camera_model.hpp"
#include "light/optics/grey_image.hpp"
#include "light/photometry/projector_tone.hpp"

namespace lab::calibration {

/// Grey values of one place of the arena in each of the lights.
struct ToneObservation {
  optics::Place place;       ///< [m]
  std::vector<double> grey;  ///< [DN] mean of the patch per light; 255 is full scale
  bool saturated = false;    ///< whether a pixel reached full scale in any light
};

/// Averages pictures of uniform lights in patches of 4 cm, 10 cm apart, over the arena.
class TonePictures {
 public:
  /// @param width,height of the arena [m]
  /// @param surface [m] height of the visible surface above the floor
  /// @param lights number of lights
  TonePictures(const optics::CameraParameters& camera, double width, double height, double surface,
               std::size_t lights);

  /// @param grey a picture of the camera's size
  /// @throws std::out_of_range for an invalid light
  void add(std::size_t light, const optics::GreyView& grey);

  /// Patches that lie completely in the picture.
  [[nodiscard]] std::vector<ToneObservation> observations() const;

 private:
  struct Patch {
    optics::Place place;
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< [px], x1 and y1 exclusive
    std::vector<double> sum;             ///< of the patch's mean, per light
    bool saturated = false;
  };

  std::vector<Patch> patches_;
  std::vector<int> pictures_;  ///< number per light
};

/// grey(place, value) = dark(place) + white(place) value^gamma, with one gamma for all places.
struct ToneFromPictures {
  double gamma = 1;
  double gamma_sigma = 0;
  double residual = 0;  ///< [1] rms, relative to the brightest grey value
  int places = 0;
  int saturated = 0;  ///< number of places excluded
  // White of all places relative to a given vignetting, after removing the camera's own falloff, a
  // parabola across the arena:
  double white_rms = 0;       ///< [1]
  double white_worst = 0;     ///< [1] signed
  optics::Place worst_place;  ///< [m]
  std::string refusal;        ///< reason why the result is invalid; empty if valid
};

/// Least squares: direct in white and dark of each place, golden-section search in gamma, whose
/// error follows from the residuals.
/// @param values of the pixels in each light, 0..1
/// @param known the projector's vignetting measured by the robots' sensors
[[nodiscard]] ToneFromPictures fitTone(const std::vector<double>& values,
                                       const std::vector<ToneObservation>& observations,
                                       const optics::ProjectorTone& known, double width,
                                       double height);

}  // namespace lab::calibration
