#include "sim_svc/camera/camera_painter_ground.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/math/random.hpp"

namespace lab::sim::painter {
namespace {

constexpr double kFarAway = 1e3;  // [m] used if a line of sight misses the floor
constexpr double kWall = 0.015;   // [m] width
constexpr double kFoot = 0.002;   // [m] width of the dark line at the foot of the wall
constexpr int kScuffs = 8;

double clamp01(double value) { return std::min(std::max(value, 0.0), 1.0); }

/// Smooth noise of about unit range between lattice points `cell` metres apart.
class Mottle {
 public:
  Mottle(std::uint64_t seed, double cell) : seed_(seed), per_cell_(1 / cell) {}

  [[nodiscard]] double at(double x, double y) const {
    const double across = x * per_cell_;
    const double up = y * per_cell_;
    const double i = std::floor(across);
    const double j = std::floor(up);
    const double a = smooth(across - i);
    const double b = smooth(up - j);
    const auto corner = [&](double di, double dj) {
      const auto column = static_cast<std::uint64_t>(static_cast<std::int64_t>(i + di));
      const auto row = static_cast<std::uint64_t>(static_cast<std::int64_t>(j + dj));
      return static_cast<double>(mix64(seed_ ^ (column * 0x9e3779b97f4a7c15U + row)) >> 11U) *
                 0x1.0p-52 -
             1;
    };
    return (1 - b) * ((1 - a) * corner(0, 0) + a * corner(1, 0)) +
           b * ((1 - a) * corner(0, 1) + a * corner(1, 1));
  }

 private:
  static double smooth(double t) { return t * t * (3 - 2 * t); }

  std::uint64_t seed_;
  double per_cell_;
};

/// Albedo of floor, wall and surroundings, with edges blurred over a cell.
class Room {
 public:
  explicit Room(const PainterSettings& settings)
      : settings_(settings),
        coarse_(deriveSeed(settings.seed, 0, "floor"), 0.06),
        fine_(deriveSeed(settings.seed, 1, "floor"), 0.015) {}

  [[nodiscard]] double albedo(double x, double y, double cell) const {
    const Albedos& albedos = settings_.albedos;
    const double mottle = settings_.texture ? 0.7 * coarse_.at(x, y) + 0.3 * fine_.at(x, y) : 0;
    const double out =
        std::max(std::max(-x, x - settings_.arena_width), std::max(-y, y - settings_.arena_height));
    const auto beyond = [&](double edge) { return clamp01((out - edge) / cell + 0.5); };
    const double ground = settings_.sheet > 0 ? albedos.sheet : albedos.floor;
    double value = ground * (1 + 0.025 * mottle);
    value += beyond(0) * (albedos.circle - value);
    value += beyond(kFoot) * (albedos.wall - value);
    value += beyond(kWall) * (albedos.outside * (1 + 0.25 * mottle) - value);
    return value;
  }

 private:
  const PainterSettings& settings_;
  Mottle coarse_;
  Mottle fine_;
};

std::vector<FloorStrip> scuffs(const PainterSettings& settings) {
  std::vector<FloorStrip> strips;
  if (!settings.texture || settings.sheet > 0) return strips;
  Random random(deriveSeed(settings.seed, 0, "scuffs"));
  for (int i = 0; i < kScuffs; ++i) {
    FloorStrip strip;
    strip.x0 = random.uniform() * settings.arena_width;
    strip.y0 = random.uniform() * settings.arena_height;
    const double angle = random.uniform() * 6.28;
    const double length = 0.02 + 0.04 * random.uniform();
    strip.x1 = strip.x0 + length * std::cos(angle);
    strip.y1 = strip.y0 + length * std::sin(angle);
    strip.width = 0.001;
    strip.albedo = settings.albedos.floor * (0.6 + 0.3 * random.uniform());
    strips.push_back(strip);
  }
  return strips;
}

/// Computes the points of all cells on the floor, or on the sheet that hides it: exact on every
/// second pixel, linearly interpolated between (error 2e-4 px for a lens with k1 = -0.12).
void projectCells(const Lattice& lattice, const optics::CameraModel& model, double height,
                  Ground& ground) {
  constexpr int kStep = 4;  // [cells]
  const int nodes_x = lattice.columns() / kStep + 2;
  const int nodes_y = lattice.rows() / kStep + 2;
  const auto places = [&](int node_row) {
    std::vector<optics::Place> row;
    for (int i = 0; i < nodes_x; ++i) {
      row.push_back(
          model.toPlane({lattice.pixel(i * kStep), lattice.pixel(node_row * kStep)}, height)
              .value_or(optics::Place{kFarAway, kFarAway}));
    }
    return row;
  };
  std::vector<optics::Place> above = places(0);
  for (int node_row = 0; node_row + 1 < nodes_y; ++node_row) {
    const std::vector<optics::Place> below = places(node_row + 1);
    for (int j = node_row * kStep; j < std::min((node_row + 1) * kStep, lattice.rows()); ++j) {
      const double down = static_cast<double>(j - node_row * kStep) / kStep;
      for (int i = 0; i < lattice.columns(); ++i) {
        const auto n = static_cast<std::size_t>(i / kStep);
        const double right = static_cast<double>(i % kStep) / kStep;
        const auto mix = [&](double a, double b, double c, double d) {
          const double left_side = a + down * (c - a);
          return static_cast<float>(left_side + right * (b + down * (d - b) - left_side));
        };
        ground.x[lattice.at(i, j)] = mix(above[n].x, above[n + 1].x, below[n].x, below[n + 1].x);
        ground.y[lattice.at(i, j)] = mix(above[n].y, above[n + 1].y, below[n].y, below[n + 1].y);
      }
    }
    above = below;
  }
}

void lay(const FloorStrip& strip, double half, const Lattice& lattice,
         const optics::CameraModel& model, Ground& ground) {
  const double cell = cellSize(model, strip.x0, strip.y0);
  const optics::PlaneScale scale = model.scaleAt({strip.x0, strip.y0}, 0);
  const double per_cell = 0.5 / (scale.ux * scale.vy - scale.uy * scale.vx);
  const double dx = strip.x1 - strip.x0;
  const double dy = strip.y1 - strip.y0;
  const double length = std::hypot(dx, dy);
  const Box box =
      lattice.cells(pixelsAround(model, strip.x0 + dx / 2, strip.y0 + dy / 2, 0, length / 2 + half))
          .within(lattice.all());
  // Corrects the radius so that a disc blurred over a cell keeps its area. The straight edges of a
  // strip need no correction.
  const double edge = length > 0 ? half : std::sqrt(std::max(half * half - cell * cell / 12, 0.0));
  for (int j = box.y0; j < box.y1; ++j) {
    for (int i = box.x0; i < box.x1; ++i) {
      const std::size_t at = lattice.at(i, j);
      const double px = static_cast<double>(ground.x[at]) - strip.x0;
      const double py = static_cast<double>(ground.y[at]) - strip.y0;
      const double along = length > 0 ? clamp01((px * dx + py * dy) / (length * length)) : 0;
      const double nx = px - along * dx;
      const double ny = py - along * dy;
      const double from = std::hypot(nx, ny) + 1e-9;
      const auto across = [&](double ax, double ay) {
        return static_cast<float>(std::abs(ax * nx + ay * ny) / from);
      };
      const float cover = coverOf(static_cast<float>(edge - from),
                                  across(per_cell * scale.vy, -per_cell * scale.vx),
                                  across(-per_cell * scale.uy, per_cell * scale.ux), 0);
      // A strip thinner than a cell covers at most a part of it.
      const float most = static_cast<float>(std::min(2 * half / cell, 1.0));
      ground.albedo[at] +=
          std::min(cover, most) * (static_cast<float>(strip.albedo) - ground.albedo[at]);
    }
  }
}

}  // namespace

double cellSize(const optics::CameraModel& model, double x, double y) {
  const optics::PlaneScale scale = model.scaleAt({x, y}, 0);
  return 0.5 / std::sqrt(std::abs(scale.ux * scale.vy - scale.uy * scale.vx));
}

Ground::Ground(const PainterSettings& settings, const Lattice& lattice,
               const optics::CameraModel& model)
    : x(lattice.size()), y(lattice.size()), albedo(lattice.size()) {
  projectCells(lattice, model, settings.sheet, *this);
  const Room room(settings);
  const double cell = cellSize(model, settings.arena_width / 2, settings.arena_height / 2);
  for (std::size_t at = 0; at < lattice.size(); ++at) {
    albedo[at] = static_cast<float>(
        room.albedo(static_cast<double>(x[at]), static_cast<double>(y[at]), cell));
  }
  for (const FloorStrip& strip : scuffs(settings)) {
    lay(strip, strip.width / 2, lattice, model, *this);
  }
  if (settings.sheet > 0) return;
  for (const FloorStrip& strip : settings.strips) {
    lay(strip, strip.width / 2, lattice, model, *this);
  }
  for (const FloorDisc& disc : settings.discs) {
    lay({disc.x, disc.y, disc.x, disc.y, 2 * disc.radius, disc.albedo}, disc.radius, lattice, model,
        *this);
  }
}

Box pixelsAround(const optics::CameraModel& model, double x, double y, double z, double radius) {
  constexpr double kSpare = 2;  // [px] for the linearisation and for rounding
  optics::PlaneScale scale;
  const optics::Pixel centre = model.project(x, y, z, scale);
  const double across = 1.02 * radius * std::hypot(scale.ux, scale.uy) + kSpare;
  const double down = 1.02 * radius * std::hypot(scale.vx, scale.vy) + kSpare;
  constexpr double kMost = 1e6;  // avoids overflow for points far outside the picture
  const auto whole = [&](double pixel) {
    return static_cast<int>(std::clamp(pixel, -kMost, kMost));
  };
  return {whole(std::floor(centre.x - across)), whole(std::floor(centre.y - down)),
          whole(std::ceil(centre.x + across)) + 1, whole(std::ceil(centre.y + down)) + 1};
}

}  // namespace lab::sim::painter
