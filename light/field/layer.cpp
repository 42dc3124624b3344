#include "light/field/layer.hpp"

#include <algorithm>
#include <cmath>

#include "light/field/image.hpp"
#include "robot/language/number_text.hpp"

namespace lab::light {

namespace {

using Problem = std::optional<std::string>;

constexpr int kLayerDigits = 6;

std::string text(double value) { return language::numberText(value, kLayerDigits); }

/// Empty if low <= value <= high; NaN is outside every range.
Problem outside(const char* field, double value, double low, double high, const char* unit) {
  if (value >= low && value <= high) return {};
  const int digits = language::digitsBeside({low, high}, value, kLayerDigits);
  const auto beside = [&](double number) { return language::numberText(number, digits); };
  return std::string(field) + " = " + beside(value) + unit + ", allowed: " + beside(low) + " to " +
         beside(high) + unit;
}

bool readsSize(LayerKind kind) {
  return kind != LayerKind::kUniform && kind != LayerKind::kHalfPlane && kind != LayerKind::kFade;
}

/// The widest edge for which two opposite edges do not overlap.
double widestEdge(const Layer& layer) {
  switch (layer.kind) {
    case LayerKind::kDisk:
      return 2 * layer.size;
    case LayerKind::kRing:
      return std::min(layer.size - layer.inner, 2 * layer.inner);
    case LayerKind::kStripes:
      return std::min(layer.inner, 1 - layer.inner) * layer.size;
    case LayerKind::kChecker:
      return layer.size;
    case LayerKind::kImage:
    case LayerKind::kGrid:
      return std::min(layer.size, layer.inner);
    default:
      return kLargestPlace;
  }
}

Problem outsideInner(const Layer& layer) {
  const char* field = "inner";
  switch (layer.kind) {
    case LayerKind::kRing:
    case LayerKind::kRadialGradient: {
      const bool ring = layer.kind == LayerKind::kRing;
      const bool low = ring ? layer.inner > 0 : layer.inner >= 0;
      if (low && layer.inner < layer.size) return {};
      return std::string(field) + " = " + text(layer.inner) + " m, allowed: " +
             (ring ? "above 0 and below size = " : "0 or more and below size = ") +
             text(layer.size) + " m";
    }
    case LayerKind::kStripes:
      if (layer.inner > 0 && layer.inner < 1) return {};
      return std::string(field) + " = " + text(layer.inner) +
             ", allowed: a share of the period above 0 and below 1";
    case LayerKind::kImage:
    case LayerKind::kGrid:
      return outside(field, layer.inner, kSmallestSize, kLargestPlace, " m");
    default:
      return outside(field, layer.inner, 0, kLargestPlace, " m");
  }
}

Problem imageProblem(const Layer& layer) {
  const bool hexadecimal = layer.image.size() == 64 &&
                           layer.image.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (!hexadecimal) {
    return "image = \"" + layer.image.substr(0, 80) +
           "\", allowed: a SHA-256 in 64 lower-case hexadecimal digits";
  }
  if (!layer.pixels) {
    return "image = " + layer.image + ", allowed: the SHA-256 of an image that was loaded here";
  }
  if (layer.pixels->sha256 != layer.image) {
    return "image = " + layer.image + ", allowed: that of its pixels, " + layer.pixels->sha256;
  }
  return {};
}

Problem gridProblem(const Layer& layer) {
  if (!layer.pixels) return "grid = no pixels, allowed: columns x rows of them";
  const Image& grid = *layer.pixels;
  Problem problem = outside("columns", grid.columns, 1, kMostColumns, "");
  if (!problem) problem = outside("rows", grid.rows, 1, kMostRows, "");
  if (problem) return problem;
  const std::size_t wanted =
      static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows);
  if (grid.grey.size() == wanted) return {};
  return "grid = " + std::to_string(grid.grey.size()) +
         " pixels, allowed: columns x rows = " + std::to_string(wanted);
}

}  // namespace

std::optional<std::string> validate(const Layer& layer) {
  const int kind = static_cast<int>(layer.kind);
  const int blend = static_cast<int>(layer.blend);
  if (kind < 1 || kind > static_cast<int>(kLastKind)) {
    return "kind = " + std::to_string(kind) + ", allowed: 1 to " +
           std::to_string(static_cast<int>(kLastKind));
  }
  if (blend < 0 || blend > static_cast<int>(Blend::kMin)) {
    return "blend = " + std::to_string(blend) + ", allowed: 0 to 4";
  }
  const double smallest = readsSize(layer.kind) ? kSmallestSize : 0;
  Problem problem = outside("x", layer.x, -kFurthestPlace, kFurthestPlace, " m");
  if (!problem) problem = outside("y", layer.y, -kFurthestPlace, kFurthestPlace, " m");
  if (!problem) problem = outside("angle", layer.angle, -kLargestAngle, kLargestAngle, " rad");
  if (!problem) problem = outside("size", layer.size, smallest, kLargestPlace, " m");
  if (!problem) problem = outsideInner(layer);
  if (!problem) problem = outside("softness", layer.softness, 0, widestEdge(layer), " m");
  if (!problem) problem = outside("intensity", layer.intensity, 0, 1, "");
  if (!problem) problem = outside("intensity2", layer.intensity2, 0, 1, "");
  if (!problem) problem = outside("phase", layer.phase, -kLargestPhase, kLargestPhase, "");
  if (!problem && layer.kind == LayerKind::kImage) problem = imageProblem(layer);
  if (!problem && layer.kind == LayerKind::kGrid) problem = gridProblem(layer);
  return problem;
}

std::optional<std::string> validate(const std::vector<Layer>& layers) {
  if (layers.size() > kMostLayers) {
    return "layers = " + std::to_string(layers.size()) + " layers, allowed: at most " +
           std::to_string(kMostLayers);
  }
  for (std::size_t i = 0; i < layers.size(); ++i) {
    if (const Problem problem = validate(layers[i])) {
      return "layers[" + std::to_string(i) + "]." + *problem;
    }
  }
  return {};
}

}  // namespace lab::light
