/// The simulated camera: poses and light in, an 8-bit grey picture out. Pure: no clock, no bus.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "light/field/field.hpp"
#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"
#include "light/optics/simulated_projector.hpp"
#include "light/photometry/imaging.hpp"
#include "light/photometry/projector_tone.hpp"

namespace lab::sim {

/// How much of the light each surface sends back [1].
struct Albedos {
  double floor = 0.78;
  double cap = 0.86;
  double circle = 0.07;  ///< the two black circles, the foot of the wall
  double body = 0.20;    ///< sides of a robot and the rim of its top around the cap
  double hole = 0.28;    ///< of the two light sensors
  double wall = 0.45;
  double outside = 0.30;
  double sheet = 0.86;
};

/// A flat disc on the floor.
struct FloorDisc {
  double x = 0;          ///< [m]
  double y = 0;          ///< [m]
  double radius = 0.01;  ///< [m]
  double albedo = 0.07;  ///< [1]
};

/// A flat strip on the floor from one place to another, with round ends.
struct FloorStrip {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< [m]
  double width = 0.01;                    ///< [m]
  double albedo = 0.07;                   ///< [1]
};

/// Light that a shiny place throws into the lens, over everything that is there.
struct GlareSpot {
  double x = 0;         ///< [m] on the cap plane
  double y = 0;         ///< [m]
  double sigma = 0.02;  ///< [m]
  double strength = 1;  ///< [1] at its middle, of a fully lit floor
};

/// What does not change in the course of a film.
struct PainterSettings {
  optics::CameraParameters camera;
  optics::CapGeometry cap;
  optics::Imaging imaging;  ///< at gain 1
  Albedos albedos;
  double arena_width = 1.20;   ///< [m]
  double arena_height = 0.90;  ///< [m]
  /// The projector's lens [m]. Its picture is right at cap height and shifted elsewhere.
  std::array<double, 3> projector = {0.60, 1.18, 2.10};
  /// What becomes of the light on its way to cap height.
  optics::ProjectorWarp warp;
  optics::ProjectorTones tones;  ///< and of its brightness
  double sheet = 0;              ///< [m] above the floor: a white sheet hides everything, 0: none
  double edge_softness = 0.001;  ///< [m] no edge in the light is sharper than the projector
  double ambient = 0.03;         ///< [1] room light, of full projector light
  double exposure = 0.01;        ///< [s]
  double gain = 1;
  double vignetting = 0.10;   ///< [1] of the light is lost in the corners of the picture
  double unevenness = 0.004;  ///< [1] standard deviation of the pixels' sensitivities
  int hot_pixels = 12;
  bool texture = true;     ///< mottled floor with scuffs
  std::uint64_t seed = 1;  ///< of the floor, the pixels and the noise
  std::vector<FloorDisc> discs;
  std::vector<FloorStrip> strips;
  std::vector<GlareSpot> glares;
};

/// A robot in the middle of the exposure.
struct PaintedRobot {
  double x = 0;      ///< [m]
  double y = 0;      ///< [m]
  double theta = 0;  ///< [rad]
  double vx = 0;     ///< [m/s]
  double vy = 0;     ///< [m/s]
  double omega = 0;  ///< [rad/s]
};

/// A lit floor gives kFullSignal [DN] above black in kFullExposure [s] at gain 1.
inline constexpr double kFullSignal = 200;
inline constexpr double kFullExposure = 0.01;

/// The noise of a camera's pixels.
struct PixelNoise {
  double floor = 0;  ///< [DN^2] variance in the dark
  double slope = 0;  ///< [DN] variance for each DN above black
};

/// Shot noise grows with the gain. Half of the variance in the dark arises before the amplifier,
/// and grows with the gain's square; half behind it.
[[nodiscard]] PixelNoise pixelNoise(const optics::Imaging& imaging, double gain);

/// Paints what the camera sees: floor, walls, robots with sides that the lens sees past the caps,
/// shadows that the projector casts, all through the real lens model. A picture is a function of
/// settings, light, robots and number alone, on any processor and whatever was painted before.
///
/// Every half-pixel cell of the picture is followed back to the floor; shapes cover cells by their
/// exact distance there, areas preserved; cells become pixels by one filter, the Gaussian of the
/// lens over the pixel's square. Centres of painted discs are right to better than 0.002 px.
/// Simplifications: walls are flat; a robot's side takes its light from the cap plane above it;
/// shapes inside a cap do not shade each other; movement during the exposure is a straight line in
/// pieces of at most one pixel.
class CameraPainter {
 public:
  explicit CameraPainter(PainterSettings settings);
  CameraPainter(const CameraPainter&) = delete;
  CameraPainter& operator=(const CameraPainter&) = delete;
  ~CameraPainter();

  [[nodiscard]] const PainterSettings& settings() const;

  /// The light from now on; dark before. A new list of layers costs a few frames' time, a new mix
  /// of known ones nearly nothing. Outside the arena the projector's picture ends 5 cm behind the
  /// walls.
  /// @param field whose layers pass validate()
  void setLight(const light::Field& field);

  /// Paints frame `number` into `out`, width x height bytes, the top row first.
  /// @throws std::invalid_argument when `out` is of another size.
  void paint(std::span<const PaintedRobot> robots, std::int64_t number,
             std::span<std::uint8_t> out);

  /// What paint() would show without noise, clipping and rounding [DN], height rows of width.
  [[nodiscard]] std::vector<float> expose(std::span<const PaintedRobot> robots);

 private:
  class Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace lab::sim
