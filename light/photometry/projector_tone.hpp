/// From the light that is wanted to the value of a projector's pixel, and back.
#pragma once

#include <array>
#include <vector>

#include "light/optics/camera_model.hpp"

namespace lab::optics {

/// A pixel of value p in 0..1 gives the light V(x, y) p^gamma at the place that it lights, with
///   V = 1 + v0 a + v1 b + v2 a^2 + v3 a b + v4 b^2,
/// a and b from -1 to 1 across the arena, and V cut off below kDarkest. An intensity of 1 is what
/// the projector's white gives where it is weakest, so that an even light can be even everywhere.
class ProjectorTone {
 public:
  static constexpr double kDarkest = 0.05;

  /// Light is what the pixel's value says.
  ProjectorTone() = default;

  /// @param vignetting v0 .. v4
  /// @param width,height of the arena [m]
  ProjectorTone(double gamma, const std::array<double, 5>& vignetting, double width, double height);

  [[nodiscard]] bool isIdentity() const { return plain_; }
  [[nodiscard]] double gamma() const { return gamma_; }
  [[nodiscard]] const std::array<double, 5>& vignetting() const { return vignetting_; }

  /// V where it is smallest on the arena.
  [[nodiscard]] double weakest() const { return weakest_; }

  /// V at the place; outside the arena as at its nearest wall.
  [[nodiscard]] double white(Place place) const;

  /// Value of the pixel, 0..1, that lights the place with `intensity`.
  [[nodiscard]] double value(double intensity, Place place) const;

  /// Light at the place from a pixel of this value, in the unit of white().
  [[nodiscard]] double light(double value, Place place) const;

 private:
  bool plain_ = true;
  double gamma_ = 1;
  std::array<double, 5> vignetting_{};
  double width_ = 1;
  double height_ = 1;
  double weakest_ = 1;
};

/// How bright a projector is, beside how bright it is believed to be.
struct ProjectorTones {
  ProjectorTone believed;
  ProjectorTone real;

  /// Whether what is wanted is what falls on the arena.
  [[nodiscard]] bool areIdentity() const { return believed.isIdentity() && real.isIdentity(); }

  /// What falls on `place` where `intensity` was wanted at `source`.
  [[nodiscard]] double light(double intensity, Place source, Place place) const {
    if (areIdentity()) return intensity;
    return real.light(believed.value(intensity, source), place);
  }
};

/// ProjectorTones::light() for whole pictures: the power is read from a table, to 1e-6.
class ToneTable {
 public:
  explicit ToneTable(const ProjectorTones& tones);

  [[nodiscard]] double light(double intensity, Place source, Place place) const;

 private:
  ProjectorTones tones_;
  double exponent_;             ///< of the share of white
  std::vector<double> powers_;  ///< of 0 to 1 in even steps
};

}  // namespace lab::optics
