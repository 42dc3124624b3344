#include "tracker_svc/detector/scale_map.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "light/median.hpp"

namespace lab::detector {
namespace {

constexpr int kCell = 32;       // [px] between nodes
constexpr double kStep = 0.01;  // [m] for second derivatives
// factor from the median beyond which a scale is outside the arena
constexpr float kLargestJump = 4.0F;

/// The numbers of a LocalScale in groups of four, for SIMD.
struct Fours {
  using Four = float __attribute__((vector_size(16)));
  Four v[3];
};
static_assert(sizeof(Fours) == sizeof(LocalScale));

LocalScale scaleThere(const optics::CameraModel& camera, const optics::CapGeometry& cap,
                      optics::Pixel pixel) {
  LocalScale out;
  const std::optional<optics::Place> place = camera.toPlane(pixel, cap.height);
  if (!place) return out;
  const optics::PlaneScale s = camera.scaleAt(*place, cap.height);
  const double determinant = s.ux * s.vy - s.uy * s.vx;
  if (!std::isfinite(determinant) || std::abs(determinant) < 1) return out;
  const double inverse[4] = {s.vy / determinant, -s.uy / determinant, -s.vx / determinant,
                             s.ux / determinant};
  // Second derivatives h[k][a][b] of u and v by x and y.
  double h[2][2][2];
  for (int b = 0; b < 2; ++b) {
    const double dx = b == 0 ? kStep : 0;
    const double dy = b == 1 ? kStep : 0;
    const optics::PlaneScale more = camera.scaleAt({place->x + dx, place->y + dy}, cap.height);
    const optics::PlaneScale less = camera.scaleAt({place->x - dx, place->y - dy}, cap.height);
    h[0][0][b] = (more.ux - less.ux) / (2 * kStep);
    h[0][1][b] = (more.uy - less.uy) / (2 * kStep);
    h[1][0][b] = (more.vx - less.vx) / (2 * kStep);
    h[1][1][b] = (more.vy - less.vy) / (2 * kStep);
  }
  // In units of metres on the plane the outline is a circle, displaced by q_k(e) = R^2/2 e'H_k e
  // along its normals e. The centre of the best fit is R^2/8 (trace H_i + 2 sum_k H_k,ki); for a
  // pure perspective this is the exact centre of the ellipse.
  double g[2][2][2];
  for (int a = 0; a < 2; ++a) {
    for (int b = 0; b < 2; ++b) {
      g[0][a][b] = inverse[0] * h[0][a][b] + inverse[1] * h[1][a][b];
      g[1][a][b] = inverse[2] * h[0][a][b] + inverse[3] * h[1][a][b];
    }
  }
  double moved[2];
  for (int i = 0; i < 2; ++i) {
    moved[i] = (g[i][0][0] + g[i][1][1] + 2 * (g[0][0][i] + g[1][1][i])) / 8;
  }
  for (int i = 0; i < 4; ++i) out.inverse[i] = static_cast<float>(inverse[i]);
  out.forward[0] = static_cast<float>(s.ux);
  out.forward[1] = static_cast<float>(s.uy);
  out.forward[2] = static_cast<float>(s.vx);
  out.forward[3] = static_cast<float>(s.vy);
  out.mean = static_cast<float>(std::sqrt(std::abs(determinant)));
  out.bend[0] = static_cast<float>(s.ux * moved[0] + s.uy * moved[1]);
  out.bend[1] = static_cast<float>(s.vx * moved[0] + s.vy * moved[1]);
  return out;
}

}  // namespace

ScaleMap::ScaleMap(const optics::CameraModel& camera, const optics::CapGeometry& cap)
    : columns_(std::max(camera.parameters().width, 1) / kCell + 2),
      rows_(std::max(camera.parameters().height, 1) / kCell + 2) {
  nodes_.reserve(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  std::vector<float> means;
  for (int j = 0; j < rows_; ++j) {
    for (int i = 0; i < columns_; ++i) {
      nodes_.push_back(scaleThere(camera, cap, {1.0 * i * kCell, 1.0 * j * kCell}));
      if (nodes_.back().mean > 0) means.push_back(nodes_.back().mean);
    }
  }
  if (means.empty()) return;
  // Near a horizon the scale approaches 0; no caps are searched there.
  const float usual = medianOf(means);
  smallest_ = std::numeric_limits<float>::max();
  for (LocalScale& node : nodes_) {
    if (node.mean < usual / kLargestJump || node.mean > usual * kLargestJump) node.mean = 0;
    if (node.mean <= 0) continue;
    smallest_ = std::min(smallest_, node.mean);
    largest_ = std::max(largest_, node.mean);
  }
}

LocalScale ScaleMap::at(double x, double y) const {
  const float u = std::clamp(static_cast<float>(x) / kCell, 0.0F, static_cast<float>(columns_ - 1));
  const float v = std::clamp(static_cast<float>(y) / kCell, 0.0F, static_cast<float>(rows_ - 1));
  const int i = std::min(static_cast<int>(u), columns_ - 2);
  const int j = std::min(static_cast<int>(v), rows_ - 2);
  const float a = u - static_cast<float>(i);
  const float b = v - static_cast<float>(j);
  const LocalScale* top = nodes_.data() + static_cast<std::ptrdiff_t>(j) * columns_ + i;
  const LocalScale* four[4] = {top, top + 1, top + columns_, top + columns_ + 1};
  const float share[4] = {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b};
  Fours sum{};
  bool seen = true;
  for (int n = 0; n < 4; ++n) {
    seen = seen && four[n]->mean > 0;
    const auto node = std::bit_cast<Fours>(*four[n]);
    for (int k = 0; k < 3; ++k) sum.v[k] += share[n] * node.v[k];
  }
  auto out = std::bit_cast<LocalScale>(sum);
  if (!seen) out.mean = 0;
  return out;
}

const LocalScale& ScaleMap::near(double x, double y) const {
  const int i = std::clamp(static_cast<int>(x / kCell + 0.5), 0, columns_ - 1);
  const int j = std::clamp(static_cast<int>(y / kCell + 0.5), 0, rows_ - 1);
  return nodes_[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) +
                static_cast<std::size_t>(i)];
}

DiscShape discShape(const LocalScale& scale, double radius) {
  DiscShape shape;
  for (int i = 0; i < 4; ++i) shape.m[i] = scale.inverse[i] / static_cast<float>(radius);
  return shape;
}

}  // namespace lab::detector
