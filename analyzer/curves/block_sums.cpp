#include "analyzer/curves/block_sums.hpp"

namespace lab::analysis {

BlockCounts& BlockCounts::operator+=(const BlockCounts& other) {
  time += other.time;
  forward += other.forward;
  forward_time += other.forward_time;
  sideways2 += other.sideways2;
  steps += other.steps;
  long_steps += other.long_steps;
  long_frames2 += other.long_frames2;
  breaks += other.breaks;
  turn += other.turn;
  turn_time += other.turn_time;
  joins += other.joins;
  lost += other.lost;
  lost2 += other.lost2;
  unseen += other.unseen;
  segments += other.segments;
  run_time += other.run_time;
  run_span += other.run_span;
  tumbles += other.tumbles;
  return *this;
}

BlockCounts& BlockCounts::operator-=(const BlockCounts& other) {
  time -= other.time;
  forward -= other.forward;
  forward_time -= other.forward_time;
  sideways2 -= other.sideways2;
  steps -= other.steps;
  long_steps -= other.long_steps;
  long_frames2 -= other.long_frames2;
  breaks -= other.breaks;
  turn -= other.turn;
  turn_time -= other.turn_time;
  joins -= other.joins;
  lost -= other.lost;
  lost2 -= other.lost2;
  unseen -= other.unseen;
  segments -= other.segments;
  run_time -= other.run_time;
  run_span -= other.run_span;
  tumbles -= other.tumbles;
  return *this;
}

BlockSums& BlockSums::operator+=(const BlockSums& other) {
  BlockCounts::operator+=(other);
  if (lags.size() < other.lags.size()) {
    lags.resize(other.lags.size());
  }
  for (std::size_t i = 0; i < other.lags.size(); ++i) {
    lags[i] += other.lags[i];
  }
  return *this;
}

BlockTrack::BlockTrack(std::initializer_list<BlockSums> blocks) : open_(*(blocks.end() - 1)) {
  auto closed = std::make_shared<ClosedBlocks>();
  closed->blocks.assign(blocks.begin(), blocks.end() - 1);
  for (const BlockSums& block : closed->blocks) closed->total += block;
  closed_ = std::move(closed);
}

void BlockData::pool(const BlockData& other) {
  holds.pool(other.holds);
  if (lags.empty()) {
    *this = other;
    return;
  }
  tracks.insert(tracks.end(), other.tracks.begin(), other.tracks.end());
  segments += other.segments;
  for (std::size_t i = 0; i < lag_times.size(); ++i) {
    lag_times[i] += other.lag_times[i];
  }
}

BlockSums BlockData::total() const {
  BlockSums sum;
  sum.lags.resize(lags.size());
  for (const BlockTrack& track : tracks) {
    sum += track.closedTotal();
    sum += track.open();
  }
  return sum;
}

double coveredShare(const RecordingGaps& gaps, double lag, const LagSums& sums, bool angular) {
  const double covered = gaps.covered(lag);
  if (!angular) return covered;
  if (sums.windows == 0) return 0;
  return covered * static_cast<double>(sums.angular_windows) / sums.windows;
}

RecordingGaps gapsOf(const BlockData& data, const BlockSums& total) {
  RecordingGaps gaps;
  gaps.segments = data.segments;
  gaps.cut = data.segments.number() > static_cast<double>(data.tracks.size());
  if (total.lost > 0) {
    const double all = total.time + total.unseen;
    gaps.lost = total.lost * data.frame_period / all;
    // For geometrically distributed lengths the mean square is 2 length^2 - length.
    gaps.lost_length = 0.5 * (total.lost2 / total.lost + 1);
    gaps.unseen = total.unseen / all;
  }
  return gaps;
}

double BlockData::observed() const {
  double time = 0;
  for (const BlockTrack& track : tracks) {
    time += track.closedTotal().time;
    time += track.open().time;
  }
  return time;
}

double BlockData::lagTime(std::size_t i, const BlockSums& total) const {
  const std::uint32_t n = total.lags[i].windows;
  return n > 0 ? lag_times[i] / n : lags[i] * frame_period;
}

}  // namespace lab::analysis
