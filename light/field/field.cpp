#include "light/field/field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>

#include "light/field/image.hpp"
#include "light/field/target_clones.hpp"

namespace lab::light {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr std::size_t kBlock = 64;  // places whose values fit into the first-level cache

double clampToShown(double intensity) { return std::min(std::max(intensity, 0.0), 1.0); }

double blended(Blend blend, double below, double value) {
  switch (blend) {
    case Blend::kOver:
      return value;
    case Blend::kAdd:
      return below + value;
    case Blend::kMultiply:
      return below * value;
    case Blend::kMax:
      return std::max(below, value);
    case Blend::kMin:
      return std::min(below, value);
  }
  return below;
}

/// Distance from the nearest multiple of `period`.
double fromNearestMultiple(double place, double period) {
  return std::abs(place - period * std::floor(place / period + 0.5));
}

/// Calls `function` with the kind as a template argument, so that its loops contain no branch on
/// it.
template <class Function>
auto withKind(LayerKind kind, Function&& function) {
  switch (kind) {
    case LayerKind::kHalfPlane:
      return function.template operator()<LayerKind::kHalfPlane>();
    case LayerKind::kDisk:
      return function.template operator()<LayerKind::kDisk>();
    case LayerKind::kRing:
      return function.template operator()<LayerKind::kRing>();
    case LayerKind::kLinearGradient:
      return function.template operator()<LayerKind::kLinearGradient>();
    case LayerKind::kRadialGradient:
      return function.template operator()<LayerKind::kRadialGradient>();
    case LayerKind::kStripes:
      return function.template operator()<LayerKind::kStripes>();
    case LayerKind::kChecker:
      return function.template operator()<LayerKind::kChecker>();
    case LayerKind::kImage:
    case LayerKind::kGrid:
      return function.template operator()<LayerKind::kImage>();
    case LayerKind::kNoise:
      return function.template operator()<LayerKind::kNoise>();
    case LayerKind::kWave:
      return function.template operator()<LayerKind::kWave>();
    default:
      return function.template operator()<LayerKind::kUniform>();
  }
}

bool allUniform(const std::vector<Layer>& layers) {
  return std::all_of(layers.begin(), layers.end(), [](const Layer& layer) {
    return layer.kind == LayerKind::kUniform || layer.kind == LayerKind::kFade;
  });
}

}  // namespace

struct CompiledLayers::Paint {
  double value;
  double cover;
};

/// State kept from one place to the next.
template <LayerKind kKind>
struct CompiledLayers::Reader {
  explicit Reader(const Entry&) {}
};

template <>
struct CompiledLayers::Reader<LayerKind::kNoise> {
  explicit Reader(const Entry& entry) : noise(entry.noise) {}
  NoiseReader noise;
};

CompiledLayers::Entry CompiledLayers::compile(const Layer& layer) {
  Entry entry{};
  entry.kind = layer.kind;
  entry.blend = layer.blend;
  entry.x = layer.x;
  entry.y = layer.y;
  entry.cosine = std::cos(layer.angle);
  entry.sine = std::sin(layer.angle);
  entry.outer = layer.size;
  entry.inner = layer.inner;
  entry.length = layer.size;
  entry.value = layer.intensity;
  entry.value2 = layer.intensity2;
  entry.reach = std::numeric_limits<double>::infinity();
  // A step is an edge so steep that any distance saturates it; the line itself is fully covered.
  const bool step = layer.softness <= 0;
  entry.slope = step ? 1e200 : 1 / layer.softness;
  entry.offset = step ? 1 : 0.5;
  const double spill = 0.5 * layer.softness;
  switch (layer.kind) {
    case LayerKind::kDisk:
    case LayerKind::kRing:
      entry.reach = layer.size + spill;
      break;
    case LayerKind::kRadialGradient:
      entry.length = layer.size - layer.inner;
      break;
    case LayerKind::kStripes:
      entry.inner = 0.5 * layer.inner * layer.size;
      break;
    case LayerKind::kWave:
      // Removing full turns keeps the precision of the phase after any time.
      entry.phase = std::remainder(layer.phase, kTurn);
      break;
    case LayerKind::kNoise:
      entry.noise = Noise(layer.seed, layer.phase);
      break;
    case LayerKind::kImage:
    case LayerKind::kGrid:
      entry.outer = 0.5 * layer.size;
      entry.inner = 0.5 * layer.inner;
      entry.reach = std::hypot(entry.outer, entry.inner) + layer.softness;
      entry.pixels = layer.pixels;
      break;
    default:
      break;
  }
  return entry;
}

template <LayerKind kKind>
inline CompiledLayers::Paint CompiledLayers::paint(const Entry& entry,
                                                   [[maybe_unused]] Reader<kKind>& reader, double x,
                                                   double y) {
  const double from_x = x - entry.x;
  const double from_y = y - entry.y;
  const auto u = [&] { return entry.cosine * from_x + entry.sine * from_y; };
  const auto w = [&] { return entry.cosine * from_y - entry.sine * from_x; };
  const auto r = [&] { return std::sqrt(from_x * from_x + from_y * from_y); };
  const auto edge = [&](double distance) {
    const double t = clampToShown(entry.slope * distance + entry.offset);
    return t * t * (3 - 2 * t);
  };
  const auto between = [&](double share2) {
    return entry.value + share2 * (entry.value2 - entry.value);
  };
  if constexpr (kKind == LayerKind::kHalfPlane) {
    return {entry.value, edge(u())};
  } else if constexpr (kKind == LayerKind::kDisk) {
    return {entry.value, edge(entry.outer - r())};
  } else if constexpr (kKind == LayerKind::kRing) {
    const double radius = r();
    return {entry.value, edge(entry.outer - radius) * edge(radius - entry.inner)};
  } else if constexpr (kKind == LayerKind::kLinearGradient) {
    return {between(clampToShown(u() / entry.length + 0.5)), 1};
  } else if constexpr (kKind == LayerKind::kRadialGradient) {
    return {between(clampToShown((r() - entry.inner) / entry.length)), 1};
  } else if constexpr (kKind == LayerKind::kStripes) {
    return {between(1 - edge(entry.inner - fromNearestMultiple(u(), entry.length))), 1};
  } else if constexpr (kKind == LayerKind::kChecker) {
    const auto wave = [&](double place) {
      return 2 * edge(0.5 * entry.length - fromNearestMultiple(place, 2 * entry.length)) - 1;
    };
    return {between(0.5 - 0.5 * wave(u()) * wave(w())), 1};
  } else if constexpr (kKind == LayerKind::kImage) {
    const double across = u();
    const double up = w();
    const double cover = edge(std::min(entry.outer - std::abs(across), entry.inner - std::abs(up)));
    const double grey = entry.pixels ? sample(*entry.pixels, 0.5 + 0.5 * across / entry.outer,
                                              0.5 + 0.5 * up / entry.inner)
                                     : 0;
    return {between(1 - grey), cover};
  } else if constexpr (kKind == LayerKind::kNoise) {
    return {between(1 - reader.noise.at(u() / entry.length, w() / entry.length)), 1};
  } else if constexpr (kKind == LayerKind::kWave) {
    return {between(0.5 - 0.5 * std::cos(kTurn * u() / entry.length - entry.phase)), 1};
  } else {
    return {entry.value, 1};
  }
}

CompiledLayers::Paint CompiledLayers::paint(const Entry& entry, double x, double y) {
  return withKind(entry.kind, [&]<LayerKind kKind>() {
    Reader<kKind> reader(entry);
    return paint<kKind>(entry, reader, x, y);
  });
}

template <LayerKind kKind>
void CompiledLayers::paintRow(const Entry& entry, double first_x, double step, double y,
                              std::size_t count, double* row) {
  if (std::abs(y - entry.y) > entry.reach) return;
  Reader<kKind> reader(entry);
  for (std::size_t i = 0; i < count; ++i) {
    const double x = first_x + static_cast<double>(i) * step;
    const Paint painted = paint<kKind>(entry, reader, x, y);
    row[i] += painted.cover * (blended(entry.blend, row[i], painted.value) - row[i]);
  }
}

CompiledLayers::CompiledLayers(const std::vector<Layer>& layers) {
  entries_.reserve(layers.size());
  for (const Layer& layer : layers) entries_.push_back(compile(layer));
  noteUniform();
}

void CompiledLayers::noteUniform() {
  const bool uniform = std::all_of(entries_.begin(), entries_.end(), [](const Entry& entry) {
    return entry.kind == LayerKind::kUniform || entry.kind == LayerKind::kFade;
  });
  uniform_ = false;  // evaluate() must evaluate the layers for this value
  uniform_value_ = uniform ? evaluate(0, 0) : 0;
  uniform_ = uniform;
}

double CompiledLayers::evaluate(double x, double y) const {
  if (uniform_) return uniform_value_;
  double shown = 0;
  double share = 1;
  double intensity = 0;
  for (const Entry& entry : entries_) {
    if (entry.kind == LayerKind::kFade) {
      shown += share * (clampToShown(intensity) - shown);
      share = entry.value;
      intensity = 0;
    } else {
      const Paint painted = paint(entry, x, y);
      intensity += painted.cover * (blended(entry.blend, intensity, painted.value) - intensity);
    }
  }
  return shown + share * (clampToShown(intensity) - shown);
}

void CompiledLayers::evaluateRow(double first_x, double step, double y, std::size_t count,
                                 double* out) const {
  if (uniform_) {
    std::fill_n(out, count, uniform_value_);
    return;
  }
  std::vector<double> row(count, 0);
  std::fill_n(out, count, 0.0);
  double share = 1;
  const auto finish_picture = [&] {
    for (std::size_t i = 0; i < count; ++i) out[i] += share * (clampToShown(row[i]) - out[i]);
  };
  for (const Entry& entry : entries_) {
    if (entry.kind == LayerKind::kFade) {
      finish_picture();
      share = entry.value;
      std::fill(row.begin(), row.end(), 0.0);
    } else {
      withKind(entry.kind, [&]<LayerKind kKind>() {
        paintRow<kKind>(entry, first_x, step, y, count, row.data());
      });
    }
  }
  finish_picture();
}

/// One block of at most kBlock places: first values and covers, then blending, so that the loops
/// contain no branches on kind and blend.
LAB_TARGET_CLONES __attribute__((flatten)) void CompiledLayers::paintAt(
    const Entry& entry, const double* x, const double* y, std::size_t count, double* row) {
  std::array<double, kBlock> value;
  std::array<double, kBlock> cover;
  withKind(entry.kind, [&]<LayerKind kKind>() {
    Reader<kKind> reader(entry);
    for (std::size_t i = 0; i < count; ++i) {
      const Paint painted = paint<kKind>(entry, reader, x[i], y[i]);
      value[i] = painted.value;
      cover[i] = painted.cover;
    }
  });
  const auto blend = [&](auto constant) {
    for (std::size_t i = 0; i < count; ++i) {
      row[i] += cover[i] * (blended(constant, row[i], value[i]) - row[i]);
    }
  };
  switch (entry.blend) {
    case Blend::kOver:
      return blend(std::integral_constant<Blend, Blend::kOver>{});
    case Blend::kAdd:
      return blend(std::integral_constant<Blend, Blend::kAdd>{});
    case Blend::kMultiply:
      return blend(std::integral_constant<Blend, Blend::kMultiply>{});
    case Blend::kMax:
      return blend(std::integral_constant<Blend, Blend::kMax>{});
    case Blend::kMin:
      return blend(std::integral_constant<Blend, Blend::kMin>{});
  }
}

void CompiledLayers::evaluateAt(const double* x, const double* y, std::size_t count,
                                double* out) const {
  if (uniform_) {
    std::fill_n(out, count, uniform_value_);
    return;
  }
  std::array<double, kBlock> row;
  for (std::size_t from = 0; from < count; from += kBlock) {
    const std::size_t block = std::min(kBlock, count - from);
    double* const shown = out + from;
    double share = 1;
    const auto begin = [&] { std::fill_n(row.data(), block, 0.0); };
    const auto finish = [&] {
      for (std::size_t i = 0; i < block; ++i) {
        shown[i] += share * (clampToShown(row[i]) - shown[i]);
      }
    };
    std::fill_n(shown, block, 0.0);
    begin();
    for (const Entry& entry : entries_) {
      if (entry.kind == LayerKind::kFade) {
        finish();
        share = entry.value;
        begin();
      } else {
        paintAt(entry, x + from, y + from, block, row.data());
      }
    }
    finish();
  }
}

CompiledField::CompiledField(const Field& field) : layers_(field.layers), mix_(field.mix) {
  if (isMoving(field)) previous_ = CompiledLayers(field.previous);
}

double CompiledField::evaluate(double x, double y) const {
  const double intensity = layers_.evaluate(x, y);
  if (mix_ >= 1) return intensity;
  const double before = previous_.evaluate(x, y);
  return before + mix_ * (intensity - before);
}

double CompiledField::evaluateOverDisk(double x, double y, double radius) const {
  if (isUniform()) return evaluate(x, y);
  // Six points on the circle of radius sqrt(2/3), 60 degrees apart.
  const double a = radius * std::sqrt(2.0 / 3);
  const double half = 0.5 * a;
  const double high = radius * std::sqrt(0.5);
  const double around = evaluate(x + a, y) + evaluate(x - a, y) + evaluate(x + half, y + high) +
                        evaluate(x - half, y + high) + evaluate(x - half, y - high) +
                        evaluate(x + half, y - high);
  return 0.25 * evaluate(x, y) + 0.125 * around;
}

void CompiledField::evaluateRow(double first_x, double step, double y, std::size_t count,
                                double* out) const {
  layers_.evaluateRow(first_x, step, y, count, out);
  if (mix_ >= 1) return;
  std::vector<double> before(count);
  previous_.evaluateRow(first_x, step, y, count, before.data());
  for (std::size_t i = 0; i < count; ++i) out[i] = before[i] + mix_ * (out[i] - before[i]);
}

void CompiledField::evaluateAt(const double* x, const double* y, std::size_t count,
                               double* out) const {
  layers_.evaluateAt(x, y, count, out);
  if (mix_ >= 1) return;
  std::vector<double> before(count);
  previous_.evaluateAt(x, y, count, before.data());
  for (std::size_t i = 0; i < count; ++i) out[i] = before[i] + mix_ * (out[i] - before[i]);
}

bool isUniform(const Field& field) {
  return allUniform(field.layers) && (!isMoving(field) || allUniform(field.previous));
}

double evaluate(const Field& field, double x, double y) {
  return CompiledField(field).evaluate(x, y);
}

double evaluateOverDisk(const Field& field, double x, double y, double radius) {
  return CompiledField(field).evaluateOverDisk(x, y, radius);
}

}  // namespace lab::light
