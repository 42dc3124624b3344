/// Structured light: what a projector is made to show so that a camera can tell which of its pixels
/// it sees, and how that is read. Numbers in, numbers out.
///
/// Waves of light along x and along y, each shown in several phases a whole turn apart in all: the
/// phase that a camera's pixel sees says where in the wave it looks, whatever its brightness, and
/// to a small part of a pixel. A wave longer than the arena says in which crest of a short one that
/// is. N phases are blind to the harmonics up to N - 2 of a light that is not proportional to what
/// is asked for.
#pragma once

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
inline constexpr double kShortWave = 0.05;  ///< [m]
inline constexpr double kLongWave = 1.25;   ///< [1] of the arena's side

/// All pictures of one calibration, 26.
[[nodiscard]] std::vector<LightPattern> projectorPatterns(double arena_width, double arena_height);

/// What a camera sees of the patterns.
struct PatternView {
  optics::CameraParameters camera;
  double surface = 0.05;  ///< [m] above the floor, of what the light falls on
  /// The projector's lens, x, y, z [m]: where the surface is not at the plane's height, what it
  /// shows is moved along the light to there. Empty: the surface is at that height.
  std::optional<std::array<double, 3>> projector;
  ProjectorPlane plane;
  /// In force while the patterns are shown: the pixel of each place that they speak of.
  optics::ProjectorModel believed{1.2, 0.9, 1920, 1080};
};

/// Pixels of the camera that look at the arena, and why they say nothing.
struct PatternCount {
  int pixels = 0;
  int dark = 0;       ///< bright and dark hardly differ: a shadow, or out of the picture
  int saturated = 0;  ///< too bright for the camera
  int unclear = 0;    ///< the waves are faint, or do not agree with each other
};

/// Sums the pictures up.
class PatternReader {
 public:
  /// @throws std::invalid_argument when the surface is not at the plane's height and nobody says
  ///   where the projector is, or is as high as the projector.
  PatternReader(const PatternView& view, const std::vector<LightPattern>& patterns);

  /// One picture of pattern `index`; each pattern as often as the others.
  /// @throws std::invalid_argument when it is of another size than the camera's.
  void take(std::size_t index, const optics::GreyView& grey);

  /// The middles of squares of kBlock pixels of the camera, all of whose pixels and neighbours are
  /// clear: from paraboloids through the squares, whose scatter gives the sigmas.
  [[nodiscard]] std::vector<ProjectorObservation> observations() const;

  [[nodiscard]] PatternCount count() const;

  static constexpr int kBlock = 16;  ///< [px]
  static constexpr int kRing = 3;    ///< [px] about it: what the camera's lens mixes

 private:
  [[nodiscard]] bool isClear(std::size_t at) const;
  [[nodiscard]] std::optional<optics::Pixel> projectorPixel(std::size_t at) const;
  [[nodiscard]] std::optional<optics::Place> placeOf(optics::Pixel pixel) const;
  [[nodiscard]] std::vector<bool> clearPixels() const;

  PatternView view_;
  optics::CameraModel camera_;
  std::vector<LightPattern> patterns_;
  std::vector<int> taken_;
  std::vector<float> dark_, bright_;                ///< sums
  std::array<std::vector<float>, kWaves> cosines_;  ///< sums, times the phases' cosines
  std::array<std::vector<float>, kWaves> sines_;
  std::vector<bool> saturated_;
  std::vector<bool> in_arena_;
};

}  // namespace lab::calibration
