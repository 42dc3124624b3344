// Scenes of a kind, any number of each, with their truth: painted, and looked at by the detector.
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

// A function of both arguments alone.
Scene sceneOf(const SceneKind& kind, std::uint64_t seed);

optics::GreyImage paint(const Scene& scene);

// What the detector makes of a scene, without any idea of where the robots are.
struct DetectedScene {
  Scene scene;
  optics::GreyImage image;
  std::vector<detector::Detection> poses;
  std::vector<detector::Rejection> rejected;  // where asked for
  Unmatched left;
};

// Paints a scene, runs the detector over it, and adds what it found to the score.
DetectedScene look(const SceneKind& kind, std::uint64_t seed, bool with_rejected, Score& score);

// What a scene's light does to a robot, in words: the range of it on both circles, and how far the
// nearest edge is from their middles.
std::string lightOn(const Scene& scene, std::size_t robot);

}  // namespace lab::cases
