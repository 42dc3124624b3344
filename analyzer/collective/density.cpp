#include "analyzer/collective/density.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "analyzer/collective/leave_one_out.hpp"

namespace lab::collective {
namespace {

constexpr double kBoxDiameters = 3;  // side of a coarse box
constexpr double kBinWidth = 0.025;  // of packing fractions
constexpr std::array<std::size_t, 8> kColumns{2, 3, 4, 6, 8, 12, 16, 24};

std::size_t boxesAlong(double length, double diameter) {
  return static_cast<std::size_t>(
      std::clamp(std::round(length / (kBoxDiameters * diameter)), 1.0, 100.0));
}

std::size_t indexOf(double position, double length, std::size_t count) {
  const double at = std::clamp(position / length, 0.0, 1.0) * static_cast<double>(count);
  return std::min(count - 1, static_cast<std::size_t>(at));
}

}  // namespace

DensityDistribution::DensityDistribution(const CrowdSettings& settings)
    : settings_(settings),
      columns_(boxesAlong(settings.arena.width(), settings.diameter)),
      rows_(boxesAlong(settings.arena.height(), settings.diameter)),
      // Bins of cells and boxes, numbers of both, and four moments of the cells.
      sums_(2 * kBins + 6, kBlocks) {}

void DensityDistribution::add(const std::vector<CrowdRobot>& robots,
                              const std::vector<double>& densities) {
  const std::span<double> sums = sums_.frame();
  const auto bin = [](double density) {
    return std::min(kBins - 1, static_cast<std::size_t>(density / kBinWidth));
  };
  for (const double density : densities) {
    if (!std::isfinite(density)) continue;
    sums[bin(density)] += 1;
    sums[2 * kBins] += 1;
    double power = 1;
    for (std::size_t moment = 0; moment < 4; ++moment) {
      power *= density;
      sums[2 * kBins + 2 + moment] += power;
    }
  }
  const Rectangle& arena = settings_.arena;
  const double width = arena.width() / static_cast<double>(columns_);
  const double height = arena.height() / static_cast<double>(rows_);
  const double radius = 0.5 * settings_.diameter;
  covered_.assign(columns_ * rows_, 0.0);
  for (const CrowdRobot& robot : robots) {
    const double x = arena.nearestX(robot.x) - arena.left;
    const double y = arena.nearestY(robot.y) - arena.bottom;
    const std::size_t last_column = indexOf(x + radius, arena.width(), columns_);
    const std::size_t last_row = indexOf(y + radius, arena.height(), rows_);
    for (std::size_t c = indexOf(x - radius, arena.width(), columns_); c <= last_column; ++c) {
      for (std::size_t r = indexOf(y - radius, arena.height(), rows_); r <= last_row; ++r) {
        const double left = width * static_cast<double>(c);
        const double bottom = height * static_cast<double>(r);
        covered_[r * columns_ + c] +=
            discAreaIn(x, y, radius, {left, bottom, left + width, bottom + height});
      }
    }
  }
  for (const double area : covered_) {
    sums[kBins + bin(area / (width * height))] += 1;
    sums[2 * kBins + 1] += 1;
  }
  sums_.endFrame();
}

static ObservableCurve histogram(const BlockedSums& sums, const char* name, std::size_t first,
                                 std::size_t bins, std::size_t total) {
  ObservableCurve curve{name, "packing_fraction", "1", "1", {}};
  if (!(sums.total(total) > 0)) return curve;
  for (std::size_t i = 0; i < bins; ++i) {
    Average average = averageOf(sums, first + i, total);
    for (double* value : {&average.value, &average.sigma, &average.low, &average.high}) {
      *value /= kBinWidth;
    }
    curve.points.push_back(
        {kBinWidth * (static_cast<double>(i) + 0.5), average, sums.total(first + i)});
  }
  return curve;
}

ObservableCurve DensityDistribution::ofCells() const {
  return histogram(sums_, "density_of_cells", 0, kBins, 2 * kBins);
}

ObservableCurve DensityDistribution::ofBoxes() const {
  return histogram(sums_, "density_of_boxes", kBins, kBins, 2 * kBins + 1);
}

Average DensityDistribution::bimodality() const {
  return averageOfFunction(sums_, [](std::span<const double> sums) {
    const double n = sums[2 * kBins];
    const double m1 = sums[2 * kBins + 2] / n;
    const double m2 = sums[2 * kBins + 3] / n;
    const double m3 = sums[2 * kBins + 4] / n;
    const double m4 = sums[2 * kBins + 5] / n;
    const double variance = m2 - m1 * m1;
    const double third = m3 - 3 * m1 * m2 + 2 * m1 * m1 * m1;
    const double fourth = m4 - 4 * m1 * m3 + 6 * m1 * m1 * m2 - 3 * m1 * m1 * m1 * m1;
    if (!(variance > 1e-12)) return units::kNan;
    return (third * third / (variance * variance * variance) + 1) * variance * variance / fourth;
  });
}

Modes modesOf(const ObservableCurve& curve) {
  Modes modes;
  const std::size_t bins = curve.points.size();
  if (bins < 5) return modes;
  std::vector<double> smooth;
  std::vector<double> sigma;
  for (const CurveSample& point : curve.points) {
    smooth.push_back(point.average.value);
    sigma.push_back(point.average.sigma);
  }
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<double> next = smooth;
    for (std::size_t i = 0; i < bins; ++i) {
      const double before = i > 0 ? smooth[i - 1] : 0;
      const double after = i + 1 < bins ? smooth[i + 1] : 0;
      next[i] = 0.25 * before + 0.5 * smooth[i] + 0.25 * after;
    }
    smooth = std::move(next);
  }
  std::vector<std::size_t> maxima;
  for (std::size_t i = 0; i < bins; ++i) {
    const double before = i > 0 ? smooth[i - 1] : 0;
    const double after = i + 1 < bins ? smooth[i + 1] : 0;
    if (smooth[i] > before && smooth[i] >= after && smooth[i] > 0) maxima.push_back(i);
  }
  if (maxima.empty()) return modes;
  modes.count = 1;
  const auto higher = [&](std::size_t a, std::size_t b) { return smooth[a] > smooth[b]; };
  const std::size_t first = *std::min_element(maxima.begin(), maxima.end(), higher);
  modes.dilute = modes.dense = curve.points[first].x;
  // The other mode is the maximum that is separated from the first one by the deepest valley.
  double best = 0;
  for (const std::size_t other : maxima) {
    if (other == first) continue;
    const auto [low, high] = std::minmax(first, other);
    const auto valley = static_cast<std::size_t>(
        std::min_element(smooth.begin() + static_cast<std::ptrdiff_t>(low),
                         smooth.begin() + static_cast<std::ptrdiff_t>(high)) -
        smooth.begin());
    const double difference = smooth[other] - smooth[valley];
    if (!(difference > best)) continue;
    best = difference;
    modes.dilute = curve.points[low].x;
    modes.dense = curve.points[high].x;
    modes.valley = curve.points[valley].x;
    modes.depth = difference / smooth[other];
    // The smoothed values have the errors of about three bins.
    const double error = std::hypot(sigma[other], sigma[valley]);
    modes.depth_sigmas = error > 0 ? difference / error : 0;
  }
  if (modes.depth_sigmas > 3) modes.count = 2;
  return modes;
}

NumberFluctuations::NumberFluctuations(const CrowdSettings& settings)
    : arena_(settings.arena), sums_(kPerSize * kColumns.size() + 1, kBlocks) {
  const double longer = std::max(arena_.width(), arena_.height());
  const double shorter = std::min(arena_.width(), arena_.height());
  for (const std::size_t along : kColumns) {
    const double side = longer / static_cast<double>(along);
    if (side < settings.diameter) break;
    const auto across = static_cast<std::size_t>(std::max(1.0, std::round(shorter / side)));
    grids_.push_back(arena_.width() >= arena_.height() ? Grid{along, across} : Grid{across, along});
  }
}

void NumberFluctuations::add(const std::vector<CrowdRobot>& robots) {
  const std::span<double> sums = sums_.frame();
  for (std::size_t g = 0; g < grids_.size(); ++g) {
    const Grid& grid = grids_[g];
    counts_.assign(grid.columns * grid.rows, 0.0);
    for (const CrowdRobot& robot : robots) {
      const std::size_t column = indexOf(robot.x - arena_.left, arena_.width(), grid.columns);
      const std::size_t row = indexOf(robot.y - arena_.bottom, arena_.height(), grid.rows);
      counts_[row * grid.columns + column] += 1;
    }
    const auto boxes = static_cast<double>(counts_.size());
    const double mean = static_cast<double>(robots.size()) / boxes;
    double square = 0;
    for (const double count : counts_) square += (count - mean) * (count - mean);
    sums[kPerSize * g] += square / (boxes - 1);
    sums[kPerSize * g + 1] += mean;
  }
  sums.back() += 1;  // frames
  sums_.endFrame();
}

ObservableCurve NumberFluctuations::variance() const {
  ObservableCurve curve{"number_fluctuations", "mean_number", "1", "1", {}};
  const std::size_t frames = sums_.channels() - 1;
  // Grids from fine to coarse: in the order of the mean number.
  for (std::size_t g = grids_.size(); g-- > 0;) {
    const double mean = sums_.total(kPerSize * g + 1) / sums_.total(frames);
    if (!(mean > 0)) continue;
    curve.points.push_back({mean, averageOf(sums_, kPerSize * g, frames),
                            static_cast<double>(grids_[g].columns * grids_[g].rows)});
  }
  return curve;
}

Average NumberFluctuations::exponent() const {
  const std::size_t sizes = grids_.size();
  return averageOfFunction(sums_, [sizes](std::span<const double> sums) {
    double n = 0;
    double x = 0;
    double y = 0;
    double xx = 0;
    double xy = 0;
    const double frames = sums.back();
    for (std::size_t g = 0; g < sizes; ++g) {
      const double mean = sums[kPerSize * g + 1] / frames;
      const double variance = sums[kPerSize * g] / frames;
      if (mean < 1 || !(variance > 0)) continue;
      const double lx = std::log(mean);
      const double ly = 0.5 * std::log(variance);
      n += 1;
      x += lx;
      y += ly;
      xx += lx * lx;
      xy += lx * ly;
    }
    if (n < 3) return units::kNan;
    return (n * xy - x * y) / (n * xx - x * x);
  });
}

}  // namespace lab::collective
