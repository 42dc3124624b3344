#include "analyzer/runs/run_finder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "analyzer/runs/segmented_track.hpp"
#include "common/math/units.hpp"
#include "light/median.hpp"

namespace lab::analysis {
namespace {

constexpr double kBinsPerTumble = 10;
constexpr double kLargestGap = 0.5;  // of a tumble; a longer gap could hide one
constexpr double kFewestFrames = 3;  // smallest number of frames in a tumble
constexpr double kEdgeShare = 0.03;  // systematic error of edges, in times to cross the noise
// Relative changes at which iterations end. The time from the middle of a run to a tumble is a
// distance over the speed, so an error of the speed enters the short tumble many times over.
constexpr double kSpeedTolerance = 0.0003;
constexpr double kTumbleTolerance = 0.03;
constexpr double kBendTolerance = 0.003;  // rad in a tumble
constexpr double kBendErrors = 3;         // a turning rate of runs within these errors of 0 is none
constexpr int kMostPasses = 4;

using units::kNan;

/// The noise of a frame from second differences of bins, in which straight motion cancels. Their
/// median ignores the edges of runs.
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
  // The sum of two squares of normal deviates has the median 2 ln 2.
  return std::sqrt(medianOf(squares) / (2 * std::numbers::ln2));
}

/// The bins of a track as seen from a frame that turns at `rate` [rad/s]: each displacement is
/// turned back by the angle turned until then. Arcs of this rate become straight lines, and stops
/// remain stops.
void appendStraightened(std::span<const TrackBin> bins, double rate, std::vector<TrackBin>& to) {
  const double start = bins.front().time;
  TrackBin straight = bins.front();
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const TrackBin& bin = bins[i];
    if (i > 0) {
      const TrackBin& before = bins[i - 1];
      const double angle = -rate * (0.5 * (bin.time + before.time) - start);
      const double dx = bin.x - before.x;
      const double dy = bin.y - before.y;
      straight.x += std::cos(angle) * dx - std::sin(angle) * dy;
      straight.y += std::sin(angle) * dx + std::cos(angle) * dy;
    }
    to.push_back({bin.time, straight.x, straight.y, bin.theta - rate * (bin.time - start),
                  bin.frames, bin.piece});
  }
}

}  // namespace

RunFinder::RunFinder(const ProgramLaw& law, double frame_period)
    : programmed_(law->runs().value_or(RunsAndTurns{})), period_(frame_period) {
  frames_per_bin_ = std::max(
      1,
      static_cast<int>(std::floor(programmed_.turn_time / kBinsPerTumble / frame_period + 1e-9)));
}

void RunFinder::add(const Sample& sample) {
  const bool gap =
      !tracks_.empty() && sample.free_time - tracks_.back().last >
                              std::max(kLargestGap * programmed_.turn_time, 1.5 * period_);
  if (tracks_.empty() || sample.segment != segment_ || gap) {
    segment_ = sample.segment;
    tracks_.push_back({bins_.size(), sample.free_time, sample.free_time});
    bin_ = -1;
  }
  Track& track = tracks_.back();
  track.last = sample.free_time;
  const auto bin = static_cast<std::int64_t>(
      std::floor((sample.free_time - track.first) / (frames_per_bin_ * period_) + 1e-3));
  // If every frame is a bin, jitter of time stamps must not put two frames into one bin.
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
  found.frames_per_tumble = programmed_.turn_time / period_;
  found.resolved = found.frames_per_tumble >= kFewestFrames && programmed_.speed > 0;
  if (!found.resolved) {
    return found;
  }
  segmentation::Scales scales{
      programmed_.speed,  programmed_.turn_time, roughNoise(bins_), frames_per_bin_ * period_, 0, 0,
      frames_per_bin_ > 1};
  std::vector<segmentation::SegmentedTrack> cuts;
  std::vector<TrackBin> straight;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    scales.setShortest(period_);
    cuts.clear();
    segmentation::ScaleSums sums;
    straight.clear();
    straight.reserve(bins_.size());
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
      const std::size_t end = t + 1 < tracks_.size() ? tracks_[t + 1].begin : bins_.size();
      appendStraightened({bins_.data() + tracks_[t].begin, end - tracks_[t].begin}, scales.rate,
                         straight);
      const std::span<const TrackBin> bins(straight.data() + tracks_[t].begin,
                                           end - tracks_[t].begin);
      if (tracks_[t].last > tracks_[t].first) {
        cuts.emplace_back(bins, tracks_[t].first, tracks_[t].last, scales);
        cuts.back().mergeStops();
        cuts.back().measure(sums);
      }
    }
    const segmentation::Scales before = scales;
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
    const Measured bend = sums.turningRate(scales.sigma, scales.speed);
    found.turning_rate = {scales.rate + bend.value, bend.sigma, kNan, bend.count};
    const bool same_speed = std::abs(scales.speed / before.speed - 1) < kSpeedTolerance;
    const bool same_tumble = std::abs(scales.tumble / before.tumble - 1) < kTumbleTolerance;
    const bool straightened =
        bend.count == 0 || std::abs(bend.value) * scales.tumble < kBendTolerance;
    if (pass > 0 && same_speed && same_tumble && straightened) {
      break;
    }
    if (std::abs(bend.value) > kBendErrors * bend.sigma) scales.rate += bend.value;
  }
  scales.setShortest(period_);
  for (segmentation::SegmentedTrack& cut : cuts) {
    cut.mergeStops();
    cut.collect(found);
  }
  found.shortest = scales.shortest;
  found.sigma = scales.sigma;
  return found;
}

}  // namespace lab::analysis
