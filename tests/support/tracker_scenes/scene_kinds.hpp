// The kinds of pictures for tests of the tracker, with the limits it must meet.
#pragma once

#include <span>
#include <string_view>

#include "tests/support/tracker_scenes/acceptance_limits.hpp"

namespace lab::cases {

enum class RobotPlacement { kAnywhere, kChains, kHexagons, kPairs, kAtWalls };

// The light of a scene, with the levels `high` and `low` and the length `size`.
enum class SceneLight {
  kUniform,   // high
  kHalf,      // high on one side of a line through the middle third of the arena
  kGradient,  // from low to high across the arena
  kRadial,    // high in the middle, low at a distance of `size`
  kStripes,   // share 1/2, period `size`
  kChecker,   // squares of side `size`
  kDisks,     // 12 discs of radius `size`
  kRobots,    // a disc of radius `size` beside every other robot
  kWave,      // period `size`
  kNoise,     // correlated over `size`
};

struct SceneKind {
  const char* name = "";
  int robots = 40;
  int rows = 720;  // picture height; 16 : 9, or 4 : 3 for 480
  SceneLight shown = SceneLight::kUniform;
  double high = 1;
  double low = 0;
  double size = 0;  // [m]
  RobotPlacement places = RobotPlacement::kAnywhere;
  double blur = 0.75;       // [px]
  double read_noise = 1.2;  // [DN]
  double exposure = 0.01;   // [s]
  double brightness = 1;    // [1] gain; above 1 white saturates
  double speed = 0;         // [m/s]
  double vignetting = 0.1;  // [1]
  int debris = 0;           // discs and strips on the floor
  int decoys = 0;       // pairs of discs on the floor with another size or distance than on a cap
  int floor_pairs = 0;  // pairs on the floor that look like those of a cap
  int glares = 0;
  double gamma = 1;      // as Imaging::gamma
  double sharpened = 0;  // [1] strength of unsharp masking, as in webcams
  int jpeg = 0;          // JPEG quality, 1 to 100; 0 for no JPEG
  AcceptanceLimits limits = {};
};

// All kinds.
std::span<const SceneKind> kinds();

// @throws std::out_of_range if the name is unknown
const SceneKind& kindOf(std::string_view name);

}  // namespace lab::cases
