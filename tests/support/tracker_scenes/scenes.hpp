// Random scenes of a kind with ground truth, their pictures, and the results of the detector.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "light/field/field.hpp"
#include "light/optics/grey_image.hpp"
#include "sim_svc/camera_painter.hpp"
#include "tests/support/tracker_scenes/scene_kinds.hpp"
#include "tests/support/tracker_scenes/score.hpp"

namespace lab::cases {

struct Scene {
  sim::PainterSettings settings;
  double sharpened = 0;  // as SceneKind::sharpened
  int jpeg = 0;          // as SceneKind::jpeg
  light::Field light;
  std::vector<sim::PaintedRobot> robots;
  std::vector<TrueRobot> truth;  // in the same order
};

// Deterministic: depends only on the arguments.
Scene sceneOf(const SceneKind& kind, std::uint64_t seed);

optics::GreyImage paint(const Scene& scene);

// The detector's results in a scene, without prior knowledge of the robots' places.
struct DetectedScene {
  Scene scene;
  optics::GreyImage image;
  std::vector<detector::Detection> poses;
  std::vector<detector::Rejection> rejected;  // if requested
  Unmatched left;
};

// Paints a scene, runs the detector over it, and adds what it found to the score.
DetectedScene look(const SceneKind& kind, std::uint64_t seed, bool with_rejected, Score& score);

// Describes the light on a robot: its range on both circles, and the distance of the nearest edge
// from their centres.
std::string lightOn(const Scene& scene, std::size_t robot);

}  // namespace lab::cases
