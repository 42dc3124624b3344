#include "sim_svc/camera/camera_painter_light.hpp"

#include <algorithm>
#include <cmath>

namespace lab::sim::painter {
namespace {

constexpr double kOverscan = 0.05;   // [m] of the projector's picture beyond the walls
constexpr double kAnywhere = 1e3;    // [m] margin if LitPlaces::lit gives the picture's edge
constexpr double kBorder = 0.01;     // [m] width in which the picture fades out
constexpr float kBend = 5e-4F;       // [1] smaller second differences of light are interpolated
constexpr int kTile = 16;            // [px]
constexpr double kLeastCells = 1.5;  // smallest width of an edge

LAB_TARGET_CLONES
void dimBy(const float* __restrict share, float* __restrict light, int count) {
  for (int i = 0; i < count; ++i) light[i] *= share[i];
}

/// Evaluates the light at many points at once, which is several times faster than one by one.
template <class Share>
class Places {
 public:
  /// @param share [1] of the light that reaches a point; negative: none
  Places(const light::CompiledLayers& layers, Share share) : layers_(layers), share_(share) {}

  void add(double x, double y) {
    x_[count_] = x;
    y_[count_++] = y;
  }

  /// The light at the points in the order in which they were added.
  const double* evaluate() {
    layers_.evaluateAt(x_.data(), y_.data(), count_, light_.data());
    for (std::size_t i = 0; i < count_; ++i) {
      const double share = share_(x_[i], y_[i]);
      light_[i] = share > 0 ? share * light_[i] : 0;
    }
    return light_.data();
  }

  void clear() { count_ = 0; }

 private:
  static constexpr std::size_t kMost = 4UL * kTile * kTile;  // the cells of a tile

  const light::CompiledLayers& layers_;
  Share share_;
  std::size_t count_ = 0;
  std::array<double, kMost> x_, y_, light_;
};

}  // namespace

Projection::Projection(const std::vector<light::Layer>& layers, const PainterSettings& settings,
                       double cell)
    : width_(settings.arena_width), height_(settings.arena_height) {
  const double softest = std::max(settings.edge_softness, kLeastCells * cell);
  std::vector<light::Layer> soft = layers;
  for (light::Layer& layer : soft) layer.softness = std::max(layer.softness, softest);
  layers_ = light::CompiledLayers(soft);
  tones_ = settings.tones.areIdentity() ? nullptr
                                        : std::make_shared<const optics::ToneTable>(settings.tones);
}

/// Distance from a point inside the projector's picture to the picture's edge [m]; negative
/// outside.
double Projection::marginInside(const LitPlaces& places, double x, double y) const {
  if (places.lit != nullptr) return kAnywhere;
  return std::min(std::min(x, width_ - x), std::min(y, height_ - y)) + kOverscan;
}

Projection::Tile Projection::tile(const Lattice& lattice, const LitPlaces& places,
                                  const Box& pixels) {
  const PlaneShift& shift = places.shift;
  Tile tile;
  tile.pixels = pixels;
  tile.around = pixels.grown(1).within({0, 0, lattice.columns() / 2, lattice.rows() / 2});
  const std::array<std::size_t, 4> corners = {
      lattice.at(2 * tile.around.x0, 2 * tile.around.y0),
      lattice.at(2 * tile.around.x1 - 1, 2 * tile.around.y0),
      lattice.at(2 * tile.around.x0, 2 * tile.around.y1 - 1),
      lattice.at(2 * tile.around.x1 - 1, 2 * tile.around.y1 - 1)};
  for (const std::size_t at : corners) {
    tile.x += 0.25 * (shift.scale * static_cast<double>(places.x[at]) + shift.x0);
    tile.y += 0.25 * (shift.scale * static_cast<double>(places.y[at]) + shift.y0);
  }
  for (const std::size_t at : corners) {
    tile.radius =
        std::max(tile.radius,
                 std::hypot(shift.scale * static_cast<double>(places.x[at]) + shift.x0 - tile.x,
                            shift.scale * static_cast<double>(places.y[at]) + shift.y0 - tile.y));
  }
  tile.radius *= 1.1;  // a side between two corners may be curved outwards
  return tile;
}

std::vector<Box> Projection::changed(const Projection& before, const Lattice& lattice,
                                     const LitPlaces& places) const {
  std::vector<Box> boxes;
  for (int y = 0; y < lattice.rows() / 2; y += kTile) {
    for (int x = 0; x < lattice.columns() / 2; x += kTile) {
      const Box pixels{x, y, std::min(x + kTile, lattice.columns() / 2),
                       std::min(y + kTile, lattice.rows() / 2)};
      const Tile here = tile(lattice, places, pixels);
      if (marginInside(places, here.x, here.y) <= -here.radius) continue;
      if (layersOf(here) == before.layersOf(here)) continue;
      if (!boxes.empty() && boxes.back().y0 == y && boxes.back().x1 == x) {
        boxes.back().x1 = pixels.x1;
      } else {
        boxes.push_back(pixels);
      }
    }
  }
  return boxes;
}

void Projection::light(const Lattice& lattice, const LitPlaces& places, const Box& cells,
                       std::vector<float>& out) const {
  for (int y = cells.y0 / 2; y < cells.y1 / 2; y += kTile) {
    for (int x = cells.x0 / 2; x < cells.x1 / 2; x += kTile) {
      const Box pixels{x, y, std::min(x + kTile, cells.x1 / 2), std::min(y + kTile, cells.y1 / 2)};
      const Tile here = tile(lattice, places, pixels);
      const double inside = marginInside(places, here.x, here.y);
      const bool lit = inside > -here.radius;
      const light::CompiledLayers layers = lit ? layersOf(here) : light::CompiledLayers();
      if (lit && !(layers.isUniform() && inside > here.radius + kBorder)) {
        paint(layers, here, lattice, places, out);
        continue;
      }
      const auto value = lit ? static_cast<float>(layers.evaluate(here.x, here.y)) : 0.0F;
      for (int j = 2 * pixels.y0; j < 2 * pixels.y1; ++j) {
        std::fill_n(&out[lattice.at(2 * pixels.x0, j)], 2 * pixels.width(), value);
      }
    }
  }
  if (tones_) tone(lattice, places, cells, out);
  if (places.lit == nullptr) return;
  for (int j = cells.y0; j < cells.y1; ++j) {
    const std::size_t at = lattice.at(cells.x0, j);
    dimBy(&places.lit[at], &out[at], cells.width());
  }
}

/// Converts the commanded light into the light that the projector gives.
void Projection::tone(const Lattice& lattice, const LitPlaces& places, const Box& cells,
                      std::vector<float>& out) const {
  const PlaneShift& shift = places.shift;
  for (int j = cells.y0; j < cells.y1; ++j) {
    for (int i = cells.x0; i < cells.x1; ++i) {
      const std::size_t at = lattice.at(i, j);
      if (out[at] <= 0) continue;
      // With geometric errors of the projector, this uses the brightness at the source point, a few
      // millimetres beside the cell.
      const optics::Place source{shift.scale * static_cast<double>(places.x[at]) + shift.x0,
                                 shift.scale * static_cast<double>(places.y[at]) + shift.y0};
      out[at] = static_cast<float>(tones_->light(static_cast<double>(out[at]), source, source));
    }
  }
}

/// Computes one value per pixel and its four cells from the local slopes, or all cells one by one
/// where the light is not linear.
void Projection::paint(const light::CompiledLayers& layers, const Tile& tile,
                       const Lattice& lattice, const LitPlaces& places,
                       std::vector<float>& out) const {
  Places asked(layers, [&](double x, double y) {
    return std::min(marginInside(places, x, y) / kBorder, 1.0);
  });
  const auto ask = [&](double floor_x, double floor_y) {
    asked.add(places.shift.scale * floor_x + places.shift.x0,
              places.shift.scale * floor_y + places.shift.y0);
  };
  constexpr int kSide = kTile + 2;
  std::array<float, kSide * kSide> middle{};
  std::array<bool, kSide * kSide> bent{};
  const Box& around = tile.around;
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>((y - around.y0) * kSide + x - around.x0);
  };
  for (int y = around.y0; y < around.y1; ++y) {
    for (int x = around.x0; x < around.x1; ++x) {
      const std::size_t a = lattice.at(2 * x, 2 * y);
      const std::size_t b = lattice.at(2 * x + 1, 2 * y + 1);
      ask(0.5 * (static_cast<double>(places.x[a]) + static_cast<double>(places.x[b])),
          0.5 * (static_cast<double>(places.y[a]) + static_cast<double>(places.y[b])));
    }
  }
  std::size_t next = 0;
  const double* const lights = asked.evaluate();
  for (int y = around.y0; y < around.y1; ++y) {
    for (int x = around.x0; x < around.x1; ++x) {
      middle[index(x, y)] = static_cast<float>(lights[next++]);
    }
  }
  asked.clear();
  std::array<std::size_t, 4UL * kTile * kTile> cells;
  std::size_t count = 0;
  const auto bends = [&](int x, int y) {
    if (x <= around.x0 || y <= around.y0 || x + 1 >= around.x1 || y + 1 >= around.y1) return true;
    const float here = 2 * middle[index(x, y)];
    return std::abs(middle[index(x - 1, y)] + middle[index(x + 1, y)] - here) > kBend ||
           std::abs(middle[index(x, y - 1)] + middle[index(x, y + 1)] - here) > kBend;
  };
  const Box& pixels = tile.pixels;
  for (int y = pixels.y0; y < pixels.y1; ++y) {
    for (int x = pixels.x0; x < pixels.x1; ++x) bent[index(x, y)] = bends(x, y);
  }
  // If a pixel is not linear, its neighbours are computed cell by cell too: an edge through the
  // middle of a pixel only shows in them. Pixels outside the tile are represented by its border.
  const auto isLinear = [&](int x, int y) {
    const bool border =
        x == pixels.x0 || y == pixels.y0 || x + 1 == pixels.x1 || y + 1 == pixels.y1;
    if (bent[index(x, y)]) return false;
    if (!border) {
      return !bent[index(x - 1, y)] && !bent[index(x + 1, y)] && !bent[index(x, y - 1)] &&
             !bent[index(x, y + 1)];
    }
    const float here = middle[index(x, y)];
    float least = here;
    float most = here;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        least = std::min(least, middle[index(x + dx, y + dy)]);
        most = std::max(most, middle[index(x + dx, y + dy)]);
      }
    }
    return most - least <= 4 * kBend;
  };
  for (int y = pixels.y0; y < pixels.y1; ++y) {
    for (int x = pixels.x0; x < pixels.x1; ++x) {
      if (isLinear(x, y)) {
        const float here = middle[index(x, y)];
        const float right = 0.125F * (middle[index(x + 1, y)] - middle[index(x - 1, y)]);
        const float down = 0.125F * (middle[index(x, y + 1)] - middle[index(x, y - 1)]);
        float* above = &out[lattice.at(2 * x, 2 * y)];
        float* below = &out[lattice.at(2 * x, 2 * y + 1)];
        above[0] = here - right - down;
        above[1] = here + right - down;
        below[0] = here - right + down;
        below[1] = here + right + down;
        continue;
      }
      for (int j = 2 * y; j < 2 * y + 2; ++j) {
        for (int i = 2 * x; i < 2 * x + 2; ++i) {
          const std::size_t at = lattice.at(i, j);
          ask(static_cast<double>(places.x[at]), static_cast<double>(places.y[at]));
          cells[count++] = at;
        }
      }
    }
  }
  asked.evaluate();
  for (std::size_t i = 0; i < count; ++i) out[cells[i]] = static_cast<float>(lights[i]);
}

}  // namespace lab::sim::painter
