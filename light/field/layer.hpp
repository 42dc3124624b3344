/// One layer of the light field.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lab::light {

struct Image;

/// Kind of a layer. At each place a layer has a value v in 0..1 and a cover c in 0..1, both given
/// here in the layer's own frame: origin at (x, y), u along `angle`, w 90 degrees counter-clockwise
/// from u, r the distance from the origin.
///
/// E(d) is the layer's edge at signed distance d, positive inside: 0 outside, 1 inside, exactly
/// 1/2 on the line, and over the width `softness` the cubic 3t^2 - 2t^3 of t = d / softness + 1/2,
/// so that E(d) + E(-d) = 1. With softness 0 it is a step, and the line itself belongs to the
/// inside.
enum class LayerKind : std::int8_t {
  /// v = intensity, c = 1.
  kUniform = 1,
  /// v = intensity, c = E(u): the side of the line through (x, y) to which `angle` points.
  kHalfPlane = 2,
  /// v = intensity, c = E(size - r): radius `size`.
  kDisk = 3,
  /// v = intensity, c = E(size - r) E(r - inner): between the radii `inner` and `size`.
  kRing = 4,
  /// c = 1, v is linear from intensity at u = -size/2 to intensity2 at u = +size/2, and constant
  /// beyond.
  kLinearGradient = 5,
  /// c = 1, v = intensity for r <= inner, then linear to intensity2 at r = size, and intensity2
  /// beyond. With blend kMultiply, intensity = 1 and intensity2 = 0 it is a round mask.
  kRadialGradient = 6,
  /// c = 1, stripes along w with period `size`: v = intensity on the share `inner` of each period,
  /// intensity2 on the rest, E between them. One stripe of `intensity` is centred on (x, y).
  kStripes = 7,
  /// c = 1, squares of side `size`: v = intensity on the square centred on (x, y) and on those that
  /// touch its corners, intensity2 on the others, E between them.
  kChecker = 8,
  /// v = intensity2 + (intensity - intensity2) g, g the image's grey (0 black .. 1 white), bilinear
  /// between pixel centres; c = E of the distance to the nearest side, inside the rectangle of
  /// width `size` along u and height `inner` along w centred on (x, y). The image's top is at +w.
  kImage = 9,
  /// Paints nothing: ends a picture and starts the next one. The light of the layers before it,
  /// clamped to 0..1, and the light of the layers after it, up to the next kFade, are mixed with
  /// the shares (1 - intensity) and intensity. A list P, fade, Q is the frozen cross-fade from P to
  /// Q.
  kFade = 10,
  /// c = 1, v = intensity2 + (intensity - intensity2) n(u / size, w / size), n the smooth noise of
  /// light/field/noise.hpp for `seed` and `phase`: uniform over 0..1 at every place, correlated
  /// over `size`; while phase increases by 1 the pattern changes smoothly into another one.
  kNoise = 11,
  /// c = 1, v = intensity2 + (intensity - intensity2) (1 + cos(2 pi u / size - phase)) / 2: a crest
  /// is at u = 0 for phase 0, and travels along u while phase increases.
  kWave = 12,
  /// As kImage, with `pixels` from the message instead of a file.
  kGrid = 13,
};
inline constexpr LayerKind kLastKind = LayerKind::kGrid;

/// How a layer changes the intensity I below it: I' = I + c (b - I), with b as given here. A mask
/// is any layer with kMultiply.
enum class Blend : std::int8_t {
  kOver = 0,      ///< b = v
  kAdd = 1,       ///< b = I + v
  kMultiply = 2,  ///< b = I v
  kMax = 3,       ///< b = max(I, v)
  kMin = 4,       ///< b = min(I, v)
};

/// Plain data; LayerKind tells which fields a kind uses. Arena frame, SI units.
struct Layer {
  LayerKind kind = LayerKind::kUniform;
  Blend blend = Blend::kOver;
  double x = 0;            ///< [m] centre, or a point on the edge
  double y = 0;            ///< [m]
  double angle = 0;        ///< [rad] counter-clockwise from x
  double size = 0;         ///< [m] radius, length of a gradient, period, side, width of an image
  double inner = 0;        ///< [m] inner radius, height of an image; [1] share of a stripe's period
  double softness = 0;     ///< [m] width of the edge
  double intensity = 0;    ///< [1] 0 dark .. 1 projector white, at sensor height
  double intensity2 = 0;   ///< [1] the other end or the other half
  std::uint64_t seed = 0;  ///< of the pattern (kNoise)
  double phase = 0;        ///< [rad] of a wave; [1] time of noise, in units of its correlation time
  std::string image{};     ///< SHA-256 of the image file, 64 lower-case hexadecimal digits (kImage)
  std::shared_ptr<const Image> pixels = nullptr;  ///< its grey values, null while not available

  bool operator==(const Layer&) const = default;
};

/// Limits checked by validate().
inline constexpr double kLargestPlace = 30;      ///< [m] of every length
inline constexpr double kFurthestPlace = 1e6;    ///< [m] of x and y: layers move, for days
inline constexpr double kLargestPhase = 1e9;     ///< [rad] or [1]
inline constexpr double kSmallestSize = 0.001;   ///< [m] of size, if the kind uses it
inline constexpr double kLargestAngle = 100;     ///< [rad]
inline constexpr std::size_t kMostLayers = 160;  ///< in one picture

/// Why the layer cannot be painted, as "field = found, allowed: range"; empty if it can.
[[nodiscard]] std::optional<std::string> validate(const Layer& layer);

/// The first problem in the list, as "layers[i].field = found, allowed: range"; empty if there is
/// none.
[[nodiscard]] std::optional<std::string> validate(const std::vector<Layer>& layers);

}  // namespace lab::light
