#include "analyzer/collective/crowd_group.hpp"

#include <algorithm>
#include <cmath>

#include "analyzer/collective/leave_one_out.hpp"

namespace lab::collective {
namespace {

constexpr double kFirstContactClass = 0.1;   // [s]
constexpr std::size_t kContactClasses = 26;  // each longer by sqrt(2)
constexpr int kSingleSizes = 10;             // cluster sizes with a class of their own
constexpr double kSizeRatio = 1.25;

/// Upper ends of the classes of cluster sizes, exclusive.
std::vector<int> sizeClasses(std::size_t count) {
  std::vector<int> ends;
  for (int size = 1; size <= kSingleSizes; ++size) ends.push_back(size + 1);
  while (ends.size() < count) {
    ends.push_back(static_cast<int>(std::ceil(static_cast<double>(ends.back()) * kSizeRatio)));
  }
  return ends;
}

std::size_t classOf(int size, const std::vector<int>& ends) {
  const auto at = std::upper_bound(ends.begin(), ends.end(), size);
  return std::min(ends.size() - 1, static_cast<std::size_t>(at - ends.begin()));
}

const std::vector<int>& sizeEnds(std::size_t count) {
  static const std::vector<int> ends = sizeClasses(count);
  return ends;
}

}  // namespace

CrowdGroup::CrowdGroup(int key, const CrowdSettings& settings, const PlaceNames& regions,
                       const PlaceNames& bands)
    : key_(key),
      settings_(settings),
      region_names_(regions),
      band_names_(bands),
      channels_{regions.names.size(), bands.names.size()},
      scalars_(kScalars * kPerScalar, kBlocks),
      rates_(channels_.count(), kBlocks / 4),
      sizes_(kSizes + 1, 64),
      pairs_(settings),
      density_(settings),
      fluctuations_(settings),
      map_(settings),
      motion_(settings),
      contact_times_(kContactClasses, 0.0) {
  now_.fill(units::kNan);
}

void CrowdGroup::addContact(double duration) {
  if (!std::isfinite(duration)) return;
  const double at = 2 * std::log2(std::max(duration, kFirstContactClass) / kFirstContactClass);
  contact_times_[std::min(kContactClasses - 1, static_cast<std::size_t>(at))] += 1;
}

void CrowdGroup::take(double time, const std::vector<CrowdRobot>& robots,
                      const FrameObservation& observation) {
  static_cast<void>(rates_.frame());
  rates_.endFrame();
  motion_.add(time, robots);
  if (robots.size() < 2) return;
  if (frames_ == 0) first_time_ = time;
  last_time_ = time;
  ++frames_;
  robots_ += static_cast<double>(robots.size());
  now_ = observation.values;
  const std::span<double> sums = scalars_.frame();
  for (std::size_t i = 0; i < kScalars; ++i) {
    const double value = observation.values[i];
    if (!std::isfinite(value)) continue;
    sums[kPerScalar * i] += value;
    sums[kPerScalar * i + 1] += value * value;
    sums[kPerScalar * i + 2] += 1;
  }
  scalars_.endFrame();
  const std::span<double> sizes = sizes_.frame();
  for (const int size : observation.cluster_sizes) sizes[classOf(size, sizeEnds(kSizes))] += 1;
  sizes[kSizes] += static_cast<double>(robots.size());
  sizes_.endFrame();
  pairs_.add(robots);
  density_.add(robots, observation.densities);
  fluctuations_.add(robots);
  map_.add(robots);
}

CrowdResult CrowdGroup::result() const {
  CrowdResult result;
  result.group = key_;
  result.frames = frames_;
  result.observed = static_cast<double>(frames_) * settings_.period;
  if (frames_ == 0) return result;
  result.robots = robots_ / static_cast<double>(frames_);
  for (std::size_t i = 0; i < kScalars; ++i) {
    const ScalarName name = nameOf(static_cast<Scalar>(i));
    Observable number{std::string(name.name), std::string(name.unit), now_[i], units::kNan, {}};
    number.average = averageOf(scalars_, kPerScalar * i, kPerScalar * i + 2);
    const double count = scalars_.total(kPerScalar * i + 2);
    const double mean = number.average.value;
    number.scatter =
        std::sqrt(std::max(0.0, scalars_.total(kPerScalar * i + 1) / count - mean * mean));
    result.numbers.push_back(std::move(number));
  }
  addRates(result);
  result.numbers.push_back({"bimodality", "1", units::kNan, units::kNan, density_.bimodality()});
  result.numbers.push_back(
      {"number_fluctuation_exponent", "1", units::kNan, units::kNan, fluctuations_.exponent()});
  result.curves = {pairs_.distribution(),    pairs_.velocities(), density_.ofCells(),
                   density_.ofBoxes(),       clusterSizes(),      contactTimes(),
                   fluctuations_.variance(), motion_.msd(),       motion_.angularMsd()};
  result.modes = modesOf(result.curves[2]);
  result.regions = places(region_names_, false);
  double counted = 0;
  for (const double count : region_counts_) counted += count;
  for (const double count : region_counts_) result.regions.now.push_back(count / counted);
  result.bands = places(band_names_, true);
  return result;
}

void CrowdGroup::addRates(CrowdResult& result) const {
  using Channels = RateChannels;
  const auto add = [&](const char* name, const char* unit, std::size_t above, std::size_t below) {
    result.numbers.push_back(
        {name, unit, units::kNan, units::kNan, averageOf(rates_, above, below)});
  };
  add("touching_share", "1", Channels::kTouching, Channels::kRobotTime);
  add("wall_share", "1", Channels::kAtWall, Channels::kRobotTime);
  // Time over number of ends: contacts that go on at the beginning or the end of the recording
  // count with their time, so long ones are not under-represented.
  add("contact_time", "s", Channels::kPairTime, Channels::kContactEnds);
  add("wall_time", "s", Channels::kAtWall, Channels::kWallEnds);
}

PlaceResult CrowdGroup::places(const PlaceNames& names, bool of_bands) const {
  PlaceResult result;
  result.names = names.names;
  const std::size_t count = names.names.size();
  const auto time = [&](std::size_t i) {
    return of_bands ? channels_.bandTime(i) : channels_.regionTime(i);
  };
  const auto change = [&](std::size_t from, std::size_t to) {
    return of_bands ? channels_.bandChange(from, to) : channels_.regionChange(from, to);
  };
  std::vector<double> total(rates_.blocks(), 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::vector<double> times = rates_.column(time(i));
    for (std::size_t b = 0; b < total.size(); ++b) total[b] += times[b];
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::vector<double> times = rates_.column(time(i));
    std::vector<double> ends(total.size(), 0.0);
    std::vector<Average> row;
    for (std::size_t j = 0; j < count; ++j) {
      const std::vector<double> changes = rates_.column(change(i, j));
      row.push_back(averageOf(changes, rates_.column(RateChannels::kTime)));
      for (std::size_t b = 0; b < ends.size(); ++b) ends[b] += changes[b];
    }
    result.shares.push_back(averageOf(times, total));
    result.stays.push_back(averageOf(times, ends));
    result.flux.push_back(std::move(row));
  }
  return result;
}

ObservableCurve CrowdGroup::clusterSizes() const {
  ObservableCurve curve{"cluster_sizes", "size", "1", "1", {}};
  const std::vector<int>& ends = sizeEnds(kSizes);
  std::size_t last = 0;
  for (std::size_t k = 0; k < kSizes; ++k) {
    if (sizes_.total(k) > 0) last = k + 1;
  }
  for (std::size_t k = 0; k < last; ++k) {
    const double low = k == 0 ? 1 : ends[k - 1];
    const double width = ends[k] - low;
    Average average = averageOf(sizes_, k, kSizes);
    for (double* value : {&average.value, &average.sigma, &average.low, &average.high}) {
      *value /= width;
    }
    curve.points.push_back({low + 0.5 * (width - 1), average, sizes_.total(k)});
  }
  return curve;
}

ObservableCurve CrowdGroup::contactTimes() const {
  ObservableCurve curve{"contact_times", "duration", "s", "1/s", {}};
  double total = 0;
  for (const double count : contact_times_) total += count;
  for (std::size_t k = 0; k < kContactClasses && total > 0; ++k) {
    const double count = contact_times_[k];
    if (count == 0) continue;
    const double low = k == 0 ? 0 : kFirstContactClass * std::exp2(0.5 * static_cast<double>(k));
    const double high = kFirstContactClass * std::exp2(0.5 * static_cast<double>(k + 1));
    CurveSample point{0.5 * (low + high), {}, count};
    const double scale = 1 / (total * (high - low));
    point.average.value = count * scale;
    // Contacts are counted as independent.
    point.average.sigma = std::sqrt(count) * scale;
    curve.points.push_back(point);
  }
  return curve;
}

std::vector<Stretch> CrowdGroup::stretches(std::size_t most) const {
  std::vector<Stretch> stretches;
  const std::size_t blocks = scalars_.blocks();
  if (blocks == 0) return stretches;
  const std::size_t merged = (blocks + most - 1) / most;
  std::vector<Average> averages;
  for (std::size_t i = 0; i < kScalars; ++i) {
    averages.push_back(averageOf(scalars_, kPerScalar * i, kPerScalar * i + 2));
  }
  const double block_time = (last_time_ - first_time_) /
                            static_cast<double>(std::max<std::size_t>(1, frames_ - 1)) *
                            static_cast<double>(scalars_.framesPerBlock());
  for (std::size_t first = 0; first < blocks; first += merged) {
    const std::size_t end = std::min(blocks, first + merged);
    // A short rest has a large error and would dominate a picture.
    if (first > 0 && 2 * (end - first) < merged) break;
    Stretch stretch;
    stretch.begin = first_time_ + block_time * static_cast<double>(first);
    stretch.end = std::min(last_time_, first_time_ + block_time * static_cast<double>(end));
    for (std::size_t i = 0; i < kScalars; ++i) {
      double sum = 0;
      double count = 0;
      for (std::size_t b = first; b < end; ++b) {
        sum += scalars_.sum(b, kPerScalar * i);
        count += scalars_.sum(b, kPerScalar * i + 2);
      }
      stretch.values.push_back(count > 0 ? sum / count : units::kNan);
      // The variance of an average falls with the time: sigma of the whole recording, scaled.
      const double share = count / scalars_.total(kPerScalar * i + 2);
      stretch.sigmas.push_back(averages[i].sigma / std::sqrt(share));
    }
    stretches.push_back(std::move(stretch));
  }
  return stretches;
}

}  // namespace lab::collective
