/// Changes of a layer with time and with the robots. Plain data with the fields of light_drive_t.
///
/// Changes that depend on time only are evaluated by driven() below; those that depend on robots,
/// by the projector, which knows their poses. The result is a list of plain layers (layer.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "light/field/layer.hpp"

namespace lab::light {

/// Modulation m of the intensity between `low` (m = 0) and the layer's own (m = 1); s is the time
/// in periods, with s = `start` at time 0.
enum class Waveform : std::int8_t {
  kSteady = 0,  ///< m = 1
  kSine = 1,    ///< m = (1 + cos(2 pi s)) / 2
  kSquare = 2,  ///< m = 1 in the first half of each period, else 0
  kTelegraph =
      3,  ///< m alternates between 1 and 0, each for a time drawn from an exponential distribution
          ///< with mean period / 2, starting with 1; a function of `seed` only
};

enum class Follow : std::int8_t {
  kNothing = 0,
  kRobots = 1,  ///< one copy of the layer per robot; x, y and angle are in the robot's frame
  kTrail = 2,   ///< trails of robots (projector_ctl/scene/trail.hpp)
};

enum class WhenLost : std::int8_t {
  kRemove = 0,  ///< the layer disappears with its robot
  kHold = 1,    ///< it stays at the robot's last pose
  kSafe = 2,    ///< the safe field is shown until the robot is detected again
};

enum class Gate : std::int8_t {
  kOpen = 0,
  kProgram = 1,  ///< the robot runs `gate_program`
  kInside = 2,   ///< the robot's centre is in the circle
  kOutside = 3,  ///< the robot's centre is outside the circle
};

struct Drive {
  double vx = 0;          ///< [m/s] of the layer's x
  double vy = 0;          ///< [m/s]
  double spin = 0;        ///< [rad/s] of its angle
  double phase_rate = 0;  ///< [rad/s] of a wave, [1/s] of noise

  Waveform waveform = Waveform::kSteady;
  double period = 1;  ///< [s]
  double low = 0;     ///< [1] intensity at m = 0
  double start = 0;   ///< [1] phase at time 0, as a fraction of the period
  std::uint64_t seed = 0;

  double image_rate = 1;  ///< [1/s] rate of an image sequence
  bool image_loop = true;
  std::vector<std::string> images{};  ///< SHA-256, in a file: paths; empty if there is no sequence

  Follow follow = Follow::kNothing;
  std::vector<std::int32_t> robots{};  ///< ids; empty means all
  bool predict = true;                 ///< to the time at which the picture is shown
  double stale = 0.5;                  ///< [s] age above which a pose counts as lost
  WhenLost when_lost = WhenLost::kRemove;
  double rate = 1;       ///< [1/s] of a trail: rate of intensity deposited under a robot
  double decay = 0.1;    ///< [1/s] of a trail
  double diffusion = 0;  ///< [m^2/s] of a trail

  Gate gate = Gate::kOpen;
  std::int32_t gate_robot = 0;  ///< 0: the followed robot itself, or any robot if none is followed
  std::string gate_program{};   ///< name in the experiment file
  double gate_x = 0;            ///< [m]
  double gate_y = 0;            ///< [m]
  double gate_radius = 0;       ///< [m]

  bool operator==(const Drive&) const = default;
};

/// A layer and its changes.
struct DrivenLayer {
  Layer layer{};
  Drive drive{};

  bool operator==(const DrivenLayer&) const = default;
};

/// Whether the layer never changes.
[[nodiscard]] inline bool isStill(const Drive& drive) { return drive == Drive{}; }

/// Limits checked by validate().
inline constexpr double kLargestSpeed = 1;             ///< [m/s] of vx and vy
inline constexpr double kLargestRate = 1000;           ///< [1/s] or [rad/s]
inline constexpr double kLargestDiffusion = 0.01;      ///< [m^2/s]
inline constexpr double kShortestPeriod = 0.001;       ///< [s]
inline constexpr double kLongestTime = 864000;         ///< [s] ten days
inline constexpr std::size_t kMostImages = 1000;       ///< in a sequence
inline constexpr std::size_t kMostFollowed = 250;      ///< robots
inline constexpr std::int32_t kLargestRobot = 10'000;  ///< id

/// m of the waveform at `time` [s], 0..1.
[[nodiscard]] double modulation(const Drive& drive, double time);

/// The layer `time` [s] after the start of its command, as far as it depends on time only: moved,
/// rotated, dimmed, with the current picture of its sequence (its SHA-256; the caller attaches the
/// pixels).
[[nodiscard]] Layer driven(const DrivenLayer& layer, double time);

/// Why the layer cannot be shown, as "field = found, allowed: range"; empty if it can. Call
/// validate() of the layer too.
[[nodiscard]] std::optional<std::string> validate(const Drive& drive, LayerKind kind);

}  // namespace lab::light
