#include "tests/support/tracker_scenes/scenes.hpp"

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <stdexcept>

#include "light/optics/camera_model.hpp"
#include "light/optics/rgb_image.hpp"
#include "light/optics/simulated_camera.hpp"
#include "tracker_svc/cameras/raw_pixels.hpp"

namespace lab::cases {
namespace {

using light::Layer;
using light::LayerKind;
using sim::PaintedRobot;

constexpr double kWidth = 1.20;   // [m]
constexpr double kHeight = 0.90;  // [m]
constexpr double kPi = std::numbers::pi;
constexpr double kTouching = 0.0752;  // [m] between the axes of two robots in contact
constexpr double kSoft = 0.001;       // [m] of edges in the light
constexpr int kDisksShown = 12;

// The same numbers on every platform, unlike the distributions of the standard library.
class PortableRandom {
 public:
  PortableRandom(const std::string& name, std::uint64_t seed) {
    std::vector<std::uint32_t> words(name.begin(), name.end());
    words.push_back(static_cast<std::uint32_t>(seed));
    words.push_back(static_cast<std::uint32_t>(seed >> 32));
    std::seed_seq sequence(words.begin(), words.end());
    random_.seed(sequence);
  }
  double between(double least, double most) {
    return least + (most - least) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  double angle() { return between(-kPi, kPi); }

 private:
  std::mt19937_64 random_;
};

bool isFree(const std::vector<PaintedRobot>& robots, double x, double y) {
  if (x < 0.0377 || y < 0.0377 || x > kWidth - 0.0377 || y > kHeight - 0.0377) return false;
  return std::ranges::none_of(robots, [&](const PaintedRobot& other) {
    return std::hypot(x - other.x, y - other.y) < kTouching - 1e-6;
  });
}

// A group of robots in contact with each other.
std::vector<PaintedRobot> groupOf(RobotPlacement places, PortableRandom& random) {
  PaintedRobot first{
      random.between(0.04, 1.16), random.between(0.04, 0.86), random.angle(), 0, 0, 0};
  std::vector<PaintedRobot> group;
  const double along = random.angle();
  const auto addAt = [&](double x, double y, double theta) {
    group.push_back({first.x + x * kTouching * std::cos(along) - y * kTouching * std::sin(along),
                     first.y + x * kTouching * std::sin(along) + y * kTouching * std::cos(along),
                     theta, 0, 0, 0});
  };
  switch (places) {
    case RobotPlacement::kAnywhere:
      return {first};
    case RobotPlacement::kAtWalls:
      if (random.between(0, 1) < 0.5) {
        first.x = random.between(0, 1) < 0.5 ? 0.0378 : kWidth - 0.0378;
      } else {
        first.y = random.between(0, 1) < 0.5 ? 0.0378 : kHeight - 0.0378;
      }
      return {first};
    case RobotPlacement::kPairs:
      for (int i = 0; i < 2; ++i) addAt(i, 0, random.angle());
      return group;
    case RobotPlacement::kChains:  // alternating headings: circles of two robots are 3.9 cm apart
      for (int i = 0; i < 5; ++i) addAt(i, 0, along + (i % 2) * kPi + random.between(-0.1, 0.1));
      return group;
    case RobotPlacement::kHexagons:
      addAt(0, 0, random.angle());
      for (int i = 0; i < 6; ++i)
        addAt(std::cos(i * kPi / 3), std::sin(i * kPi / 3), random.angle());
      return group;
  }
  return group;
}

std::vector<PaintedRobot> robotsOf(const SceneKind& kind, PortableRandom& random) {
  std::vector<PaintedRobot> robots;
  for (int attempt = 0; static_cast<int>(robots.size()) < kind.robots && attempt < 100000;
       ++attempt) {
    const std::vector<PaintedRobot> group = groupOf(kind.places, random);
    const bool free = std::ranges::all_of(
        group, [&](const PaintedRobot& one) { return isFree(robots, one.x, one.y); });
    if (free) robots.insert(robots.end(), group.begin(), group.end());
  }
  for (PaintedRobot& robot : robots) {
    robot.vx = kind.speed * std::cos(robot.theta);
    robot.vy = kind.speed * std::sin(robot.theta);
  }
  return robots;
}

light::Field lightOf(const SceneKind& kind, const std::vector<PaintedRobot>& robots,
                     PortableRandom& random) {
  light::Field field;
  std::vector<Layer>& layers = field.layers;
  layers.push_back({.kind = LayerKind::kUniform,
                    .intensity = kind.shown == SceneLight::kUniform ? kind.high : kind.low});
  Layer layer{.x = random.between(0.4, 0.8),
              .y = random.between(0.3, 0.6),
              .angle = random.angle(),
              .size = kind.size,
              .softness = kSoft,
              .intensity = kind.high,
              .intensity2 = kind.low};
  switch (kind.shown) {
    case SceneLight::kUniform:
      return field;
    case SceneLight::kHalf:
      layer.kind = LayerKind::kHalfPlane;
      break;
    case SceneLight::kGradient:
      layer.kind = LayerKind::kLinearGradient;
      layer.x = kWidth / 2;
      layer.y = kHeight / 2;
      layer.size = kWidth;
      break;
    case SceneLight::kRadial:
      layer.kind = LayerKind::kRadialGradient;
      break;
    case SceneLight::kStripes:
      layer.kind = LayerKind::kStripes;
      layer.inner = 0.5;
      break;
    case SceneLight::kChecker:
      layer.kind = LayerKind::kChecker;
      break;
    case SceneLight::kWave:
      layer.kind = LayerKind::kWave;
      break;
    case SceneLight::kNoise:
      layer.kind = LayerKind::kNoise;
      layer.seed = static_cast<std::uint64_t>(random.between(0, 1e9));
      break;
    case SceneLight::kDisks:
      layer.kind = LayerKind::kDisk;
      for (int i = 0; i < kDisksShown; ++i) {
        layer.x = random.between(0, kWidth);
        layer.y = random.between(0, kHeight);
        layer.size = kind.size * random.between(0.6, 1.4);
        layers.push_back(layer);
      }
      return field;
    case SceneLight::kRobots:
      layer.kind = LayerKind::kDisk;
      for (std::size_t i = 0; i < robots.size(); i += 2) {  // displaced as if late by a few frames
        const double away = random.between(0, 0.02);
        const double angle = random.angle();
        layer.x = robots[i].x + away * std::cos(angle);
        layer.y = robots[i].y + away * std::sin(angle);
        layers.push_back(layer);
      }
      return field;
  }
  layers.push_back(layer);
  return field;
}

// Adds a pair of discs with the radii of a cap times `scale` and its spacing times `spacing`.
void addPair(sim::PainterSettings& settings, double scale, double spacing, PortableRandom& random) {
  const double x = random.between(0.05, kWidth - 0.05);
  const double y = random.between(0.05, kHeight - 0.05);
  const double angle = random.angle();
  const optics::CapGeometry& cap = settings.cap;
  for (const bool big : {true, false}) {
    const double offset = spacing * (big ? cap.big_offset : cap.small_offset);
    settings.discs.push_back({x + offset * std::cos(angle), y + offset * std::sin(angle),
                              scale * (big ? cap.big_radius : cap.small_radius), 0.07});
  }
}

void addThings(const SceneKind& kind, sim::PainterSettings& settings, PortableRandom& random) {
  for (int i = 0; i < kind.debris; ++i) {
    const double x = random.between(0, kWidth);
    const double y = random.between(0, kHeight);
    const double albedo = random.between(0.04, 0.3);
    if (i % 2 == 0) {
      settings.discs.push_back({x, y, random.between(0.002, 0.016), albedo});
    } else {
      const double angle = random.angle();
      const double length = random.between(0.01, 0.10);
      settings.strips.push_back({x, y, x + length * std::cos(angle), y + length * std::sin(angle),
                                 random.between(0.002, 0.018), albedo});
    }
  }
  for (int i = 0; i < kind.decoys; ++i) {
    const bool near = i % 2 == 0;
    addPair(settings, near ? random.between(0.9, 1.1) : random.between(0.6, 1.5),
            near ? random.between(1.08, 1.3) : 1, random);
  }
  // A pair on the floor looks 3 % smaller than on a cap: once unscaled, once scaled to compensate.
  for (int i = 0; i < kind.floor_pairs; ++i) {
    const double scale = i % 2 == 0 ? 1.0 : 1.03;
    addPair(settings, scale, scale, random);
  }
  for (int i = 0; i < kind.glares; ++i) {
    settings.glares.push_back({random.between(0.1, 1.1), random.between(0.1, 0.8),
                               random.between(0.008, 0.025), random.between(0.6, 2.5)});
  }
}

optics::Place circleAt(const PaintedRobot& robot, double offset) {
  return {robot.x + offset * std::cos(robot.theta), robot.y + offset * std::sin(robot.theta)};
}

// Additional light of reflections, relative to a fully lit floor.
double glareAt(const Scene& scene, double x, double y) {
  double glare = 0;
  for (const sim::GlareSpot& g : scene.settings.glares) {
    const double square = (x - g.x) * (x - g.x) + (y - g.y) * (y - g.y);
    glare += g.strength * std::exp(-square / (2 * g.sigma * g.sigma));
  }
  return glare;
}

// Whether reflections or saturation remove the contrast between black and white paint on at least
// half of a circle.
bool washedOut(const Scene& scene, const light::CompiledField& field, optics::Place at,
               double radius) {
  const sim::PainterSettings& s = scene.settings;
  const auto shown = [&](double signal) { return std::min(signal, 255 - s.imaging.black); };
  int all = 0;
  int lost = 0;
  for (double r = 0.1 * radius; r < radius; r += 0.2 * radius) {
    for (double angle = 0; angle < 2 * kPi; angle += 0.3 * radius / r) {
      const double x = at.x + r * std::cos(angle);
      const double y = at.y + r * std::sin(angle);
      const double glare = glareAt(scene, x, y);
      const double full = sim::kFullSignal * s.gain * s.exposure / sim::kFullExposure;
      const double lit = full * (field.evaluate(x, y) + s.ambient) / s.albedos.floor;
      const double white = lit * s.albedos.cap + full * glare;
      const double black = lit * s.albedos.circle + full * glare;
      ++all;
      lost += shown(white) - shown(black) < 0.1 * (white - black) ? 1 : 0;
    }
  }
  return 2 * lost >= all;
}

// Unsharp masking as in webcams: brighter beside dark pixels, darker beside bright ones.
void sharpen(optics::GreyImage& image, double amount) {
  const optics::GreyImage from = image;
  const auto blurred = [](int before, int here, int after) { return before + 2 * here + after; };
  for (int y = 1; y + 1 < image.height; ++y) {
    const std::uint8_t* rows[] = {from.view().row(y - 1), from.view().row(y),
                                  from.view().row(y + 1)};
    for (int x = 1; x + 1 < image.width; ++x) {
      int sums[3];
      for (int i = 0; i < 3; ++i) sums[i] = blurred(rows[i][x - 1], rows[i][x], rows[i][x + 1]);
      const double off = rows[1][x] - blurred(sums[0], sums[1], sums[2]) / 16.0;
      image.row(y)[x] =
          static_cast<std::uint8_t>(std::clamp(std::lround(rows[1][x] + amount * off), 0L, 255L));
    }
  }
}

// Encodes and decodes the picture as JPEG.
void passAsJpeg(optics::GreyImage& image, int quality) {
  optics::RgbImage rgb(image.width, image.height);
  for (std::size_t i = 0; i < rgb.pixels.size(); ++i) rgb.pixels[i] = image.pixels[i / 3];
  const cameras::RawLayout layout{
      .fourcc = V4L2_PIX_FMT_MJPEG, .width = image.width, .height = image.height};
  if (!cameras::greyOfRaw(layout, optics::jpegBytes(rgb, quality), image)) {
    throw std::runtime_error("the encoded JPEG cannot be decoded");
  }
}

}  // namespace

Scene sceneOf(const SceneKind& kind, std::uint64_t seed) {
  PortableRandom random(kind.name, seed);
  Scene scene;
  scene.sharpened = kind.sharpened;
  scene.jpeg = kind.jpeg;
  sim::PainterSettings& settings = scene.settings;
  settings.imaging.compressed = kind.jpeg > 0;
  settings.imaging.gamma = kind.gamma;
  const int columns = kind.rows == 480 ? 640 : kind.rows * 16 / 9;
  settings.camera = optics::simulatedCamera(columns, kind.rows, kWidth, kHeight);
  settings.imaging.blur = kind.blur;
  settings.imaging.read_noise = kind.read_noise;
  settings.exposure = kind.exposure;
  settings.gain = kind.brightness;
  settings.vignetting = kind.vignetting;
  settings.seed = seed;
  scene.robots = robotsOf(kind, random);
  scene.light = lightOf(kind, scene.robots, random);
  addThings(kind, settings, random);
  const optics::CameraModel camera(settings.camera);
  const light::CompiledField field(scene.light);
  const optics::CapGeometry& cap = settings.cap;
  for (const PaintedRobot& robot : scene.robots) {
    bool counts = true;
    for (const bool big : {true, false}) {
      const optics::Place at = circleAt(robot, big ? cap.big_offset : cap.small_offset);
      const double radius = big ? cap.big_radius : cap.small_radius;
      const optics::Pixel middle = camera.project(at.x, at.y, cap.height);
      const optics::PlaneScale s = camera.scaleAt(at, cap.height);
      const double reach = radius * std::sqrt(std::abs(s.ux * s.vy - s.uy * s.vx));
      counts = counts && middle.x >= reach && middle.y >= reach &&
               middle.x <= columns - 1 - reach && middle.y <= kind.rows - 1 - reach &&
               !washedOut(scene, field, at, radius);
    }
    scene.truth.push_back({robot.x, robot.y, std::remainder(robot.theta, 2 * kPi), counts});
  }
  return scene;
}

optics::GreyImage paint(const Scene& scene) {
  sim::CameraPainter painter(scene.settings);
  painter.setLight(scene.light);
  optics::GreyImage image(scene.settings.camera.width, scene.settings.camera.height);
  painter.paint(scene.robots, static_cast<std::int64_t>(scene.settings.seed), image.pixels);
  if (scene.sharpened > 0) sharpen(image, scene.sharpened);
  if (scene.jpeg > 0) passAsJpeg(image, scene.jpeg);
  return image;
}

DetectedScene look(const SceneKind& kind, std::uint64_t seed, bool with_rejected, Score& score) {
  DetectedScene out{sceneOf(kind, seed), {}, {}, {}, {}};
  out.image = paint(out.scene);
  const sim::PainterSettings& settings = out.scene.settings;
  detector::Detector detector(optics::CameraModel(settings.camera), settings.cap, settings.imaging);
  const auto start = std::chrono::steady_clock::now();
  out.poses = detector.search(out.image.view(), with_rejected ? &out.rejected : nullptr);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  out.left =
      score.add(out.scene.truth, out.poses, detector.camera(), settings.cap.height, took.count());
  return out;
}

std::string lightOn(const Scene& scene, std::size_t robot) {
  constexpr double kStep = 0.0005;    // [m]
  constexpr double kFarthest = 0.05;  // [m]
  constexpr double kEdge = 0.05;      // [1] of a step's length
  const light::CompiledField field(scene.light);
  const optics::CapGeometry& cap = scene.settings.cap;
  std::string out;
  for (const bool big : {true, false}) {
    const optics::Place at = circleAt(scene.robots[robot], big ? cap.big_offset : cap.small_offset);
    const double radius = big ? cap.big_radius : cap.small_radius;
    double least = 1;
    double most = 0;
    double nearest = kFarthest;
    for (double angle = 0; angle < 2 * kPi; angle += kPi / 24) {
      double before = field.evaluate(at.x, at.y);
      for (double r = 0; r < kFarthest; r += kStep) {
        const double here = field.evaluate(at.x + r * std::cos(angle), at.y + r * std::sin(angle));
        if (r < 1.3 * radius) least = std::min(least, here);
        if (r < 1.3 * radius) most = std::max(most, here);
        if (std::abs(here - before) > kEdge) nearest = std::min(nearest, r);
        before = here;
      }
    }
    char text[120];
    std::snprintf(text, sizeof text, "%s %.2f..%.2f edge %.1f mm glare %.2f%s",
                  big ? "big" : "small", least, most, 1e3 * nearest, glareAt(scene, at.x, at.y),
                  big ? "; " : "");
    out += text;
  }
  return out;
}

}  // namespace lab::cases
