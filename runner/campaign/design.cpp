#include "runner/campaign/design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <set>
#include <utility>

#include "common/files/file_values.hpp"
#include "common/math/random.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {
namespace {

constexpr int kDrawnDigits = 9;  // of drawn values

void requireFew(double points) {
  if (points <= static_cast<double>(kMostPoints)) return;
  throw UserError(fmt::format("found a sweep of {:.10g} points, allowed {}; give fewer values",
                              points, kMostPoints));
}

void requireValues(const Axis& axis) {
  if (!axis.values.empty()) return;
  throw UserError(
      fmt::format("--over {0}={1:g}:{2:g}: found a range without a number of values, expected "
                  "{0}={1:g}:{2:g}:COUNT, or --random N, which draws the values",
                  axis.key, axis.range->low, axis.range->high));
}

std::vector<PointValues> combinations(const std::vector<Axis>& axes) {
  double count = 1;
  for (const Axis& axis : axes) {
    requireValues(axis);
    count *= static_cast<double>(axis.values.size());
    requireFew(count);
  }
  std::vector<PointValues> points{{}};
  for (const Axis& axis : axes) {
    std::vector<PointValues> longer;
    longer.reserve(points.size() * axis.values.size());
    for (const PointValues& point : points) {
      for (const std::string& value : axis.values) {
        longer.push_back(point);
        longer.back().push_back(value);
      }
    }
    points = std::move(longer);
  }
  return points;
}

std::vector<PointValues> tuples(const std::vector<Axis>& axes) {
  for (const Axis& axis : axes) {
    requireValues(axis);
    if (axis.values.size() == axes.front().values.size()) continue;
    throw UserError(
        fmt::format("--zip: found {} values of {} and {} of {}, expected equally many of each key",
                    axes.front().values.size(), axes.front().key, axis.values.size(), axis.key));
  }
  const std::size_t count = axes.empty() ? 1 : axes.front().values.size();
  std::vector<PointValues> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (const Axis& axis : axes) points[i].push_back(axis.values[i]);
  }
  return points;
}

/// The value of an axis for a number in [0, 1).
std::string drawn(const Axis& axis, double share) {
  if (!axis.range) {
    const auto count = static_cast<double>(axis.values.size());
    return axis.values[static_cast<std::size_t>(share * count)];
  }
  const DrawnRange& range = *axis.range;
  double value = range.logarithmic ? range.low * std::pow(range.high / range.low, share)
                                   : range.low + share * (range.high - range.low);
  if (range.step > 0 && !range.logarithmic) {
    // So that the first and the last multiple are as probable as the others.
    value += (share - 0.5) * range.step;
    value = std::clamp(value, range.low, range.high);
  }
  return rangeValue(range, range.step > 0 ? value : keys::roundedToDigits(value, kDrawnDigits));
}

/// One column per axis, each with `count` numbers in [0, 1).
using Shares = std::vector<std::vector<double>>;

Shares latinHypercube(std::size_t axes, std::size_t count, std::uint64_t seed) {
  Shares shares(axes);
  for (std::size_t axis = 0; axis < axes; ++axis) {
    Random random(deriveSeed(seed, static_cast<std::int64_t>(axis), "latin hypercube"));
    std::vector<std::size_t> part(count);
    std::iota(part.begin(), part.end(), std::size_t{0});
    for (std::size_t i = count; i > 1; --i) {  // Fisher and Yates
      const auto other = static_cast<std::size_t>(random.uniform() * static_cast<double>(i));
      std::swap(part[i - 1], part[other]);
    }
    for (const std::size_t i : part) {
      shares[axis].push_back((static_cast<double>(i) + random.uniform()) /
                             static_cast<double>(count));
    }
  }
  return shares;
}

Shares sobol(std::size_t axes, std::size_t count, std::uint64_t seed) {
  boost::random::sobol engine(axes);
  std::vector<std::uint64_t> shift(axes);
  for (std::size_t axis = 0; axis < axes; ++axis) {
    shift[axis] = deriveSeed(seed, static_cast<std::int64_t>(axis), "sobol");
  }
  Shares shares(axes);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t axis = 0; axis < axes; ++axis) {
      // The sequence begins with the origin, which the engine leaves out.
      const std::uint64_t digits = (i == 0 ? 0 : engine()) ^ shift[axis];
      shares[axis].push_back(static_cast<double>(digits >> 11U) * 0x1.0p-53);
    }
  }
  return shares;
}

std::vector<PointValues> randomPoints(const Design& design) {
  if (design.axes.empty()) {
    throw UserError("--random: found no key, expected ranges to draw from: --over key=low:high");
  }
  const auto count = static_cast<std::size_t>(design.random);
  const Shares shares = design.sampling == Sampling::kSobol
                            ? sobol(design.axes.size(), count, design.seed)
                            : latinHypercube(design.axes.size(), count, design.seed);
  std::vector<PointValues> points;
  std::set<PointValues> seen;
  for (std::size_t i = 0; i < count; ++i) {
    PointValues point;
    for (std::size_t axis = 0; axis < design.axes.size(); ++axis) {
      point.push_back(drawn(design.axes[axis], shares[axis][i]));
    }
    // Few values can be drawn twice.
    if (seen.insert(point).second) points.push_back(std::move(point));
  }
  return points;
}

}  // namespace

std::vector<PointValues> pointsOf(const Design& design) {
  if (design.random > 0) {
    requireFew(static_cast<double>(design.random));
    if (design.zip) {
      throw UserError("found --zip and --random, expected one of them: both choose the points");
    }
    return randomPoints(design);
  }
  return design.zip ? tuples(design.axes) : combinations(design.axes);
}

}  // namespace lab::runner::campaign
