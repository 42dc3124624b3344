#include "sim_svc/camera_painter_light.hpp"

#include <cmath>
#include <optional>

#include "sim_svc/camera_painter_ground.hpp"

namespace lab::sim::painter {
namespace {

constexpr double kOverscan = 0.05;  // [m] of the projector's picture beyond the walls
constexpr double kBorder = 0.01;    // [m] in which it fades out
constexpr float kBend = 5e-4F;      // [1] light that bends less from pixel to pixel is interpolated
constexpr int kTile = 16;           // [px]
constexpr double kLeastCells = 1.5;  // that an edge is wide

/// How far (x, y) lies inside the edge of a layer that has one edge or two; less, and more, no
/// place within `radius` does. Empty: the layer is not that simple.
struct Reach {
  double least = 0;
  double most = 0;
};

std::optional<Reach> reach(const light::Layer& layer, double x, double y, double radius) {
  const double from_x = x - layer.x;
  const double from_y = y - layer.y;
  const double r = std::hypot(from_x, from_y);
  double inside = 0;
  switch (layer.kind) {
    case light::LayerKind::kHalfPlane:
      inside = std::cos(layer.angle) * from_x + std::sin(layer.angle) * from_y;
      break;
    case light::LayerKind::kDisk:
      inside = layer.size - r;
      break;
    case light::LayerKind::kRing:
      inside = std::min(layer.size - r, r - layer.inner);
      break;
    case light::LayerKind::kStripes: {
      const double u = std::cos(layer.angle) * from_x + std::sin(layer.angle) * from_y;
      const double off = std::abs(u - layer.size * std::floor(u / layer.size + 0.5));
      inside = 0.5 * layer.inner * layer.size - off;
      break;
    }
    case light::LayerKind::kImage: {
      // Never one value; but out of its rectangle it is nothing.
      const double corner = 0.5 * std::hypot(layer.size, layer.inner);
      inside = std::min(corner - r, -radius);
      break;
    }
    default:
      return std::nullopt;
  }
  return Reach{inside - radius, inside + radius};
}

light::Layer uniform(const light::Layer& layer, double intensity) {
  light::Layer out;
  out.blend = layer.blend;
  out.intensity = intensity;
  return out;
}

}  // namespace

Projection::Projection(const std::vector<light::Layer>& layers, const PainterSettings& settings,
                       double cell)
    : layers_(layers), width_(settings.arena_width), height_(settings.arena_height) {
  const double softest = std::max(settings.edge_softness, kLeastCells * cell);
  for (light::Layer& layer : layers_) layer.softness = std::max(layer.softness, softest);
}

/// How far a place lies inside the projector's picture [m].
double Projection::insideBy(double x, double y) const {
  return std::min(std::min(x, width_ - x), std::min(y, height_ - y)) + kOverscan;
}

Projection::Tile Projection::tile(const Lattice& lattice, const Ground& ground,
                                  const PlaneShift& shift, const Box& pixels) const {
  Tile tile;
  tile.pixels = pixels;
  tile.around = pixels.grown(1).within({0, 0, lattice.columns() / 2, lattice.rows() / 2});
  const std::array<std::size_t, 4> corners = {
      lattice.at(2 * tile.around.x0, 2 * tile.around.y0),
      lattice.at(2 * tile.around.x1 - 1, 2 * tile.around.y0),
      lattice.at(2 * tile.around.x0, 2 * tile.around.y1 - 1),
      lattice.at(2 * tile.around.x1 - 1, 2 * tile.around.y1 - 1)};
  for (const std::size_t at : corners) {
    tile.x += 0.25 * (shift.scale * static_cast<double>(ground.x[at]) + shift.x0);
    tile.y += 0.25 * (shift.scale * static_cast<double>(ground.y[at]) + shift.y0);
  }
  for (const std::size_t at : corners) {
    tile.radius =
        std::max(tile.radius,
                 std::hypot(shift.scale * static_cast<double>(ground.x[at]) + shift.x0 - tile.x,
                            shift.scale * static_cast<double>(ground.y[at]) + shift.y0 - tile.y));
  }
  tile.radius *= 1.1;  // a side between two corners may be bent outwards
  return tile;
}

/// The layers with an edge here, those without as uniform light, those elsewhere not at all.
light::CompiledLayers Projection::layersOf(const Tile& tile) const {
  std::vector<light::Layer> here;
  for (const light::Layer& layer : layers_) {
    const std::optional<Reach> inside = reach(layer, tile.x, tile.y, tile.radius);
    const double half = 0.5 * layer.softness;
    const bool stripes = layer.kind == light::LayerKind::kStripes;
    if (inside && inside->least > half) {
      here.push_back(uniform(layer, layer.intensity));
    } else if (inside && inside->most < -half) {
      if (stripes) here.push_back(uniform(layer, layer.intensity2));
    } else {
      here.push_back(layer);
    }
  }
  return light::CompiledLayers(here);
}

void Projection::light(const Lattice& lattice, const Ground& ground, const PlaneShift& shift,
                       const Box& cells, std::vector<float>& out) const {
  for (int y = cells.y0 / 2; y < cells.y1 / 2; y += kTile) {
    for (int x = cells.x0 / 2; x < cells.x1 / 2; x += kTile) {
      const Box pixels{x, y, std::min(x + kTile, cells.x1 / 2), std::min(y + kTile, cells.y1 / 2)};
      const Tile here = tile(lattice, ground, shift, pixels);
      const double inside = insideBy(here.x, here.y);
      const bool lit = inside > -here.radius;
      const light::CompiledLayers layers = lit ? layersOf(here) : light::CompiledLayers();
      if (lit && !(layers.isUniform() && inside > here.radius + kBorder)) {
        paint(layers, here, lattice, ground, shift, out);
        continue;
      }
      const auto value = lit ? static_cast<float>(layers.evaluate(here.x, here.y)) : 0.0F;
      for (int j = 2 * pixels.y0; j < 2 * pixels.y1; ++j) {
        std::fill_n(&out[lattice.at(2 * pixels.x0, j)], 2 * pixels.width(), value);
      }
    }
  }
}

/// One value a pixel; its four cells by the slopes there, or one by one where the light bends.
void Projection::paint(const light::CompiledLayers& layers, const Tile& tile,
                       const Lattice& lattice, const Ground& ground, const PlaneShift& shift,
                       std::vector<float>& out) const {
  const auto value = [&](double floor_x, double floor_y) {
    const double x = shift.scale * floor_x + shift.x0;
    const double y = shift.scale * floor_y + shift.y0;
    const double shown = std::min(insideBy(x, y) / kBorder, 1.0);
    return shown > 0 ? static_cast<float>(shown * layers.evaluate(x, y)) : 0.0F;
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
      middle[index(x, y)] =
          value(0.5 * (static_cast<double>(ground.x[a]) + static_cast<double>(ground.x[b])),
                0.5 * (static_cast<double>(ground.y[a]) + static_cast<double>(ground.y[b])));
    }
  }
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
  // Where the light bends, the neighbours are not to be trusted either: an edge right through the
  // middle of a pixel bends in them alone. Those outside the tile are judged by its own border.
  const auto trusted = [&](int x, int y) {
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
      if (trusted(x, y)) {
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
          out[at] = value(static_cast<double>(ground.x[at]), static_cast<double>(ground.y[at]));
        }
      }
    }
  }
}

}  // namespace lab::sim::painter
