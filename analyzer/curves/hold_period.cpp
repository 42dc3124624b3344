#include "analyzer/curves/hold_period.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "analyzer/laws/law.hpp"

namespace lab::analysis {
namespace {

constexpr double kHoldsPerBlock = 16;
constexpr double kFramesPerHold = 4;  // at least; below, lines of other orders lie near
// Headings of a hold are kept for every robot and program: 200 kB.
constexpr double kMostFramesPerHold = 20'000;
constexpr double kLeastSeen = 0.7;  // share of a block's differences
// The noise of the heading does not grow with the distance of its differences, what they show does.
constexpr double kPartOfHold = 3;
constexpr double kDifferencesPerHold = 12;
constexpr double kEven = 0.25;   // deviation of a frame's distance, in frame periods
constexpr double kWidth = 0.25;  // of the frequencies, around the programmed one
constexpr double kFewestBlocks = 8;
constexpr std::ptrdiff_t kPeak = 5;     // frequencies on both sides of the line that its fit uses
constexpr double kSignificance = 6;     // of the line, in standard errors of the noise
constexpr double kDisplacement = 2e-4;  // relative, of the line by what subtractScatter() leaves

double frequencyOf(std::size_t index) {
  return 1 - kWidth + 2 * kWidth * static_cast<double>(index) / (HoldSpectra::kFrequencies - 1);
}

/// The power of a single change, which gives differences (reach - |t|)^2. The scatter of the
/// changes has this spectrum, below the line of their mean.
double powerOfChange(double reach, double frequency) {
  const double x = 2 * std::numbers::pi * frequency * reach;
  const double amplitude = (x - std::sin(x)) / (x * x * x);
  return amplitude * amplitude;
}

/// Subtracts the spectrum of the scatter, which falls with the frequency and would displace the
/// line. Its size is that of the frequencies beside the line.
void subtractScatter(HoldSpectra::Spectrum& power, double reach) {
  constexpr double kLobe = 2 / kHoldsPerBlock;  // half the width of a line, of Hann's window
  const double line = frequencyOf(
      static_cast<std::size_t>(std::max_element(power.begin(), power.end()) - power.begin()));
  double scatter = 0;
  double beside = 0;
  for (std::size_t i = 0; i < power.size(); ++i) {
    if (std::abs(frequencyOf(i) - line) <= kLobe) continue;
    scatter += power[i] / powerOfChange(reach, frequencyOf(i));
    beside += 1;
  }
  for (std::size_t i = 0; i < power.size(); ++i) {
    power[i] -= scatter / beside * powerOfChange(reach, frequencyOf(i));
  }
}

/// The relative frequency of the line in a spectrum, without the scatter: the maximum of a
/// parabola.
std::optional<double> lineIn(HoldSpectra::Spectrum power, double reach) {
  subtractScatter(power, reach);
  const auto top = std::max_element(power.begin(), power.end()) - power.begin();
  if (top < kPeak || top + kPeak >= static_cast<std::ptrdiff_t>(power.size())) return std::nullopt;
  // Least squares of a + b x + c x^2 at x = -kPeak .. kPeak.
  double sum0 = 0;
  double sum1 = 0;
  double sum2 = 0;
  double square = 0;
  double fourth = 0;
  constexpr double n = 2 * kPeak + 1;
  for (std::ptrdiff_t x = -kPeak; x <= kPeak; ++x) {
    const double y = power[static_cast<std::size_t>(top + x)];
    const auto position = static_cast<double>(x);
    sum0 += y;
    sum1 += position * y;
    sum2 += position * position * y;
    square += position * position;
    fourth += position * position * position * position;
  }
  const double slope = sum1 / square;
  const double curvature = (sum2 - square / n * sum0) / (fourth - square * square / n);
  if (!(curvature < 0)) return std::nullopt;
  const double shift = std::clamp(-slope / (2 * curvature), -double{kPeak}, double{kPeak});
  constexpr double kStep = 2 * kWidth / (HoldSpectra::kFrequencies - 1);
  return frequencyOf(static_cast<std::size_t>(top)) + shift * kStep;
}

HoldSpectra::Spectrum sumOf(const HoldSpectra& spectra, std::size_t without) {
  HoldSpectra::Spectrum sum{};
  for (std::size_t group = 0; group < HoldSpectra::kGroups; ++group) {
    if (group == without) continue;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += spectra.power[group][i];
  }
  return sum;
}

}  // namespace

void HoldSpectra::pool(const HoldSpectra& other) {
  if (other.hold == 0) return;
  hold = other.hold;
  reach = other.reach;
  for (std::size_t group = 0; group < kGroups; ++group) {
    blocks[group] += other.blocks[group];
    for (std::size_t i = 0; i < kFrequencies; ++i) power[group][i] += other.power[group][i];
  }
}

bool HoldPeriodFinder::resolves(double hold, double frame_period) {
  return frame_period > 0 && hold >= kFramesPerHold * frame_period &&
         hold <= kMostFramesPerHold * frame_period;
}

HoldPeriodFinder::HoldPeriodFinder(double hold, double frame_period)
    : period_(frame_period), block_(kHoldsPerBlock * hold) {
  spectra_.hold = hold;
  const double frames = hold / frame_period;
  distance_ = static_cast<std::size_t>(std::max(1.0, std::floor(frames / kPartOfHold)));
  stride_ = static_cast<std::size_t>(std::max(1.0, std::floor(frames / kDifferencesPerHold)));
  headings_.resize(2 * distance_ + 1);
  spectra_.reach = static_cast<double>(distance_) / frames;
}

void HoldPeriodFinder::add(const Sample& sample) {
  const bool follows = known_ > 0 && sample.angular_segment == last_.angular_segment &&
                       sample.piece == last_.piece && std::isfinite(sample.theta) &&
                       std::abs(sample.free_time - last_.free_time - period_) < kEven * period_;
  // Free time is comparable within a segment only.
  if (known_ > 0 && sample.segment != last_.segment) changes_.clear();
  if (!changes_.empty() && sample.free_time - begin_ >= block_) endBlock();
  known_ = follows ? known_ + 1 : 1;
  last_ = sample;
  const std::size_t size = headings_.size();
  headings_[++count_ % size] = {sample.free_time, sample.theta};
  if (known_ < size || count_ % stride_ != 0) return;
  const Heading& middle = headings_[(count_ + size - distance_) % size];
  const double change =
      sample.theta - 2 * middle.theta + headings_[(count_ + size - 2 * distance_) % size].theta;
  if (changes_.empty()) begin_ = middle.time;
  if (middle.time >= begin_ && std::isfinite(change)) {
    changes_.push_back({middle.time, change * change});
  }
}

void HoldPeriodFinder::endBlock() {
  const double all_changes = block_ / period_ / static_cast<double>(stride_);
  if (static_cast<double>(changes_.size()) >= kLeastSeen * all_changes) {
    std::vector<double> weights;
    double all = 0;
    double mean = 0;
    for (const Change& change : changes_) {
      // Hann's window.
      const double phase = std::numbers::pi * (change.time - begin_) / block_;
      weights.push_back(std::sin(phase) * std::sin(phase));
      all += weights.back();
      mean += weights.back() * change.square;
    }
    mean /= all;
    const std::size_t group = next_group_++ % HoldSpectra::kGroups;
    if (mean > 0) {
      for (std::size_t k = 0; k < changes_.size(); ++k) {
        weights[k] *= (changes_[k].square / mean - 1) / all;
      }
      addPower(weights, spectra_.power[group]);
      spectra_.blocks[group] += 1;
    }
  }
  changes_.clear();
}

void HoldPeriodFinder::addPower(const std::vector<double>& amplitudes,
                                HoldSpectra::Spectrum& power) const {
  std::array<std::complex<double>, HoldSpectra::kFrequencies> sums{};
  const double first = 2 * std::numbers::pi * frequencyOf(0) / spectra_.hold;
  const double step = 2 * std::numbers::pi * frequencyOf(1) / spectra_.hold - first;
  for (std::size_t k = 0; k < amplitudes.size(); ++k) {
    const double time = changes_[k].time - begin_;
    // The frequencies are equidistant, so one rotation leads from each to the next.
    double re = amplitudes[k] * std::cos(first * time);
    double im = amplitudes[k] * std::sin(first * time);
    const double cos = std::cos(step * time);
    const double sin = std::sin(step * time);
    for (std::complex<double>& sum : sums) {
      sum += std::complex<double>(re, im);
      const double next = re * cos - im * sin;
      im = re * sin + im * cos;
      re = next;
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) power[i] += std::norm(sums[i]);
}

std::optional<HoldPeriod> holdPeriod(const HoldSpectra& spectra) {
  if (spectra.hold == 0) return std::nullopt;
  HoldPeriod period;
  period.programmed = spectra.hold;
  for (const double blocks : spectra.blocks) period.blocks += blocks;
  if (period.blocks < kFewestBlocks) return std::nullopt;
  const HoldSpectra::Spectrum all = sumOf(spectra, HoldSpectra::kGroups);
  HoldSpectra::Spectrum sorted = all;
  std::ranges::sort(sorted);
  const double usual = sorted[sorted.size() / 4];
  if (sorted.back() < usual * (1 + kSignificance / std::sqrt(period.blocks))) return std::nullopt;
  const std::optional<double> line = lineIn(all, spectra.reach);
  if (!line) return std::nullopt;
  double sum = 0;
  double squares = 0;
  double groups = 0;
  for (std::size_t group = 0; group < HoldSpectra::kGroups; ++group) {
    if (spectra.blocks[group] == 0) continue;
    const std::optional<double> without = lineIn(sumOf(spectra, group), spectra.reach);
    if (!without) return std::nullopt;
    groups += 1;
    sum += *without;
    squares += *without * *without;
  }
  const double variance =
      std::max(0.0, (squares - sum * sum / groups) * (groups - 1) / groups);  // the jackknife's
  period.value = spectra.hold / *line;
  period.sigma = period.value * std::hypot(std::sqrt(variance) / *line, kDisplacement);
  const double relative = std::hypot(period.sigma / period.value, kClockError);
  period.z = -std::log(*line) / relative;
  return period;
}

}  // namespace lab::analysis
