#include "sim_svc/camera/camera_painter_warp.hpp"

#include <algorithm>
#include <optional>

namespace lab::sim::painter {
namespace {

constexpr int kStep = 4;         // [cells]
constexpr double kAround = 0.5;  // [m] around the arena: further out the lens model is not valid

struct Node {
  double x = 0;
  double y = 0;
  double inside = -1;  // [px]
};

Node nodeAt(const PainterSettings& settings, const optics::Place& place) {
  if (place.x < -kAround || place.x > settings.arena_width + kAround || place.y < -kAround ||
      place.y > settings.arena_height + kAround) {
    return {place.x, place.y, -1};
  }
  // Points just outside the picture need a source too, because its edge lies between nodes.
  const std::optional<optics::Place> source = settings.warp.sourceUnclipped(place);
  if (!source) return {place.x, place.y, -1};
  return {source->x, source->y, std::clamp(settings.warp.marginInside(place), -50.0, 50.0)};
}

}  // namespace

WarpedPlaces::WarpedPlaces(const PainterSettings& settings, const Lattice& lattice,
                           const Ground& ground, const PlaneShift& shift)
    : x_(lattice.size()), y_(lattice.size()), lit_(lattice.size()) {
  const int nodes_x = (lattice.columns() - 1) / kStep + 2;
  const int nodes_y = (lattice.rows() - 1) / kStep + 2;
  const auto row = [&](int j) {
    std::vector<Node> nodes;
    for (int i = 0; i < nodes_x; ++i) {
      const std::size_t at = lattice.at(std::min(i * kStep, lattice.columns() - 1),
                                        std::min(j * kStep, lattice.rows() - 1));
      nodes.push_back(
          nodeAt(settings, {shift.scale * static_cast<double>(ground.x[at]) + shift.x0,
                            shift.scale * static_cast<double>(ground.y[at]) + shift.y0}));
    }
    return nodes;
  };
  std::vector<Node> above = row(0);
  for (int node_row = 0; node_row + 1 < nodes_y; ++node_row) {
    const std::vector<Node> below = row(node_row + 1);
    for (int j = node_row * kStep; j < std::min((node_row + 1) * kStep, lattice.rows()); ++j) {
      const double down = static_cast<double>(j - node_row * kStep) / kStep;
      for (int i = 0; i < lattice.columns(); ++i) {
        const auto n = static_cast<std::size_t>(i / kStep);
        const double right = static_cast<double>(i % kStep) / kStep;
        const auto mix = [&](double Node::*of) {
          const double a = above[n].*of + down * (below[n].*of - above[n].*of);
          const double b = above[n + 1].*of + down * (below[n + 1].*of - above[n + 1].*of);
          return a + right * (b - a);
        };
        const std::size_t at = lattice.at(i, j);
        x_[at] = static_cast<float>(mix(&Node::x));
        y_[at] = static_cast<float>(mix(&Node::y));
        lit_[at] = static_cast<float>(std::clamp(mix(&Node::inside) + 0.5, 0.0, 1.0));
      }
    }
    above = below;
  }
}

}  // namespace lab::sim::painter
