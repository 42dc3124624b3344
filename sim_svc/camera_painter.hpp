/// The simulated camera: renders an 8-bit grey picture from poses and light. No clock, no bus.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "light/field/field.hpp"
#include "light/optics/camera_model.hpp"
#include "light/optics/cap.hpp"
#include "light/optics/simulated_projector.hpp"
#include "light/photometry/imaging.hpp"
#include "light/photometry/projector_tone.hpp"

namespace lab::sim {

/// The share of light that each surface reflects [1].
struct Albedos {
  double floor = 0.78;
  double cap = 0.86;
  double circle = 0.07;  ///< the two black circles of a cap, the foot of the wall
  double body = 0.20;    ///< sides of a robot and the rim of its top around the cap
  double hole = 0.28;    ///< the holes of the two light sensors
  double wall = 0.45;
  double outside = 0.30;
  double sheet = 0.86;
};

/// What is on top of a robot.
enum class RobotTop : std::uint8_t {
  kCircles,  ///< the two circles of a cap
  kSpot,     ///< a single disc in the middle
  kTag,      ///< an AprilTag
};

/// A flat disc on the floor.
struct FloorDisc {
  double x = 0;          ///< [m]
  double y = 0;          ///< [m]
  double radius = 0.01;  ///< [m]
  double albedo = 0.07;  ///< [1]
};

/// A flat strip on the floor between two points, with round ends.
struct FloorStrip {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< [m]
  double width = 0.01;                    ///< [m]
  double albedo = 0.07;                   ///< [1]
};

/// A specular reflection, added to the light of everything that is painted there.
struct GlareSpot {
  double x = 0;         ///< [m] on the cap plane
  double y = 0;         ///< [m]
  double sigma = 0.02;  ///< [m]
  double strength = 1;  ///< [1] at its centre, relative to a fully lit floor
};

/// The constant properties of the scene and of the camera.
struct PainterSettings {
  optics::CameraParameters camera;
  optics::CapGeometry cap;
  RobotTop top = RobotTop::kCircles;
  double spot_radius = 0.01;            ///< [m] of RobotTop::kSpot
  bool bright_spot = false;             ///< white on a black cap
  std::string tag_family = "tag36h11";  ///< of RobotTop::kTag
  double tag_size = 0.04;               ///< [m] side, where its black border meets white
  optics::Imaging imaging;              ///< at gain 1
  Albedos albedos;
  double arena_width = 1.20;   ///< [m]
  double arena_height = 0.90;  ///< [m]
  /// Position of the projector's lens [m]. Its picture is correct at cap height and shifted at
  /// other heights.
  std::array<double, 3> projector = {0.60, 1.18, 2.10};
  /// Geometric errors of the projector at cap height.
  optics::ProjectorWarp warp;
  optics::ProjectorTones tones;  ///< errors of the projector's brightness
  double sheet = 0;              ///< [m] height of a white sheet that hides everything; 0: none
  double edge_softness = 0.001;  ///< [m] smallest width of an edge in the projected light
  double ambient = 0.03;         ///< [1] room light, relative to full projector light
  double exposure = 0.01;        ///< [s]
  double gain = 1;
  double vignetting = 0.10;   ///< [1] share of the light lost in the corners of the picture
  double unevenness = 0.004;  ///< [1] standard deviation of the pixels' sensitivities
  int hot_pixels = 12;
  bool texture = true;     ///< mottled floor with scuffs
  std::uint64_t seed = 1;  ///< for floor texture, pixel sensitivities and noise
  std::vector<FloorDisc> discs;
  std::vector<FloorStrip> strips;
  std::vector<GlareSpot> glares;
};

/// A robot's pose and velocity in the middle of the exposure.
struct PaintedRobot {
  double x = 0;      ///< [m]
  double y = 0;      ///< [m]
  double theta = 0;  ///< [rad]
  double vx = 0;     ///< [m/s]
  double vy = 0;     ///< [m/s]
  double omega = 0;  ///< [rad/s]
  int tag = 0;       ///< number of its tag
};

/// A fully lit floor gives kFullSignal [DN] above black in kFullExposure [s] at gain 1.
inline constexpr double kFullSignal = 200;
inline constexpr double kFullExposure = 0.01;

/// The noise of a camera's pixels.
struct PixelNoise {
  double floor = 0;  ///< [DN^2] variance in the dark
  double slope = 0;  ///< [DN] variance per DN above black
};

/// The noise at a gain. The variance of shot noise is proportional to the gain. Half of the
/// variance in the dark comes from before the amplifier and is proportional to the square of the
/// gain; the other half comes from after it and is constant.
[[nodiscard]] PixelNoise pixelNoise(const optics::Imaging& imaging, double gain);

/// Paints floor, walls, robots with their visible sides, and shadows in the projector's light, with
/// the same lens model as the tracker. A picture depends only on settings, light, robots and frame
/// number; it has the same bytes on every processor and whatever was painted before.
///
/// The picture is divided into cells of half a pixel, which are projected back to the floor. The
/// coverage of a cell by a shape is computed from the distance to the shape's edge, such that areas
/// are preserved. One filter, the Gaussian blur of the lens convolved with the pixel's square,
/// combines cells into pixels. Centres of painted discs are accurate to 0.002 px.
/// Simplifications: walls are flat; the side of a robot has the light of the cap plane above it;
/// shapes inside a cap do not shade each other; motion during the exposure is straight, in pieces
/// of at most one pixel.
class CameraPainter {
 public:
  explicit CameraPainter(PainterSettings settings);
  CameraPainter(const CameraPainter&) = delete;
  CameraPainter& operator=(const CameraPainter&) = delete;
  ~CameraPainter();

  [[nodiscard]] const PainterSettings& settings() const;

  /// Sets the light; initially it is dark. A new list of layers takes as long as a few frames; a
  /// new mixture of the same layers takes almost no time. The projector's picture ends 5 cm outside
  /// the walls.
  /// @param field its layers must pass validate()
  void setLight(const light::Field& field);

  /// Paints frame `number` into `out`, width x height bytes, the top row first.
  /// @throws std::invalid_argument if `out` has another size.
  void paint(std::span<const PaintedRobot> robots, std::int64_t number,
             std::span<std::uint8_t> out);

  /// The picture without noise, clipping and rounding [DN], height rows of width.
  [[nodiscard]] std::vector<float> expose(std::span<const PaintedRobot> robots);

 private:
  class Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace lab::sim
