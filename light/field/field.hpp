/// The light field: intensity as a function of place, the same for the projector, the simulated
/// light sensors and the rendered camera.
///
/// Intensity is 0 (projector black) .. 1 (projector white), in the arena frame, at the height of
/// the robots' light sensors, 5 cm above the floor, where it selects a program. Light at other
/// heights (the floor, a cap in a camera view) follows from it by the projector's geometry.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "light/field/layer.hpp"
#include "light/field/noise.hpp"

namespace lab::light {

/// Shown light: I(x, y) = (1 - mix) previous(x, y) + mix layers(x, y).
///
/// A list of layers is composed from I = 0 upwards (layer.hpp), unclamped between layers, and the
/// result is clamped to 0..1. So an empty list is dark, and lights may add up to more than white
/// before a mask reduces them.
struct Field {
  std::vector<Layer> layers;
  std::vector<Layer> previous;  ///< read only while mix < 1
  double mix = 1;               ///< [1] 0..1

  bool operator==(const Field&) const = default;
};

/// Whether the intensity is the same everywhere. Detected only for uniform layers and fades; fields
/// of other kinds are reported as not uniform.
[[nodiscard]] bool isUniform(const Field& field);

/// Whether a cross-fade is in progress, so that the field changes without a new command.
[[nodiscard]] inline bool isMoving(const Field& field) { return field.mix < 1; }

/// The places within `radius` [m] of (x, y) [m].
struct Disk {
  double x = 0;
  double y = 0;
  double radius = 0;
};

/// A list of layers prepared for evaluation. Shares ownership of the images' pixels.
class CompiledLayers {
 public:
  CompiledLayers() = default;

  /// @param layers must pass validate(). A kImage layer without pixels counts as black.
  explicit CompiledLayers(const std::vector<Layer>& layers);

  /// Intensity at (x, y) [m].
  [[nodiscard]] double evaluate(double x, double y) const;

  /// Intensity at `count` places of one row, at x = first_x + i step [m]: bit-equal to evaluate(),
  /// several times faster.
  void evaluateRow(double first_x, double step, double y, std::size_t count, double* out) const;

  /// Intensity at `count` places (x[i], y[i]): bit-equal to evaluate(), several times faster.
  void evaluateAt(const double* x, const double* y, std::size_t count, double* out) const;

  /// An equivalent list inside the disk with as few layers as possible (culling.cpp): without
  /// layers that paint nothing there or are covered by an opaque one, and with uniform light where
  /// no edge is inside. Equal up to the rounding of the last bit.
  [[nodiscard]] CompiledLayers within(const Disk& disk) const;

  [[nodiscard]] bool isUniform() const { return uniform_; }

  /// Whether they have the same layers; images are compared by identity.
  bool operator==(const CompiledLayers&) const = default;

 private:
  struct Entry {
    LayerKind kind;
    Blend blend;
    double x, y, cosine, sine;
    double outer, inner;   ///< [m] as used by the kind, half lengths for symmetric shapes
    double length;         ///< [m] a period or the length of a gradient
    double slope, offset;  ///< of t = slope d + offset in E(d) (layer.hpp)
    double value, value2;
    double reach;  ///< [m] distance from (x, y) beyond which nothing is painted
    double phase;
    Noise noise;
    std::shared_ptr<const Image> pixels;

    bool operator==(const Entry&) const = default;
  };
  struct Paint;
  template <LayerKind kKind>
  struct Reader;
  struct Culling;

  static Entry compile(const Layer& layer);
  template <LayerKind kKind>
  static Paint paint(const Entry& entry, Reader<kKind>& reader, double x, double y);
  static Paint paint(const Entry& entry, double x, double y);
  template <LayerKind kKind>
  static void paintRow(const Entry& entry, double first_x, double step, double y, std::size_t count,
                       double* row);

  static void paintAt(const Entry& entry, const double* x, const double* y, std::size_t count,
                      double* row);
  void noteUniform();

  std::vector<Entry> entries_;
  bool uniform_ = true;
  double uniform_value_ = 0;
};

/// A field prepared for evaluation. Compile once per change; evaluation at sensors or pixels is
/// then fast.
class CompiledField {
 public:
  CompiledField() = default;

  /// @param field its layers must pass validate()
  explicit CompiledField(const Field& field);

  /// Intensity at (x, y) [m].
  [[nodiscard]] double evaluate(double x, double y) const;

  /// Mean intensity over the disk of `radius` [m] around (x, y), the window of a light sensor:
  /// seven points, exact for polynomials up to degree 5 (Stroud 1971, S2: 5-1: the centre with
  /// weight 1/4 and six points at sqrt(2/3) radius with 1/8 each). Across a hard edge it changes in
  /// steps of 1/8 and 1/4.
  [[nodiscard]] double evaluateOverDisk(double x, double y, double radius) const;

  /// evaluate() for one row: see CompiledLayers::evaluateRow().
  void evaluateRow(double first_x, double step, double y, std::size_t count, double* out) const;

  /// evaluate() at many places: see CompiledLayers::evaluateAt().
  void evaluateAt(const double* x, const double* y, std::size_t count, double* out) const;

  /// See CompiledLayers::within().
  [[nodiscard]] CompiledField within(const Disk& disk) const;

  [[nodiscard]] bool isUniform() const { return layers_.isUniform() && previous_.isUniform(); }

  bool operator==(const CompiledField&) const = default;

 private:
  CompiledLayers layers_;
  CompiledLayers previous_;
  double mix_ = 1;
};

/// Intensity at (x, y) [m]; compiles the field for this one place.
[[nodiscard]] double evaluate(const Field& field, double x, double y);

/// CompiledField::evaluateOverDisk(); compiles the field for this one disk.
[[nodiscard]] double evaluateOverDisk(const Field& field, double x, double y, double radius);

}  // namespace lab::light
