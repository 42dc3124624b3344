/// Structured light: patterns that tell a camera which pixel of the projector it sees, and their
/// decoding. No input or output.
///
/// Sine waves along x and along y are shown in several equally spaced phases. The phase seen by a
/// camera pixel gives its position in the wave, independent of brightness, to a small fraction of a
/// pixel. A wave longer than the arena tells which period of a short wave that is. N phases are
/// insensitive to harmonics up to N - 2, caused by a nonlinear response.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "light/field/layer.hpp"
#include "light/optics/camera_model.hpp"
#include "light/optics/projector_model.hpp"
#include "projector_ctl/calibration/projector_lens.hpp"

namespace lab::calibration {

/// One picture to be shown.
struct LightPattern {
  enum class Kind { kDark, kBright, kWave };
  Kind kind = Kind::kDark;
  std::size_t wave = 0;  ///< which of kWaves: long x, short x, long y, short y
  double phase = 0;      ///< [rad]
  light::Layer layer;    ///< that shows it
};

inline constexpr std::size_t kWaves = 4;
inline constexpr int kPhases = 6;
inline constexpr double kShortWave = 0.05;  ///< [1] of the arena's side
inline constexpr double kLongWave = 1.25;   ///< [1] of the arena's side

/// All pictures of one calibration, 26.
[[nodiscard]] std::vector<LightPattern> projectorPatterns(double arena_width, double arena_height);

/// Geometry of the camera and the projector.
struct PatternView {
  optics::CameraParameters camera;
  double surface = 0.05;  ///< [m] height of the lit surface above the floor
  /// Position x, y, z of the projector's lens [m]: if the surface is not at the plane's height,
  /// observations are moved along the light rays to the plane. Empty: the surface is at that
  /// height.
  std::optional<std::array<double, 3>> projector;
  ProjectorPlane plane;
  /// The projector model in use while the patterns are shown: relates pattern places to pixels.
  optics::ProjectorModel assumed{1.2, 0.9, 1920, 1080};
};

/// Camera pixels on the arena, and reasons why some are not usable.
struct PatternCount {
  int pixels = 0;
  int dark = 0;       ///< too little contrast: a shadow, or outside the projector's picture
  int saturated = 0;  ///< too bright for the camera
  int unclear = 0;    ///< the waves are faint, or inconsistent
};

/// Accumulates and decodes the pictures.
class PatternReader {
 public:
  /// @throws std::invalid_argument if the surface is not at the plane's height and the projector's
  ///   position is unknown, or if the surface is as high as the projector
  PatternReader(const PatternView& view, const std::vector<LightPattern>& patterns);

  /// Adds one picture of pattern `index`. Each pattern must be added equally often.
  /// @throws std::invalid_argument if its size is not the camera's
  void add(std::size_t index, const optics::GreyView& grey);

  /// One observation for the middle of each square of kBlock camera pixels, if all its pixels and
  /// neighbours are usable, by a paraboloid; sigmas follow from its residuals.
  [[nodiscard]] std::vector<ProjectorObservation> observations() const;

  [[nodiscard]] PatternCount count() const;

  static constexpr int kBlock = 16;  ///< [px]
  static constexpr int kRing = 3;    ///< [px] neighbours that the camera's lens mixes in

 private:
  [[nodiscard]] bool isClear(std::size_t at) const;
  [[nodiscard]] std::optional<optics::Pixel> projectorPixel(std::size_t at) const;
  [[nodiscard]] std::optional<optics::Place> placeOf(optics::Pixel pixel) const;
  [[nodiscard]] std::vector<bool> clearPixels() const;

  PatternView view_;
  optics::CameraModel camera_;
  std::vector<LightPattern> patterns_;
  std::vector<int> pictures_;
  std::vector<float> dark_, bright_;                ///< sums
  std::array<std::vector<float>, kWaves> cosines_;  ///< sums, multiplied by the phases' cosines
  std::array<std::vector<float>, kWaves> sines_;
  std::vector<bool> saturated_;
  std::vector<bool> in_arena_;
};

}  // namespace lab::calibration
