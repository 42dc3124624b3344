#include "analyzer/msd_accumulator.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lab::analysis {
namespace {

constexpr std::size_t kMaxBlocks = 64;
constexpr double kFirstBlock = 0.25;  // s
constexpr double kLongestStep = 0.3;  // s between frames that still counts as observed
constexpr int kRingMargin = 64;       // slots beyond the longest lag, for joins
constexpr int kSearch = 8;            // slots
constexpr double kBracket = 2.2;      // frame periods between which a start is interpolated

/// log2 of the distance between the end frames used for a lag: from lag/16 to lag/8.
int strideLevel(int lag) {
  return lag < 16 ? 0 : static_cast<int>(std::bit_width(static_cast<unsigned>(lag) / 8)) - 1;
}

void combine(BlockSums& a, const BlockSums& b, double sign) {
  a.time += sign * b.time;
  a.forward += sign * b.forward;
  a.forward_time += sign * b.forward_time;
  a.sideways2 += sign * b.sideways2;
  a.steps += sign * b.steps;
  a.joins += sign * b.joins;
  a.run_time += sign * b.run_time;
  a.run_span += sign * b.run_span;
  a.tumbles += sign * b.tumbles;
  if (a.lags.size() < b.lags.size()) {
    a.lags.resize(b.lags.size());
  }
  for (std::size_t i = 0; i < b.lags.size(); ++i) {
    LagSums& to = a.lags[i];
    const LagSums& from = b.lags[i];
    to.windows = sign > 0 ? to.windows + from.windows : to.windows - from.windows;
    to.angular_windows = sign > 0 ? to.angular_windows + from.angular_windows
                                  : to.angular_windows - from.angular_windows;
    to.r2 += sign * from.r2;
    to.r4 += sign * from.r4;
    to.a2 += sign * from.a2;
    to.a4 += sign * from.a4;
  }
}

}  // namespace

BlockSums& BlockSums::operator+=(const BlockSums& other) {
  combine(*this, other, 1);
  return *this;
}

BlockSums& BlockSums::operator-=(const BlockSums& other) {
  combine(*this, other, -1);
  return *this;
}

void BlockData::pool(const BlockData& other) {
  if (lags.empty()) {
    *this = other;
    return;
  }
  tracks.insert(tracks.end(), other.tracks.begin(), other.tracks.end());
  for (std::size_t i = 0; i < lag_times.size(); ++i) {
    lag_times[i] += other.lag_times[i];
  }
}

BlockSums BlockData::total() const {
  BlockSums sum;
  sum.lags.resize(lags.size());
  for (const auto& track : tracks) {
    for (const BlockSums& block : track) {
      sum += block;
    }
  }
  return sum;
}

double BlockData::observed() const {
  double time = 0;
  for (const auto& track : tracks) {
    for (const BlockSums& block : track) {
      time += block.time;
    }
  }
  return time;
}

double BlockData::lagTime(std::size_t i, const BlockSums& total) const {
  const std::uint32_t n = total.lags[i].windows;
  return n > 0 ? lag_times[i] / n : lags[i] * frame_period;
}

MsdAccumulator::MsdAccumulator(std::vector<int> lags, double frame_period)
    : block_length_(std::max(kFirstBlock, 2 * frame_period)),
      period_time_(1),
      period_frames_(1 / frame_period),
      period_(frame_period) {
  const auto slots = std::bit_ceil(static_cast<std::size_t>(lags.back() + kRingMargin));
  ring_.resize(slots);
  mask_ = slots - 1;
  for (int level = 0; level <= 64; ++level) {
    active_.push_back(static_cast<std::size_t>(std::count_if(
        lags.begin(), lags.end(), [&](int lag) { return strideLevel(lag) <= level; })));
  }
  data_.frame_period = frame_period;
  data_.lag_times.resize(lags.size());
  data_.lags = std::move(lags);
  data_.tracks.resize(1);
  data_.tracks[0].emplace_back().lags.resize(data_.lags.size());
}

const MsdAccumulator::Fix* MsdAccumulator::find(std::int64_t slot) const {
  const Fix& fix = ring_[static_cast<std::size_t>(slot) & mask_];
  return slot >= segment_first_ && fix.slot == slot ? &fix : nullptr;
}

void MsdAccumulator::beginSegment() {
  slot_ += static_cast<std::int64_t>(ring_.size());  // makes every stored slot stale
  segment_first_ = slot_;
  piece_first_ = slot_;
  angular_first_ = slot_;
  in_segment_ = 0;
  in_piece_ = 0;
  in_angular_ = 0;
}

void MsdAccumulator::add(const Sample& sample) {
  Fix fix{0, sample.free_time, sample.x, sample.y, sample.theta};
  if (empty_ || sample.segment != last_.segment) {
    beginSegment();
  } else {
    const double dt = sample.free_time - last_.free_time;
    const double frames = std::round(dt / period_);
    if (frames < 1) {
      return;  // just after a join: nearer to the last slot than to the next one
    }
    const Fix from = ring_[static_cast<std::size_t>(slot_) & mask_];
    slot_ += static_cast<std::int64_t>(frames);
    addTime(dt);
    const bool join = sample.piece != last_.piece;
    if (join) {
      piece_first_ = slot_;
      in_piece_ = 0;
    }
    addStep(from, fix, frames, join);
    if (sample.angular_segment != last_.angular_segment) {
      angular_first_ = slot_;
      in_angular_ = 0;
    }
    BlockSums& block = data_.tracks[0].back();
    block.run_time += sample.run_time - last_.run_time;
    block.run_span += dt;
    block.tumbles += static_cast<double>(sample.tumble_count - last_.tumble_count);
  }
  empty_ = false;
  last_ = sample;
  fix.slot = slot_;
  ring_[static_cast<std::size_t>(slot_) & mask_] = fix;
  addWindows(fix);
}

void MsdAccumulator::addStep(const Fix& from, const Fix& to, double frames, bool join) {
  const double dt = to.time - from.time;
  if (!join) {
    period_time_ += dt;
    period_frames_ += frames;
    period_ = period_time_ / period_frames_;
  }
  if (dt > kLongestStep && frames > 1) {
    return;
  }
  // The step across a join counts too: robots meet walls while they move, so that leaving it out
  // would select slow steps.
  const double heading = 0.5 * (from.theta + to.theta);
  if (!std::isfinite(heading)) {
    return;
  }
  const double c = std::cos(heading);
  const double s = std::sin(heading);
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  BlockSums& block = data_.tracks[0].back();
  block.forward += c * dx + s * dy;
  block.forward_time += dt;
  block.joins += join ? 1 : 0;
  if (frames == 1 && !join) {
    const double sideways = c * dy - s * dx;
    block.sideways2 += sideways * sideways;
    block.steps += 1;
  }
}

void MsdAccumulator::addTime(double dt) {
  std::vector<BlockSums>& blocks = data_.tracks[0];
  blocks.back().time += dt > std::max(kLongestStep, 1.5 * period_) ? period_ : dt;
  if (blocks.back().time < block_length_) {
    return;
  }
  if (blocks.size() == kMaxBlocks) {
    for (std::size_t i = 0; i < kMaxBlocks / 2; ++i) {
      blocks[2 * i] += blocks[2 * i + 1];
      if (i > 0) {
        blocks[i] = std::move(blocks[2 * i]);
      }
    }
    blocks.resize(kMaxBlocks / 2);
    block_length_ *= 2;
  }
  blocks.emplace_back().lags.resize(data_.lags.size());
}

void MsdAccumulator::addWindows(const Fix& end) {
  const std::vector<int>& lags = data_.lags;
  const auto extend = [&](std::size_t& count, std::int64_t first) {
    while (count < lags.size() && lags[count] <= slot_ - first) {
      ++count;
    }
  };
  extend(in_segment_, segment_first_);
  extend(in_piece_, piece_first_);
  extend(in_angular_, angular_first_);

  constexpr std::uint64_t kGoldenRatio = 0x9E3779B97F4A7C15ULL;
  const auto level = std::countl_zero(static_cast<std::uint64_t>(slot_) * kGoldenRatio);
  const std::size_t active = std::min(active_[static_cast<std::size_t>(level)], in_segment_);
  const std::size_t direct = std::min(active, in_piece_);
  LagSums* sums = data_.tracks[0].back().lags.data();
  double* times = data_.lag_times.data();
  for (std::size_t i = 0; i < direct; ++i) {
    const std::int64_t slot = slot_ - lags[i];
    const Fix& start = ring_[static_cast<std::size_t>(slot) & mask_];
    if (start.slot != slot) {
      continue;
    }
    const double dx = end.x - start.x;
    const double dy = end.y - start.y;
    const double r2 = dx * dx + dy * dy;
    LagSums& sum = sums[i];
    ++sum.windows;
    sum.r2 += r2;
    sum.r4 += r2 * r2;
    times[i] += end.time - start.time;
    if (i < in_angular_) {
      const double turn = end.theta - start.theta;
      const double a2 = turn * turn;
      ++sum.angular_windows;
      sum.a2 += a2;
      sum.a4 += a2 * a2;
    }
  }
  for (std::size_t i = direct; i < active; ++i) {
    addJoinWindow(i, end);
  }
}

void MsdAccumulator::addJoinWindow(std::size_t i, const Fix& end) {
  const double lag = data_.lags[i] * period_;
  const std::optional<Fix> start = interpolated(end.time - lag, slot_ - data_.lags[i]);
  if (!start) {
    return;
  }
  const double r2 =
      (end.x - start->x) * (end.x - start->x) + (end.y - start->y) * (end.y - start->y);
  LagSums& sum = data_.tracks[0].back().lags[i];
  ++sum.windows;
  sum.r2 += r2;
  sum.r4 += r2 * r2;
  data_.lag_times[i] += lag;
  if (start->slot >= angular_first_) {
    const double a2 = (end.theta - start->theta) * (end.theta - start->theta);
    ++sum.angular_windows;
    sum.a2 += a2;
    sum.a4 += a2 * a2;
  }
}

std::optional<MsdAccumulator::Fix> MsdAccumulator::interpolated(double time,
                                                                std::int64_t guess) const {
  // Every join shifts the slots against free time by a part of a period, so correct the guess once.
  const Fix* near = nullptr;
  for (int back = 0; back < kSearch && near == nullptr; ++back) {
    near = find(guess - back);
  }
  if (near == nullptr) {
    return std::nullopt;
  }
  const std::int64_t centre = near->slot - std::lround((near->time - time) / period_);
  const Fix* after = nullptr;
  for (std::int64_t slot = std::min(slot_, centre + kSearch / 2); slot >= centre - kSearch / 2;
       --slot) {
    const Fix* fix = find(slot);
    if (fix == nullptr) {
      continue;
    }
    if (fix->time > time) {
      after = fix;
      continue;
    }
    if (after == nullptr || after->time - fix->time > kBracket * period_) {
      return std::nullopt;
    }
    const double w = (time - fix->time) / (after->time - fix->time);
    return Fix{fix->slot, time, fix->x + w * (after->x - fix->x), fix->y + w * (after->y - fix->y),
               fix->theta + w * (after->theta - fix->theta)};
  }
  return std::nullopt;
}

}  // namespace lab::analysis
