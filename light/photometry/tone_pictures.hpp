/// What a camera sees of a projector's gamma and vignetting: pictures of even lights. Pure.
#pragma once

#include <string>
#include <vector>

#include "light/optics/camera_model.hpp"
#include "light/optics/grey_image.hpp"
#include "light/photometry/projector_tone.hpp"

namespace lab::calibration {

/// How bright one place of the arena looks in each of the lights.
struct ToneObservation {
  optics::Place place;       ///< [m]
  std::vector<double> grey;  ///< [DN] mean of the patch, one a light; 255 is full scale
  bool saturated = false;    ///< some pixel reached full scale in some light
};

/// Adds up pictures of even lights in patches of 4 cm, 10 cm apart, all over the arena.
class TonePictures {
 public:
  /// @param width,height of the arena [m] @param surface [m] above the floor, of what is seen
  /// @param lights how many there are
  TonePictures(const optics::CameraParameters& camera, double width, double height, double surface,
               std::size_t lights);

  /// @param grey a picture of the size of the camera's @throws std::out_of_range for other lights
  void take(std::size_t light, const optics::GreyView& grey);

  /// Patches of which a whole box of pixels is in the picture.
  [[nodiscard]] std::vector<ToneObservation> observations() const;

 private:
  struct Patch {
    optics::Place place;
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< [px], x1 and y1 behind the last
    std::vector<double> sum;             ///< of the patch's mean, one a light
    bool saturated = false;
  };

  std::vector<Patch> patches_;
  std::vector<int> pictures_;  ///< one a light
};

/// grey(place, value) = dark(place) + white(place) value^gamma, one gamma for all places.
struct ToneFromPictures {
  double gamma = 1;
  double gamma_sigma = 0;
  double residual = 0;  ///< [1] rms, of the brightest grey
  int places = 0;
  int saturated = 0;  ///< places left out
  // The white of all places beside a given vignetting, once the camera's own falloff, a parabola
  // across the arena, is taken out:
  double white_rms = 0;       ///< [1]
  double white_worst = 0;     ///< [1] signed
  optics::Place worst_place;  ///< [m]
  std::string refusal;        ///< not empty: why this says nothing
};

/// Least squares: in white and dark of each place directly, in gamma by golden section; its error
/// from the residuals.
/// @param values of the pixels in each light, 0..1
/// @param known the projector's vignetting as the robots' sensors found it
[[nodiscard]] ToneFromPictures fitTone(const std::vector<double>& values,
                                       const std::vector<ToneObservation>& observations,
                                       const optics::ProjectorTone& known, double width,
                                       double height);

}  // namespace lab::calibration
