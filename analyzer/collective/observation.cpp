#include "analyzer/collective/observation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lab::collective {
namespace {

constexpr std::array<ScalarName, kScalars> kNames{{{"polar_order", "1"},
                                                   {"nematic_order", "1"},
                                                   {"hexatic_order", "1"},
                                                   {"hexatic_order_global", "1"},
                                                   {"largest_cluster", "1"},
                                                   {"mean_cluster", "1"},
                                                   {"clusters", "1"},
                                                   {"clustered_share", "1"},
                                                   {"local_density", "1"},
                                                   {"local_density_scatter", "1"},
                                                   {"speed", "m/s"},
                                                   {"square_speed", "m^2/s^2"}}};

}  // namespace

ScalarName nameOf(Scalar scalar) { return kNames.at(scalar); }

const FrameObservation& FrameObserver::observe(const std::vector<CrowdRobot>& robots) {
  result_.values.fill(units::kNan);
  points_.clear();
  for (const CrowdRobot& robot : robots) points_.push_back({robot.x, robot.y});
  order(robots);
  cells();
  cluster();
  return result_;
}

void FrameObserver::order(const std::vector<CrowdRobot>& robots) {
  double c1 = 0;
  double s1 = 0;
  double c2 = 0;
  double s2 = 0;
  double headings = 0;
  double speed = 0;
  double square = 0;
  double moving = 0;
  for (const CrowdRobot& robot : robots) {
    if (std::isfinite(robot.theta)) {
      const double c = std::cos(robot.theta);
      const double s = std::sin(robot.theta);
      c1 += c;
      s1 += s;
      c2 += c * c - s * s;
      s2 += 2 * c * s;
      ++headings;
    }
    if (std::isfinite(robot.velocity_x)) {
      const double v2 = robot.velocity_x * robot.velocity_x + robot.velocity_y * robot.velocity_y;
      speed += std::sqrt(v2);
      square += v2;
      ++moving;
    }
  }
  if (headings > 0) {
    result_.values[kPolar] = std::hypot(c1, s1) / headings;
    result_.values[kNematic] = std::hypot(c2, s2) / headings;
  }
  if (moving > 0) {
    result_.values[kSpeed] = speed / moving;
    result_.values[kSquareSpeed] = square / moving;
  }
}

void FrameObserver::cells() {
  const std::size_t count = points_.size();
  result_.densities.assign(count, units::kNan);
  result_.hexatics.assign(count, units::kNan);
  if (count == 0) return;
  const std::vector<VoronoiCell> cells = voronoiCells(points_, settings_.arena);
  const double disc = 0.25 * std::numbers::pi * settings_.diameter * settings_.diameter;
  double sum = 0;
  double square = 0;
  double local = 0;
  BondOrder global;
  double inner = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double density = disc / cells[i].area;
    result_.densities[i] = density;
    sum += density;
    square += density * density;
    if (cells[i].at_wall || cells[i].neighbours.empty()) continue;
    const BondOrder order = hexaticOf(points_, i, cells[i]);
    result_.hexatics[i] = std::hypot(order.real, order.imaginary);
    local += result_.hexatics[i];
    global.real += order.real;
    global.imaginary += order.imaginary;
    ++inner;
  }
  const auto n = static_cast<double>(count);
  result_.values[kDensityMean] = sum / n;
  result_.values[kDensityScatter] = std::sqrt(std::max(0.0, square / n - (sum / n) * (sum / n)));
  if (inner > 0) {
    result_.values[kHexatic] = local / inner;
    result_.values[kHexaticGlobal] = std::hypot(global.real, global.imaginary) / inner;
  }
}

void FrameObserver::cluster() {
  const std::size_t count = points_.size();
  result_.clusters.assign(count, 0);
  result_.cluster_sizes.assign(count, 1);
  if (count == 0) return;
  clusters_.reset(count);
  forEachPair(
      points_, settings_.clusterDistance(), order_,
      [this](std::size_t a, std::size_t b, double, double, double) { clusters_.join(a, b); });
  std::vector<int> sizes(count, 0);
  std::vector<std::size_t> roots;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t root = clusters_.root(i);
    if (++sizes[root] == 2) roots.push_back(root);
  }
  std::sort(roots.begin(), roots.end(), [&](std::size_t a, std::size_t b) {
    return sizes[a] != sizes[b] ? sizes[a] > sizes[b] : a < b;
  });
  std::vector<int> number(count, 0);
  for (std::size_t k = 0; k < roots.size(); ++k) number[roots[k]] = static_cast<int>(k) + 1;
  double weighted = 0;
  double clustered = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t root = clusters_.root(i);
    result_.clusters[i] = number[root];
    result_.cluster_sizes[i] = sizes[root];
    weighted += sizes[root];
    clustered += sizes[root] > 1 ? 1 : 0;
  }
  const auto n = static_cast<double>(count);
  result_.values[kLargestCluster] = roots.empty() ? 1 : sizes[roots.front()];
  result_.values[kMeanCluster] = weighted / n;
  result_.values[kClusters] = static_cast<double>(roots.size());
  result_.values[kClustered] = clustered / n;
}

}  // namespace lab::collective
