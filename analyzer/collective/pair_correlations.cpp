#include "analyzer/collective/pair_correlations.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace lab::collective {
namespace {

constexpr double kBinsPerDiameter = 15;
constexpr double kReach = 6;  // diameters
constexpr double kMostBins = 200;

enum Channel : std::size_t { kFound, kExpected, kProducts, kSquares };

double reachOf(const CrowdSettings& settings) {
  const Rectangle centres = settings.centres();
  return std::min(kReach * settings.diameter, 0.5 * std::min(centres.width(), centres.height()));
}

}  // namespace

PairCorrelations::PairCorrelations(const Rectangle& centres, double bin_width, double reach)
    : centres_(centres),
      bin_width_(bin_width),
      bins_(static_cast<std::size_t>(std::clamp(std::round(reach / bin_width), 1.0, kMostBins))),
      sums_(bins_ * kPerBin, kBlocks) {}

PairCorrelations::PairCorrelations(const CrowdSettings& settings)
    : PairCorrelations(settings.centres(), settings.diameter / kBinsPerDiameter,
                       reachOf(settings)) {}

void PairCorrelations::add(const std::vector<CrowdRobot>& robots) {
  const std::span<double> sums = sums_.frame();
  points_.clear();
  double square = 0;
  double moving = 0;
  for (const CrowdRobot& robot : robots) {
    points_.push_back({robot.x, robot.y});
    if (!std::isfinite(robot.velocity_x)) continue;
    square += robot.velocity_x * robot.velocity_x + robot.velocity_y * robot.velocity_y;
    ++moving;
  }
  const double mean_square = moving > 0 ? square / moving : 0;
  const double reach = bin_width_ * static_cast<double>(bins_);
  forEachPair(points_, reach, order_, [&](std::size_t i, std::size_t j, double, double, double r2) {
    const auto bin = std::min(bins_ - 1, static_cast<std::size_t>(std::sqrt(r2) / bin_width_));
    sums[bin * kPerBin + kFound] += 2;  // seen from either robot
    const CrowdRobot& a = robots[i];
    const CrowdRobot& b = robots[j];
    if (!std::isfinite(a.velocity_x) || !std::isfinite(b.velocity_x)) return;
    sums[bin * kPerBin + kProducts] += a.velocity_x * b.velocity_x + a.velocity_y * b.velocity_y;
    sums[bin * kPerBin + kSquares] += mean_square;
  });
  expect(robots, sums);
  sums_.endFrame();
}

void PairCorrelations::expect(const std::vector<CrowdRobot>& robots, std::span<double> sums) const {
  if (robots.size() < 2 || !(centres_.area() > 0)) return;
  const double density = static_cast<double>(robots.size() - 1) / centres_.area();
  const double disc = std::numbers::pi * bin_width_ * bin_width_;
  double whole = 0;  // robots, weighted by the density, all of whose rings are inside
  for (const CrowdRobot& robot : robots) {
    const double x = centres_.nearestX(robot.x);
    const double y = centres_.nearestY(robot.y);
    const double free = std::min(std::min(x - centres_.left, centres_.right - x),
                                 std::min(y - centres_.bottom, centres_.top - y));
    const auto inside = std::min(bins_, static_cast<std::size_t>(free / bin_width_));
    if (inside == bins_) {
      whole += density;
      continue;
    }
    for (std::size_t bin = 0; bin < inside; ++bin) {
      sums[bin * kPerBin + kExpected] += density * disc * (2 * static_cast<double>(bin) + 1);
    }
    const auto edge = static_cast<double>(inside);
    double before = disc * edge * edge;
    for (std::size_t bin = inside; bin < bins_; ++bin) {
      const double area =
          discAreaInside(x, y, bin_width_ * (static_cast<double>(bin) + 1), centres_);
      sums[bin * kPerBin + kExpected] += density * (area - before);
      before = area;
    }
  }
  for (std::size_t bin = 0; bin < bins_; ++bin) {
    sums[bin * kPerBin + kExpected] += whole * disc * (2 * static_cast<double>(bin) + 1);
  }
}

ObservableCurve PairCorrelations::distribution() const {
  ObservableCurve curve{"pair_distribution", "distance", "m", "1", {}};
  for (std::size_t bin = 0; bin < bins_; ++bin) {
    if (!(sums_.total(bin * kPerBin + kExpected) > 0)) continue;
    const double found = 0.5 * sums_.total(bin * kPerBin + kFound);
    curve.points.push_back({bin_width_ * (static_cast<double>(bin) + 0.5),
                            averageOf(sums_, bin * kPerBin + kFound, bin * kPerBin + kExpected),
                            found});
  }
  return curve;
}

ObservableCurve PairCorrelations::velocities() const {
  ObservableCurve curve{"velocity_correlation", "distance", "m", "1", {}};
  for (std::size_t bin = 0; bin < bins_; ++bin) {
    if (!(sums_.total(bin * kPerBin + kSquares) > 0)) continue;
    curve.points.push_back({bin_width_ * (static_cast<double>(bin) + 0.5),
                            averageOf(sums_, bin * kPerBin + kProducts, bin * kPerBin + kSquares),
                            0.5 * sums_.total(bin * kPerBin + kFound)});
  }
  return curve;
}

}  // namespace lab::collective
