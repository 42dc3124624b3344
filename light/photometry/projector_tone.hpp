/// Converts light to a projector's pixel values, and back.
#pragma once

#include <array>
#include <vector>

#include "light/optics/camera_model.hpp"

namespace lab::optics {

/// A pixel of value p in 0..1 gives the light V(x, y) p^gamma at the place it lights, with
///   V = 1 + v0 a + v1 b + v2 a^2 + v3 a b + v4 b^2,
/// a and b from -1 to 1 across the arena, and V at least kDarkest. An intensity of 1 is the light
/// of the projector's white where it is weakest, so that uniform light is possible everywhere.
class ProjectorTone {
 public:
  static constexpr double kDarkest = 0.05;

  /// Light equals the pixel's value.
  ProjectorTone() = default;

  /// @param vignetting v0 .. v4
  /// @param width,height of the arena [m]
  ProjectorTone(double gamma, const std::array<double, 5>& vignetting, double width, double height);

  [[nodiscard]] bool isIdentity() const { return plain_; }
  [[nodiscard]] double gamma() const { return gamma_; }
  [[nodiscard]] const std::array<double, 5>& vignetting() const { return vignetting_; }

  /// Minimum of V on the arena.
  [[nodiscard]] double weakest() const { return weakest_; }

  /// V at the place; outside the arena that of the nearest wall.
  [[nodiscard]] double white(Place place) const;

  /// Pixel value, 0..1, that lights the place with `intensity`.
  [[nodiscard]] double value(double intensity, Place place) const;

  /// Light at the place from a pixel of this value, in units of white().
  [[nodiscard]] double light(double value, Place place) const;

 private:
  bool plain_ = true;
  double gamma_ = 1;
  std::array<double, 5> vignetting_{};
  double width_ = 1;
  double height_ = 1;
  double weakest_ = 1;
};

/// The tone by which pixel values are computed, and the tone of the projector that shows them.
struct ProjectorTones {
  ProjectorTone assumed;
  ProjectorTone actual;

  /// Whether the light on the arena equals the commanded light.
  [[nodiscard]] bool areIdentity() const { return assumed.isIdentity() && actual.isIdentity(); }

  /// Light on `place` from the pixel whose value was computed for `intensity` at `source`.
  [[nodiscard]] double light(double intensity, Place source, Place place) const {
    if (areIdentity()) return intensity;
    return actual.light(assumed.value(intensity, source), place);
  }
};

/// ProjectorTones::light() for whole pictures, with a table of powers accurate to 1e-6.
class ToneTable {
 public:
  explicit ToneTable(const ProjectorTones& tones);

  [[nodiscard]] double light(double intensity, Place source, Place place) const;

 private:
  ProjectorTones tones_;
  double exponent_;             ///< applied to the share of white
  std::vector<double> powers_;  ///< of 0 to 1 in equal steps
};

}  // namespace lab::optics
