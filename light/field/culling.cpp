// Simplifies a light field inside a small disk, where most layers have no edge.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "light/field/field.hpp"
#include "light/field/image.hpp"

namespace lab::light {

namespace {

constexpr double kGuard = 1e-9;  // [m] displacement of an edge by rounding

/// Range of a quantity over the disk.
struct Span {
  double least = 0;
  double most = 0;
};

/// Whether a layer covers all of the disk, nothing of it, or has an edge in it.
enum class Share : std::int8_t { kNone, kSome, kAll };

Share both(Share a, Share b) {
  if (a == Share::kNone || b == Share::kNone) return Share::kNone;
  return a == Share::kAll && b == Share::kAll ? Share::kAll : Share::kSome;
}

}  // namespace

struct CompiledLayers::Culling {
  explicit Culling(const Disk& the_disk) : disk(the_disk), radius(the_disk.radius + kGuard) {}

  const Disk& disk;
  double radius;

  /// Range of a quantity with a slope of at most 1.
  [[nodiscard]] Span around(double middle) const { return {middle - radius, middle + radius}; }

  /// Of E over a range of signed distances.
  static Share edge(const Entry& entry, const Span& distance) {
    if (entry.slope * distance.least + entry.offset >= 1) return Share::kAll;
    return entry.slope * distance.most + entry.offset <= 0 ? Share::kNone : Share::kSome;
  }

  /// Of a ramp that is 0 at `from` and 1 at `from + length`.
  static Share run(const Span& place, double from, double length) {
    if (place.least >= from + length) return Share::kAll;
    return place.most <= from ? Share::kNone : Share::kSome;
  }

  static Entry uniform(const Entry& entry, double value) {
    Entry out{};
    out.kind = LayerKind::kUniform;
    out.blend = entry.blend;
    out.value = value;
    return out;
  }

  /// A layer of cover 1 that has value2 where `second` is set.
  static std::optional<Entry> oneOf(const Entry& entry, Share second) {
    if (second == Share::kNone) return uniform(entry, entry.value);
    if (second == Share::kAll)
      return uniform(entry, entry.value + 1 * (entry.value2 - entry.value));
    return entry;
  }

  static std::optional<Entry> covered(const Entry& entry, Share cover) {
    if (cover == Share::kNone) return {};
    return cover == Share::kAll ? uniform(entry, entry.value) : entry;
  }

  /// Whether a band of half width `half` around a multiple of the period covers the disk, along one
  /// axis.
  [[nodiscard]] Share inStripe(const Entry& entry, double place, double period, double half) const {
    const double off = std::abs(place - period * std::floor(place / period + 0.5));
    return edge(entry, around(half - off));
  }

  /// The grey value if bilinear interpolation reads only one; else empty.
  [[nodiscard]] std::optional<std::uint8_t> oneGrey(const Entry& entry, double across,
                                                    double up) const {
    const Image& image = *entry.pixels;
    const auto range = [this](double middle, double half, int count) {
      const double at = (0.5 + 0.5 * middle / half) * count - 0.5;
      const double reach = 0.5 * radius / half * count;
      const auto inside = [&](double place) {
        return static_cast<int>(std::clamp(place, 0.0, count - 1.0));
      };
      return std::pair(inside(std::floor(at - reach)), inside(std::ceil(at + reach)));
    };
    const auto [left, right] = range(across, entry.outer, image.columns);
    const auto [top, bottom] = range(-up, entry.inner, image.rows);
    const auto at = [&](int row, int column) {
      return image.grey[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.columns) +
                        static_cast<std::size_t>(column)];
    };
    const std::uint8_t first = at(top, left);
    for (int row = top; row <= bottom; ++row) {
      for (int column = left; column <= right; ++column) {
        if (at(row, column) != first) return {};
      }
    }
    return first;
  }

  [[nodiscard]] std::optional<Entry> picture(const Entry& entry, double u, double w) const {
    const Span inside = around(std::min(entry.outer - std::abs(u), entry.inner - std::abs(w)));
    const Share cover = edge(entry, inside);
    if (cover == Share::kNone) return {};
    if (cover == Share::kAll && entry.pixels) {
      if (const auto grey = oneGrey(entry, u, w)) {
        const double dark = 1 - *grey / 255.0;
        return uniform(entry, entry.value + dark * (entry.value2 - entry.value));
      }
    }
    return entry;
  }

  /// The remainder of one layer; empty if nothing is left.
  [[nodiscard]] std::optional<Entry> part(const Entry& entry) const {
    const double from_x = disk.x - entry.x;
    const double from_y = disk.y - entry.y;
    const double u = entry.cosine * from_x + entry.sine * from_y;
    const double w = entry.cosine * from_y - entry.sine * from_x;
    const double r = std::sqrt(from_x * from_x + from_y * from_y);
    switch (entry.kind) {
      case LayerKind::kHalfPlane:
        return covered(entry, edge(entry, around(u)));
      case LayerKind::kDisk:
        return covered(entry, edge(entry, around(entry.outer - r)));
      case LayerKind::kRing:
        return covered(entry, both(edge(entry, around(entry.outer - r)),
                                   edge(entry, around(r - entry.inner))));
      case LayerKind::kLinearGradient:
        return oneOf(entry, run(around(u), -0.5 * entry.length, entry.length));
      case LayerKind::kRadialGradient:
        return oneOf(entry, run(around(r), entry.inner, entry.length));
      case LayerKind::kStripes: {
        const Share first = inStripe(entry, u, entry.length, entry.inner);
        if (first == Share::kSome) return entry;
        return oneOf(entry, first == Share::kAll ? Share::kNone : Share::kAll);
      }
      case LayerKind::kChecker: {
        const Share a = inStripe(entry, u, 2 * entry.length, 0.5 * entry.length);
        const Share b = inStripe(entry, w, 2 * entry.length, 0.5 * entry.length);
        if (a == Share::kSome || b == Share::kSome) return entry;
        return oneOf(entry, a == b ? Share::kNone : Share::kAll);
      }
      case LayerKind::kImage:
      case LayerKind::kGrid:
        return picture(entry, u, w);
      default:
        return entry;
    }
  }

  static bool coversAll(const Entry& entry) {
    switch (entry.kind) {
      case LayerKind::kUniform:
      case LayerKind::kLinearGradient:
      case LayerKind::kRadialGradient:
      case LayerKind::kStripes:
      case LayerKind::kChecker:
      case LayerKind::kNoise:
      case LayerKind::kWave:
        return entry.blend == Blend::kOver;
      default:
        return false;
    }
  }

  static bool changesNothing(const Entry& entry) {
    if (entry.kind != LayerKind::kUniform) return false;
    return (entry.blend == Blend::kMultiply && entry.value == 1) ||
           ((entry.blend == Blend::kAdd || entry.blend == Blend::kMax) && entry.value == 0);
  }
};

CompiledLayers CompiledLayers::within(const Disk& disk) const {
  const Culling culling(disk);
  CompiledLayers out;
  out.entries_.reserve(entries_.size());
  std::size_t bottom = 0;  // start of the picture that is being composed
  for (const Entry& entry : entries_) {
    if (entry.kind == LayerKind::kFade) {
      out.entries_.push_back(entry);
      bottom = out.entries_.size();
      continue;
    }
    const std::optional<Entry> part = culling.part(entry);
    if (!part || Culling::changesNothing(*part)) continue;
    if (Culling::coversAll(*part)) {
      out.entries_.erase(out.entries_.begin() + static_cast<std::ptrdiff_t>(bottom),
                         out.entries_.end());
    }
    out.entries_.push_back(*part);
  }
  out.noteUniform();
  if (out.uniform_) {  // equal light gives equal results whatever its layers are
    Entry entry{};
    entry.kind = LayerKind::kUniform;
    entry.value = out.uniform_value_;
    out.entries_.assign(1, entry);
  }
  return out;
}

CompiledField CompiledField::within(const Disk& disk) const {
  CompiledField out;
  out.layers_ = layers_.within(disk);
  if (mix_ >= 1) return out;
  out.previous_ = previous_.within(disk);
  out.mix_ = mix_;
  return out;
}

}  // namespace lab::light
