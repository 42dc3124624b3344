#include "analyzer/bootstrap/recording_gaps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "analyzer/tracks/track_stitcher.hpp"
#include "common/math/saturated.hpp"

namespace lab::analysis {

double SegmentLengths::lengthOf(std::size_t bin) {
  static const std::array<double, kBins> kLengths = [] {
    std::array<double, kBins> lengths;
    for (std::size_t i = 0; i < kBins; ++i) {
      lengths[i] = std::exp2((static_cast<double>(i) + 0.5) / 4);
    }
    return lengths;
  }();
  return kLengths[bin];
}

void SegmentLengths::add(double frames) {
  const double bin = 4 * std::log2(std::max(frames, 1.0));
  ++counts_[std::min(saturated<std::size_t>(bin), kBins - 1)];
}

SegmentLengths& SegmentLengths::operator+=(const SegmentLengths& other) {
  for (std::size_t i = 0; i < kBins; ++i) counts_[i] += other.counts_[i];
  return *this;
}

double SegmentLengths::number() const {
  return std::accumulate(counts_.begin(), counts_.end(), 0.0);
}

double SegmentLengths::covered(double lag) const {
  double all = 0;
  double within = 0;
  for (std::size_t i = 0; i < kBins; ++i) {
    if (counts_[i] == 0) continue;
    all += counts_[i] * lengthOf(i);
    within += counts_[i] * std::max(lengthOf(i) - lag, 0.0);
  }
  return all > 0 ? within / all : 1;
}

template <typename Weight>
double SegmentLengths::drawBy(Random& random, const Weight& weight) const {
  double all = 0;
  for (std::size_t i = 0; i < kBins; ++i) all += counts_[i] * weight(lengthOf(i));
  double left = random.uniform() * all;
  std::size_t last = 0;
  for (std::size_t i = 0; i < kBins; ++i) {
    if (counts_[i] == 0) continue;
    last = i;
    left -= counts_[i] * weight(lengthOf(i));
    if (left < 0) break;
  }
  return lengthOf(last);
}

double SegmentLengths::draw(Random& random) const {
  return drawBy(random, [](double) { return 1.0; });
}

double SegmentLengths::drawAround(Random& random) const {
  return drawBy(random, [](double length) { return length; });
}

RecordingStretches drawStretches(const RecordingGaps& gaps, double frame_period, double period,
                                 std::size_t frames, std::uint64_t seed) {
  const double every = std::max(1.0, std::round(period / frame_period));
  // The effect of lost windows on a mean is proportional to the duration of the gaps. With fewer
  // frames than in the measurement, fewer frames are lost, with the same effect.
  const double length = std::max(1.0, gaps.lost_length / every);
  const double odds = gaps.lost / (1 - gaps.lost) * gaps.lost_length / (length * every);
  const double longest = StitcherConfig{}.max_angular_gap / period;
  Random random(seed);
  RecordingStretches out;
  out.of_places.resize(frames, -1);
  out.of_headings.resize(frames, -1);
  int places = 0;
  int headings = 0;
  bool is_seen = random.uniform() * (1 + odds) >= odds;
  double cut = static_cast<double>(frames);
  if (gaps.cut) cut = random.uniform() * gaps.segments.drawAround(random) * frame_period / period;
  std::size_t last = 0;
  for (std::size_t i = 0; i < frames; ++i) {
    while (static_cast<double>(i) >= cut) {
      ++places;
      ++headings;
      cut += gaps.segments.draw(random) * frame_period / period;
    }
    if (is_seen) {
      if (static_cast<double>(i - last) > longest) ++headings;
      out.of_places[i] = places;
      out.of_headings[i] = headings;
      last = i;
    }
    is_seen = random.uniform() >= (is_seen ? odds : length - 1) / length;
  }
  return out;
}

}  // namespace lab::analysis
