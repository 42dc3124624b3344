/// The light field: intensity as a function of place, the same for the projector, the simulated
/// light sensors and the rendered camera.
///
/// Intensity is 0 (projector black) .. 1 (projector white), in the arena frame, at the height of
/// the robots' light sensors, 5 cm above the floor: that is where it selects a program. What lies
/// at another height (the floor, a cap in a camera view) is derived from it by the projector's
/// geometry.
#pragma once

#include <cstdint>
#include <vector>

#include "light/field/layer.hpp"
#include "light/field/noise.hpp"

namespace lab::light {

/// What is shown: I(x, y) = (1 - mix) previous(x, y) + mix layers(x, y).
///
/// A list of layers is composed from I = 0 upwards (layer.hpp), unclamped between layers, and its
/// result clamped to 0..1: an empty list is dark, and two lights may add up above white before a
/// mask takes some away.
struct Field {
  std::vector<Layer> layers;
  std::vector<Layer> previous;  ///< read only while mix < 1
  double mix = 1;               ///< [1] 0..1

  bool operator==(const Field&) const = default;
};

/// Whether the intensity is the same everywhere. True only for fields of uniform layers (and
/// fades): a uniform field painted by other kinds is still called not uniform.
[[nodiscard]] bool isUniform(const Field& field);

/// Whether a cross-fade is under way, so that the field changes without a new command.
[[nodiscard]] inline bool isMoving(const Field& field) { return field.mix < 1; }

/// The places within `radius` of (x, y) [m].
struct Disc {
  double x = 0;
  double y = 0;
  double radius = 0;
};

/// A list of layers made ready for evaluation. It keeps the pixels of its images alive.
class CompiledLayers {
 public:
  CompiledLayers() = default;

  /// @param layers must pass validate(). A kImage layer without pixels counts as black.
  explicit CompiledLayers(const std::vector<Layer>& layers);

  /// Intensity at (x, y) [m].
  [[nodiscard]] double evaluate(double x, double y) const;

  /// Intensity at `count` places of one row, at x = first_x + i step [m]: the same numbers as
  /// evaluate(), several times faster.
  void evaluateRow(double first_x, double step, double y, std::size_t count, double* out) const;

  /// Intensity at `count` places (x[i], y[i]): the same numbers as evaluate(), several times
  /// faster.
  void evaluateAt(const double* x, const double* y, std::size_t count, double* out) const;

  /// What shows the same inside the disc with as few layers as possible (culling.cpp): none that
  /// paints nothing there or lies under an opaque one, light of one value where an edge is out of
  /// sight. The numbers are the same but for the rounding of the last bit.
  [[nodiscard]] CompiledLayers within(const Disc& disc) const;

  [[nodiscard]] bool isUniform() const { return uniform_; }

  /// Whether they were made of the same layers; images are compared by identity.
  bool operator==(const CompiledLayers&) const = default;

 private:
  struct Entry {
    LayerKind kind;
    Blend blend;
    double x, y, cosine, sine;
    double outer, inner;   ///< [m] as the kind reads them, half lengths where it is symmetric
    double length;         ///< [m] a period or the run of a gradient
    double slope, offset;  ///< of E's t: t = slope d + offset
    double value, value2;
    double reach;  ///< [m] nothing is painted further from (x, y)
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

/// A field made ready for evaluation. Compile once a change; then N sensors or every pixel are
/// cheap.
class CompiledField {
 public:
  CompiledField() = default;

  /// @param field whose layers pass validate().
  explicit CompiledField(const Field& field);

  /// Intensity at (x, y) [m].
  [[nodiscard]] double evaluate(double x, double y) const;

  /// Mean intensity over the disk of `radius` [m] around (x, y), a light sensor's window: seven
  /// points, exact for polynomials up to degree 5 (Stroud 1971, S2: 5-1: the centre with weight 1/4
  /// and six points at sqrt(2/3) radius with 1/8 each). Across a hard edge it is a staircase with
  /// steps of 1/8 and 1/4.
  [[nodiscard]] double evaluateOverDisk(double x, double y, double radius) const;

  /// evaluate() for one row: see CompiledLayers::evaluateRow().
  void evaluateRow(double first_x, double step, double y, std::size_t count, double* out) const;

  /// evaluate() at many places: see CompiledLayers::evaluateAt().
  void evaluateAt(const double* x, const double* y, std::size_t count, double* out) const;

  /// See CompiledLayers::within().
  [[nodiscard]] CompiledField within(const Disc& disc) const;

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
