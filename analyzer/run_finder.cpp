#include "analyzer/run_finder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>

namespace lab::analysis {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kBinsPerTumble = 10;
constexpr double kLargestGap = 0.5;        // of a tumble: a longer one could hide one
constexpr double kFewestFrames = 3;        // in a tumble
constexpr double kStepErrors = 7;          // below which a step is none
constexpr double kStraddle = 0.05;         // of a bin's way: what averaging over an edge leaves
constexpr std::size_t kEnoughBins = 7;     // to do without two
constexpr double kLeastNoise = 0.01;       // of a frame's way
constexpr double kEdgeShare = 0.03;        // of the time to cross the noise: not averaged out
constexpr double kCountSlack = 0.25;       // of a tumble
constexpr double kScaleTolerance = 0.003;  // at which cutting again changes nothing
constexpr double kTumbleScatter = 0.3;     // of tumbles about their median; two in a row are beyond
constexpr int kMostPasses = 4;

struct Place {
  double x = 0;
  double y = 0;
  double frames = 0;
};

double distance(const Place& a, const Place& b) { return std::hypot(b.x - a.x, b.y - a.y); }

/// The standing between two visible runs: one stop, or several with runs too short to be seen.
struct Standing {
  Place arrival;
  Place departure;
  std::size_t begin = 0;  ///< Bins.
  std::size_t end = 0;
  std::int64_t stops = 1;  ///< Found in it.
};

/// What is known of a robot while its tracks are cut.
struct Scales {
  double speed = 0;
  double tumble = 0;
  double sigma = 0;   ///< Per frame, m.
  double period = 0;  ///< Of bins, s.
  double shortest = 0;
  bool averaged = false;  ///< Bins hold several frames, so that those at edges are mixtures.

  /// By the noise of a stop of one tumble, less the bins at its edges.
  void setShortest(double frame_period) {
    const double frames =
        std::max(1.0, std::floor(0.8 * tumble / frame_period) - (averaged ? 0.0 : 1.0));
    const double noise = std::max(sigma, kLeastNoise * speed * frame_period);
    shortest = kStepErrors * noise * std::sqrt(2 / frames) / speed;
  }
};

/// The stretch without the bins at its edges, where enough remain: averages there are mixtures, and
/// single frames may belong to the neighbour.
Stretch inner(const Stretch& stretch, bool averaged, std::size_t least) {
  return stretch.size() >= (averaged ? least + 2 : kEnoughBins)
             ? Stretch{stretch.run, stretch.begin + 1, stretch.end - 1}
             : stretch;
}

double meanTime(std::span<const TrackBin> bins, const Stretch& stretch) {
  double frames = 0;
  double time = 0;
  for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
    frames += bins[i].frames;
    time += bins[i].frames * bins[i].time;
  }
  return time / frames;
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

double meanHeading(std::span<const TrackBin> bins, const Stretch& stretch) {
  double frames = 0;
  double heading = 0;
  for (std::size_t i = stretch.begin; i < stretch.end; ++i) {
    frames += bins[i].frames;
    heading += bins[i].frames * bins[i].theta;
  }
  return heading / frames;
}

/// Sums over many, for a mean with its error.
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

/// What all tracks say about the scales.
struct Sums {
  double time2 = 0;  ///< Of runs about their means, s^2.
  double drift = 0;  ///< s m.
  double runs = 0;
  double noise2 = 0;  ///< Of stops, m^2.
  double freedom = 0;
  std::vector<double> tumbles;  ///< s.

  [[nodiscard]] Measured speed(double sigma) const {
    return time2 > 0 ? Measured{drift / time2, sigma / std::sqrt(time2), kNan, runs}
                     : Measured{kNan, kNan, kNan, 0};
  }

  /// Of single ones: neither two in a row nor a piece of one.
  [[nodiscard]] Measured tumble() const {
    if (tumbles.empty()) {
      return {kNan, kNan, kNan, 0};
    }
    std::vector<double> sorted = tumbles;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double median = *middle;
    Mean mean;
    for (const double duration : sorted) {
      if (std::abs(duration / median - 1) < kTumbleScatter) {
        mean.add(duration);
      }
    }
    return mean.measured();
  }
};

/// The noise of a frame from second differences of bins, which straight motion does not have; from
/// their median, since edges have them.
double roughNoise(std::span<const TrackBin> bins) {
  std::vector<double> squares;
  for (std::size_t i = 2; i < bins.size(); ++i) {
    const double dx = bins[i].x - 2 * bins[i - 1].x + bins[i - 2].x;
    const double dy = bins[i].y - 2 * bins[i - 1].y + bins[i - 2].y;
    squares.push_back(bins[i - 1].frames * (dx * dx + dy * dy) / 6);
  }
  if (squares.empty()) {
    return 0;
  }
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  return std::sqrt(*middle / (2 * std::numbers::ln2));  // the median of two squares' sum
}

/// One track cut into visible runs and the standing between them.
class CutTrack {
 public:
  CutTrack(std::span<const TrackBin> bins, double first, double last, const Scales& scales)
      : bins_(bins), first_(first), last_(last), scales_(scales) {
    const double sigma = std::max(scales.sigma, kStraddle * scales.speed * scales.period);
    stretches_ = segmentMotion(bins, {scales.speed, scales.tumble, sigma, scales.period});
  }

  /// Joins stops whose distance is no run, by the scales as they are now.
  void gather() {
    standing_.clear();
    for (const Stretch& stretch : stretches_) {
      if (stretch.run) {
        continue;
      }
      const Place place = meanPlace(bins_, inner(stretch, scales_.averaged, 2));
      const bool same = !standing_.empty() && distance(standing_.back().departure, place) <
                                                  scales_.shortest * scales_.speed;
      if (same) {
        standing_.back().departure = place;
        standing_.back().end = stretch.end;
        ++standing_.back().stops;
      } else {
        standing_.push_back({place, place, stretch.begin, stretch.end, 1});
      }
    }
  }

  void measure(Sums& sums) const {
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
        // Along the direction in which it moves; noise across it has lengthened that.
        const double way2 = own.driftX() * own.driftX() + own.driftY() * own.driftY();
        const double noise = scales_.sigma * scales_.sigma * own.time2();
        sums.drift += std::sqrt(std::max(0.0, way2 - noise));
        sums.time2 += own.time2();
        sums.runs += 1;
      }
    }
    for (std::size_t i = 0; i < standing_.size(); ++i) {
      const std::optional<double> arrival = arrivalBy(i, false);
      const std::optional<double> departure = departureBy(i, false);
      if (arrival && departure && standing_[i].stops == 1) {
        sums.tumbles.push_back(*departure - *arrival);
      }
    }
  }

  /// Adds its runs and tumbles.
  void collect(FoundRuns& found) const {
    const int track = static_cast<int>(found.segments++);
    found.observed += last_ - first_;
    if (standing_.empty()) {
      found.runs.push_back({last_ - first_, false, false, false, kNan, track});
      return;
    }
    const auto arrival = [&](std::size_t i) { return *arrivalBy(i, true); };
    const auto departure = [&](std::size_t i) { return *departureBy(i, true); };
    std::int64_t tumbles = 0;  // begun in the standing before
    bool listed = false;       // the run before that one is the last in the list
    for (std::size_t i = 0; i < standing_.size(); ++i) {
      const Standing& here = standing_[i];
      const bool cut_before = here.begin == 0;
      const bool cut_behind = here.end == bins_.size();
      const double from = cut_before ? first_ : arrival(i);
      if (!cut_before) {
        const double duration = i > 0 ? way(i) / scales_.speed : from - first_;
        // A track that begins in a run too short to be seen begins in a tumble.
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
    const std::size_t back = standing_.size() - 1;
    if (standing_[back].end < bins_.size()) {
      const double seen = last_ - departure(back);
      if (seen >= scales_.shortest) {
        const bool single = tumbles == 1;
        found.runs.push_back(
            {seen, true, false, single && listed, single ? turn(back) : kNan, track});
      }
    }
  }

 private:
  /// The run that ends at standing i, free of noise's share.
  [[nodiscard]] double way(std::size_t i) const {
    const Place& from = standing_[i - 1].departure;
    const Place& to = standing_[i].arrival;
    const double length = distance(from, to);
    const double noise2 = scales_.sigma * scales_.sigma * (1 / from.frames + 1 / to.frames);
    return length - noise2 / (2 * length);
  }

  /// The bins of the run before standing i.
  [[nodiscard]] Stretch runBefore(std::size_t i) const {
    return {true, i > 0 ? standing_[i - 1].end : 0, standing_[i].begin};
  }
  [[nodiscard]] Stretch runBehind(std::size_t i) const {
    return {true, standing_[i].end,
            i + 1 < standing_.size() ? standing_[i + 1].begin : bins_.size()};
  }

  [[nodiscard]] bool joined(const Stretch& run) const {
    return bins_[run.begin].piece != bins_[run.end - 1].piece;
  }

  /// When the robot came to standing i: its way there on the line of the run, at the speed.
  /// @param rough by the nearest bins where the run is too short for that.
  [[nodiscard]] std::optional<double> arrivalBy(std::size_t i, bool rough) const {
    const Stretch run = runBefore(i);
    return edge(run, standing_[i].arrival, i > 0 ? &standing_[i - 1].departure : nullptr, 1, rough,
                standing_[i].begin);
  }
  [[nodiscard]] std::optional<double> departureBy(std::size_t i, bool rough) const {
    const Stretch run = runBehind(i);
    const bool last = i + 1 == standing_.size();
    return edge(run, standing_[i].departure, last ? nullptr : &standing_[i + 1].arrival, -1, rough,
                standing_[i].end);
  }

  [[nodiscard]] std::optional<double> edge(const Stretch& run, const Place& place,
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
      return meanTime(bins_, core);
    }
    dx /= length;
    dy /= length;
    const double left = (place.x - middle.x) * dx + (place.y - middle.y) * dy;
    return meanTime(bins_, core) + sign * left / scales_.speed;
  }

  /// Tumbles begun in view while the robot stood; one that was going on when the track began was
  /// not.
  [[nodiscard]] std::int64_t tumblesIn(double stood, bool cut_before, bool cut_behind) const {
    const double tumbles = stood / scales_.tumble;
    double count = std::floor(tumbles + kCountSlack);
    if (cut_before) {
      count = std::floor(tumbles);
    } else if (cut_behind) {
      count = std::ceil(tumbles - kCountSlack / 2);
    }
    return std::max<std::int64_t>(cut_before ? 0 : 1, static_cast<std::int64_t>(count));
  }

  /// The turn of the single tumble in standing i, whose runs before and behind are known.
  [[nodiscard]] double turn(std::size_t i) const {
    const Stretch before = runBefore(i);
    const Stretch behind = runBehind(i);
    // Where bins are averages, those at the edges have turned already.
    const std::size_t least = scales_.averaged ? 3 : 1;
    if (before.size() < least || behind.size() < least) {
      return kNan;
    }
    const double from = meanHeading(bins_, inner(before, scales_.averaged, 1));
    const double to = meanHeading(bins_, inner(behind, scales_.averaged, 1));
    if (std::isfinite(from) && std::isfinite(to)) {
      return to - from;
    }
    if (i == 0 || i + 1 >= standing_.size()) {
      return kNan;
    }
    const auto direction = [](const Place& a, const Place& b) {
      return std::atan2(b.y - a.y, b.x - a.x);
    };
    return std::remainder(direction(standing_[i].departure, standing_[i + 1].arrival) -
                              direction(standing_[i - 1].departure, standing_[i].arrival),
                          2 * std::numbers::pi);
  }

  std::span<const TrackBin> bins_;
  double first_;
  double last_;
  const Scales& scales_;
  std::vector<Stretch> stretches_;
  std::vector<Standing> standing_;
};

}  // namespace

RunFinder::RunFinder(const ProgramLaw& law, double frame_period)
    : law_(law), period_(frame_period) {
  frames_per_bin_ =
      std::max(1, static_cast<int>(std::floor(law.tau_t / kBinsPerTumble / frame_period + 1e-9)));
}

void RunFinder::add(const Sample& sample) {
  const bool gap = !tracks_.empty() && sample.free_time - tracks_.back().last >
                                           std::max(kLargestGap * law_.tau_t, 1.5 * period_);
  if (tracks_.empty() || sample.segment != segment_ || gap) {
    segment_ = sample.segment;
    tracks_.push_back({bins_.size(), sample.free_time, sample.free_time});
    bin_ = -1;
  }
  Track& track = tracks_.back();
  track.last = sample.free_time;
  const auto bin = static_cast<std::int64_t>(
      std::floor((sample.free_time - track.first) / (frames_per_bin_ * period_) + 1e-3));
  // Where every frame is a bin, time stamps that jitter must not put two into one.
  if (frames_per_bin_ == 1 || bin != bin_) {
    bin_ = bin;
    bins_.push_back({sample.free_time, sample.x, sample.y, sample.theta, 1, sample.piece});
    return;
  }
  TrackBin& mean = bins_.back();
  mean.frames += 1;
  mean.time += (sample.free_time - mean.time) / mean.frames;
  mean.x += (sample.x - mean.x) / mean.frames;
  mean.y += (sample.y - mean.y) / mean.frames;
  mean.theta += (sample.theta - mean.theta) / mean.frames;
  mean.piece = sample.piece;
}

FoundRuns RunFinder::find() const {
  FoundRuns found;
  found.frames_per_tumble = law_.tau_t / period_;
  found.resolved = found.frames_per_tumble >= kFewestFrames && law_.v > 0;
  if (!found.resolved) {
    return found;
  }
  Scales scales{law_.v, law_.tau_t,         roughNoise(bins_), frames_per_bin_ * period_,
                0,      frames_per_bin_ > 1};
  std::vector<CutTrack> cuts;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    scales.setShortest(period_);
    cuts.clear();
    Sums sums;
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      const std::size_t end = t + 1 < tracks_.size() ? tracks_[t + 1].begin : bins_.size();
      const std::span<const TrackBin> bins(bins_.data() + tracks_[t].begin, end - tracks_[t].begin);
      if (tracks_[t].last > tracks_[t].first) {
        cuts.emplace_back(bins, tracks_[t].first, tracks_[t].last, scales);
        cuts.back().gather();
        cuts.back().measure(sums);
      }
    }
    const Scales before = scales;
    found.speed = sums.speed(scales.sigma);
    found.tumble = sums.tumble();
    found.tumble.sigma = std::hypot(found.tumble.sigma, kEdgeShare * scales.sigma / scales.speed);
    if (found.speed.value > 0) {
      scales.speed = found.speed.value;
    }
    if (found.tumble.value > 0) {
      scales.tumble = found.tumble.value;
    }
    if (sums.freedom > 0) {
      scales.sigma = std::sqrt(sums.noise2 / sums.freedom);
    }
    const double change = std::max(std::abs(scales.speed / before.speed - 1),
                                   0.1 * std::abs(scales.tumble / before.tumble - 1));
    if (pass > 0 && change < kScaleTolerance) {
      break;
    }
  }
  scales.setShortest(period_);
  for (CutTrack& cut : cuts) {
    cut.gather();
    cut.collect(found);
  }
  found.shortest = scales.shortest;
  found.sigma = scales.sigma;
  return found;
}

}  // namespace lab::analysis
