#include "analyzer/runs/segmented_track.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/angle.hpp"
#include "common/math/units.hpp"
#include "light/median.hpp"

namespace lab::analysis::segmentation {
namespace {

using units::kNan;

constexpr double kStepErrors = 7;  // smallest step, in standard errors
constexpr double kStraddle =
    0.05;  // residual of averaging over an edge, relative to the motion in a bin
constexpr std::size_t kEnoughBins = 7;    // to omit two of them
constexpr double kLeastNoise = 0.01;      // relative to the motion in a frame
constexpr std::size_t kFewestInHalf = 3;  // bins, for the direction of half a run
constexpr double kCountSlack = 0.25;      // of a tumble
constexpr double kTumbleScatter =
    0.3;  // relative scatter about the median; double tumbles are beyond

double distance(const Place& a, const Place& b) { return std::hypot(b.x - a.x, b.y - a.y); }

/// The stretch without the bins at its edges, if enough remain: mean bins there are mixtures, and
/// single frames may belong to the neighbouring stretch.
Stretch inner(const Stretch& stretch, bool averaged, std::size_t least) {
  return stretch.size() >= (averaged ? least + 2 : kEnoughBins)
             ? Stretch{stretch.run, stretch.begin + 1, stretch.end - 1}
             : stretch;
}

/// The mean of one quantity of the bins, weighted by frames.
double meanOf(double TrackBin::*quantity, std::span<const TrackBin> bins, const Stretch& stretch) {
  double frames = 0;
  double sum = 0;
  for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
    frames += bins[i].frames;
    sum += bins[i].frames * bins[i].*quantity;
  }
  return sum / frames;
}

Place meanPlace(std::span<const TrackBin> bins, const Stretch& stretch) {
  Place place;
  for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
    place.frames += bins[i].frames;
    place.x += bins[i].frames * bins[i].x;
    place.y += bins[i].frames * bins[i].y;
  }
  place.x /= place.frames;
  place.y /= place.frames;
  return place;
}

/// Sums for a mean with its error.
struct Mean {
  double n = 0;
  double sum = 0;
  double sum2 = 0;

  void add(double x) {
    n += 1;
    sum += x;
    sum2 += x * x;
  }
  [[nodiscard]] Measured measured() const {
    if (n < 2) {
      return {n > 0 ? sum : kNan, kNan, kNan, n};
    }
    const double scatter = std::sqrt(std::max(0.0, (sum2 - sum * sum / n) / (n - 1)));
    return {sum / n, scatter / std::sqrt(n), scatter, n};
  }
};

}  // namespace

void Scales::setShortest(double frame_period) {
  const double frames =
      std::max(1.0, std::floor(0.8 * tumble / frame_period) - (averaged ? 0.0 : 1.0));
  const double noise = std::max(sigma, kLeastNoise * speed * frame_period);
  shortest = kStepErrors * noise * std::sqrt(2 / frames) / speed;
}

Measured ScaleSums::speed(double sigma) const {
  return time2 > 0 ? Measured{drift / time2, sigma / std::sqrt(time2), kNan, runs}
                   : Measured{kNan, kNan, kNan, 0};
}

Measured ScaleSums::turningRate(double sigma, double speed) const {
  return bend_weight > 0 ? Measured{bend / bend_weight, sigma / (speed * std::sqrt(bend_weight)),
                                    kNan, bent_runs}
                         : Measured{kNan, kNan, kNan, 0};
}

Measured ScaleSums::tumble() const {
  if (tumbles.empty()) {
    return {kNan, kNan, kNan, 0};
  }
  std::vector<double> durations = tumbles;
  const double median = medianOf(durations);
  Mean mean;
  for (const double duration : durations) {
    if (std::abs(duration / median - 1) < kTumbleScatter) {
      mean.add(duration);
    }
  }
  return mean.measured();
}

SegmentedTrack::SegmentedTrack(std::span<const TrackBin> bins, double first, double last,
                               const Scales& scales)
    : bins_(bins), first_(first), last_(last), scales_(scales) {
  const double sigma = std::max(scales.sigma, kStraddle * scales.speed * scales.period);
  stretches_ = segmentMotion(bins, {scales.speed, scales.tumble, sigma, scales.period});
}

void SegmentedTrack::mergeStops() {
  stops_.clear();
  for (const Stretch& stretch : stretches_) {
    if (stretch.run) {
      continue;
    }
    const Place place = meanPlace(bins_, inner(stretch, scales_.averaged, 2));
    const bool same = !stops_.empty() &&
                      distance(stops_.back().departure, place) < scales_.shortest * scales_.speed;
    if (same) {
      stops_.back().departure = place;
      stops_.back().end = stretch.end;
      ++stops_.back().stops;
    } else {
      stops_.push_back({place, place, stretch.begin, stretch.end, 1});
    }
  }
}

void SegmentedTrack::measure(ScaleSums& sums) const {
  for (const Stretch& stretch : stretches_) {
    if (stretch.size() < 4) {
      continue;
    }
    const Stretch core{stretch.run, stretch.begin + 1, stretch.end - 1};
    StretchSums own;
    for (std::size_t i = core.begin; i < core.end; ++i) {
      own.add(bins_[i], bins_[core.begin]);
    }
    if (!stretch.run) {
      sums.noise2 += std::max(0.0, own.place2());
      sums.freedom += 2 * static_cast<double>(core.size() - 1);
    } else if (!joined(stretch)) {
      // The drift along the direction of motion, corrected for the noise, which increases it.
      const double drift2 = own.driftX() * own.driftX() + own.driftY() * own.driftY();
      const double noise = scales_.sigma * scales_.sigma * own.time2();
      sums.drift += std::sqrt(std::max(0.0, drift2 - noise));
      sums.time2 += own.time2();
      sums.runs += 1;
      measureBend(core, sums);
    }
  }
  for (std::size_t i = 0; i < stops_.size(); ++i) {
    const std::optional<double> arrival = arrivalBy(i, false);
    const std::optional<double> departure = departureBy(i, false);
    if (arrival && departure && stops_[i].stops == 1) {
      sums.tumbles.push_back(*departure - *arrival);
    }
  }
}

void SegmentedTrack::measureBend(const Stretch& core, ScaleSums& sums) const {
  if (core.size() < 2 * kFewestInHalf) return;
  const std::size_t middle = core.begin + core.size() / 2;
  StretchSums first;
  StretchSums second;
  for (std::size_t i = core.begin; i < core.end; ++i) {
    (i < middle ? first : second).add(bins_[i], bins_[core.begin]);
  }
  const double angle =
      std::atan2(first.driftX() * second.driftY() - first.driftY() * second.driftX(),
                 first.driftX() * second.driftX() + first.driftY() * second.driftY());
  const double between = second.u / second.w - first.u / first.w;
  // The variance of a direction is sigma^2 / (v^2 time2).
  const double weight = between * between / (1 / first.time2() + 1 / second.time2());
  sums.bend += weight * angle / between;
  sums.bend_weight += weight;
  sums.bent_runs += 1;
}

void SegmentedTrack::collect(FoundRuns& found) const {
  const int track = static_cast<int>(found.segments++);
  found.observed += last_ - first_;
  if (stops_.empty()) {
    found.runs.push_back({last_ - first_, false, false, false, kNan, track});
    return;
  }
  const auto arrival = [&](std::size_t i) { return *arrivalBy(i, true); };
  const auto departure = [&](std::size_t i) { return *departureBy(i, true); };
  std::int64_t tumbles = 0;  // tumbles that began in the stop before
  bool listed = false;       // the run before that stop is the last in the list
  for (std::size_t i = 0; i < stops_.size(); ++i) {
    const StopInterval& here = stops_[i];
    const bool cut_before = here.begin == 0;
    const bool cut_behind = here.end == bins_.size();
    const double from = cut_before ? first_ : arrival(i);
    if (!cut_before) {
      const double duration = i > 0 ? runLength(i) / scales_.speed : from - first_;
      // A track that begins in an undetectable run counts as beginning in a tumble.
      if (i > 0 || duration >= scales_.shortest) {
        const bool single = i > 0 && tumbles == 1;
        found.runs.push_back(
            {duration, i > 0, true, single && listed, single ? turn(i - 1) : kNan, track});
        listed = true;
      }
    }
    const std::int64_t begun =
        tumblesIn((cut_behind ? last_ : departure(i)) - from, cut_before, cut_behind);
    found.tumbles += begun;
    found.hidden += cut_before ? begun : begun - 1;
    tumbles = cut_before ? 0 : begun;
  }
  const std::size_t back = stops_.size() - 1;
  if (stops_[back].end < bins_.size()) {
    const double seen = last_ - departure(back);
    if (seen >= scales_.shortest) {
      const bool single = tumbles == 1;
      found.runs.push_back(
          {seen, true, false, single && listed, single ? turn(back) : kNan, track});
    }
  }
}

double SegmentedTrack::runLength(std::size_t i) const {
  const Place& from = stops_[i - 1].departure;
  const Place& to = stops_[i].arrival;
  const double length = distance(from, to);
  const double noise2 = scales_.sigma * scales_.sigma * (1 / from.frames + 1 / to.frames);
  return length - noise2 / (2 * length);
}

Stretch SegmentedTrack::runBefore(std::size_t i) const {
  return {true, i > 0 ? stops_[i - 1].end : 0, stops_[i].begin};
}

Stretch SegmentedTrack::runAfter(std::size_t i) const {
  return {true, stops_[i].end, i + 1 < stops_.size() ? stops_[i + 1].begin : bins_.size()};
}

bool SegmentedTrack::joined(const Stretch& run) const {
  return bins_[run.begin].piece != bins_[run.end - 1].piece;
}

std::optional<double> SegmentedTrack::arrivalBy(std::size_t i, bool rough) const {
  const Stretch run = runBefore(i);
  return edge(run, stops_[i].arrival, i > 0 ? &stops_[i - 1].departure : nullptr, 1, rough,
              stops_[i].begin);
}

std::optional<double> SegmentedTrack::departureBy(std::size_t i, bool rough) const {
  const Stretch run = runAfter(i);
  const bool last = i + 1 == stops_.size();
  return edge(run, stops_[i].departure, last ? nullptr : &stops_[i + 1].arrival, -1, rough,
              stops_[i].end);
}

std::optional<double> SegmentedTrack::edge(const Stretch& run, const Place& place,
                                           const Place* other, double sign, bool rough,
                                           std::size_t bin) const {
  const bool enough = run.size() >= (scales_.averaged ? 3U : 2U);
  if (run.size() == 0 || (!enough && !rough)) {
    if (!rough) {
      return std::nullopt;
    }
    // Between the bins on both sides of the edge.
    return bin == 0 || bin >= bins_.size() ? bins_[std::min(bin, bins_.size() - 1)].time
                                           : 0.5 * (bins_[bin - 1].time + bins_[bin].time);
  }
  if (!rough && joined(run)) {
    return std::nullopt;
  }
  const Stretch core = inner(run, scales_.averaged, 1);
  const Place middle = meanPlace(bins_, core);
  double dx = other != nullptr ? place.x - other->x : place.x - middle.x;
  double dy = other != nullptr ? place.y - other->y : place.y - middle.y;
  const double length = std::hypot(dx, dy);
  if (!(length > 0)) {
    return meanOf(&TrackBin::time, bins_, core);
  }
  dx /= length;
  dy /= length;
  const double left = (place.x - middle.x) * dx + (place.y - middle.y) * dy;
  return meanOf(&TrackBin::time, bins_, core) + sign * left / scales_.speed;
}

std::int64_t SegmentedTrack::tumblesIn(double stood, bool cut_before, bool cut_behind) const {
  const double tumbles = stood / scales_.tumble;
  double count = std::floor(tumbles + kCountSlack);
  if (cut_before) {
    count = std::floor(tumbles);
  } else if (cut_behind) {
    count = std::ceil(tumbles - kCountSlack / 2);
  }
  return std::max<std::int64_t>(cut_before ? 0 : 1, static_cast<std::int64_t>(count));
}

double SegmentedTrack::turn(std::size_t i) const {
  const Stretch before = runBefore(i);
  const Stretch behind = runAfter(i);
  // Mean bins at the edges contain part of the turn.
  const std::size_t least = scales_.averaged ? 3 : 1;
  if (before.size() < least || behind.size() < least) {
    return kNan;
  }
  const double unseen = scales_.rate * scales_.tumble;  // taken out of the bins, but no run
  const double from = meanOf(&TrackBin::theta, bins_, inner(before, scales_.averaged, 1));
  const double to = meanOf(&TrackBin::theta, bins_, inner(behind, scales_.averaged, 1));
  if (std::isfinite(from) && std::isfinite(to)) {
    return to - from + unseen;
  }
  if (i == 0 || i + 1 >= stops_.size()) {
    return kNan;
  }
  const auto direction = [](const Place& a, const Place& b) {
    return std::atan2(b.y - a.y, b.x - a.x);
  };
  return wrapAngle(direction(stops_[i].departure, stops_[i + 1].arrival) -
                   direction(stops_[i - 1].departure, stops_[i].arrival) + unseen);
}

}  // namespace lab::analysis::segmentation
