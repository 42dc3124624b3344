/// Pictures of blobs and tags with ground truth, painted independently of the detectors.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "light/optics/camera_model.hpp"
#include "light/optics/grey_image.hpp"
#include "light/photometry/imaging.hpp"

namespace lab::cases {

/// A painted marker: an ellipse, or a tag.
struct TrueMarker {
  double x = 0;               ///< [m]
  double y = 0;               ///< [m]
  double theta = 0;           ///< [rad] long axis of an ellipse, or right edge of a tag
  double long_axis = 0.008;   ///< [m] half of it; of a tag half its side
  double short_axis = 0.008;  ///< [m] half of it
  int tag = -1;               ///< number of a tag, -1: an ellipse
  bool hidden = false;        ///< partly, by something that looks like the ground
};

enum class SceneLight { kEven, kGradient, kRadial, kWaves };

/// What is painted.
struct MarkerSceneSettings {
  int width = 1280;           ///< [px]
  int height = 720;           ///< [px]
  double arena_width = 1.2;   ///< [m]
  double arena_height = 0.9;  ///< [m]
  double plane = 0;           ///< [m] height of the markers above the floor
  optics::Imaging imaging{.gamma = 1};
  SceneLight light = SceneLight::kEven;
  double brightness = 200;  ///< [DN] of a white surface in full light, without black level
  double ground = 0.8;      ///< [1] albedo
  double marker = 0.1;      ///< [1] albedo of ellipses and of black cells
  double white = 0.9;       ///< [1] albedo of white cells
  std::string family = "tag36h11";
  std::uint64_t seed = 1;  ///< of the noise
};

/// The camera above the arena.
[[nodiscard]] optics::CameraModel cameraOf(const MarkerSceneSettings& settings);

/// Paints the markers: areas of pixels are exact to a hundredth, then lens blur, light and noise.
[[nodiscard]] optics::GreyImage paintMarkers(const MarkerSceneSettings& settings,
                                             const std::vector<TrueMarker>& markers);

/// A kind of scene of the tests and of the benchmark.
struct MarkerKind {
  std::string name;
  MarkerSceneSettings settings;
  bool tags = false;
  bool bright = false;
  int count = 30;
  double long_axis = 0.008;
  double short_axis = 0.008;
  double spread = 0.05;  ///< [1] of the sizes
  int chain = 1;         ///< markers that touch each other
  double hidden = 0;     ///< [1] share of the markers that are partly hidden
};

/// All kinds; names begin with blobs_ or tags_.
[[nodiscard]] std::vector<MarkerKind> markerKinds();
[[nodiscard]] MarkerKind markerKind(std::string_view name);

/// Places the markers of a kind at random.
[[nodiscard]] std::vector<TrueMarker> placeMarkers(const MarkerKind& kind, std::uint64_t seed);

}  // namespace lab::cases
