#include "analyzer/curves/msd_accumulator.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>

#include "analyzer/curves/cos_sin.hpp"
#include "analyzer/curves/window_choice.hpp"

namespace lab::analysis {
namespace {

constexpr double kFirstBlock = 0.25;   // s
constexpr double kLongestStep = 0.3;   // s between frames; longer gaps do not count as observed
constexpr double kLongestGap = 2;      // s; longer gaps do not count as lost frames
constexpr double kMostLost = 1 << 24;  // frames; no window spans them, and slots would overflow
constexpr double kSameTime = 1e-3;  // frame periods; a reversal may last a whole number of frames
constexpr int kFraction = 24;       // binary digits of a slot after the point
constexpr std::size_t kBegin = FrameHistory::kHistory;

std::int64_t wholeSlot(std::uint64_t slot) { return static_cast<std::int64_t>(slot >> kFraction); }

/// Two windows in parallel. All machines have registers of this size, so the order of additions,
/// and with it every bit, is the same on all.
using Pair = double __attribute__((vector_size(16)));

Pair load(const double* at) {
  Pair pair;
  std::memcpy(&pair, at, sizeof(pair));
  return pair;
}

struct PairSums {
  Pair time{};
  Pair r2{};
  Pair a2{};
  Pair r4{};
  Pair a4{};

  void add(Pair dt, Pair dx, Pair dy, Pair turn) {
    const Pair dr2 = dx * dx + dy * dy;
    const Pair da2 = turn * turn;
    time += dt;
    r2 += dr2;
    a2 += da2;
    r4 += dr2 * dr2;
    a4 += da2 * da2;
  }
};

double sum(Pair pair) { return pair[0] + pair[1]; }

}  // namespace

MsdAccumulator::MsdAccumulator(std::vector<int> lags, double frame_period, bool turns_on_the_spot)
    : lags_(std::move(lags)),
      turns_on_the_spot_(turns_on_the_spot),
      frame_period_(frame_period),
      lag_times_(lags_.size()),
      blocks_(lags_.size(), std::max(kFirstBlock, 2 * frame_period)),
      period_time_(1),
      period_frames_(1 / frame_period),
      period_(frame_period) {
  const auto dense_end = std::lower_bound(lags_.begin(), lags_.end(), kDenseLags);
  dense_lags_ = static_cast<std::size_t>(dense_end - lags_.begin());
  for (std::size_t i = dense_lags_; i < lags_.size(); ++i) {
    if (i == dense_lags_ || octaveOf(lags_[i]) != octaveOf(lags_[i - 1])) {
      levels_.emplace_back().stride =
          static_cast<std::uint64_t>(std::ldexp(strideOf(octaveOf(lags_[i])), kFraction));
    }
    cursors_.push_back({0, lags_[i], static_cast<std::uint16_t>(levels_.size() - 1), 0});
  }
  levels_.shrink_to_fit();
  cursors_.shrink_to_fit();
}

BlockData MsdAccumulator::data() const {
  if (frames_.count() > 0) {
    MsdAccumulator all = *this;
    all.flush();
    return all.data();
  }
  BlockData data{lags_, frame_period_, lag_times_, {}, segments_};
  data.tracks.push_back(blocks_.blocks());
  if (!empty_) data.segments.add(segmentFrames());
  return data;
}

std::size_t MsdAccumulator::memoryBytes() const {
  return sizeof(*this) + lags_.capacity() * sizeof(int) + lag_times_.capacity() * sizeof(double) +
         blocks_.memoryBytes() - sizeof(blocks_) + levels_.capacity() * sizeof(Level) +
         cursors_.capacity() * sizeof(Cursor);
}

void MsdAccumulator::add(const Sample& sample) {
  if (!std::isfinite(sample.free_time)) return;
  if (empty_ || sample.segment != last_.segment) {
    beginSegment(sample);
  } else {
    const double dt = sample.free_time - last_.free_time;
    const bool next = sample.piece == last_.piece &&
                      sample.angular_segment == last_.angular_segment && dt >= 0.5 * period_ &&
                      dt < 1.5 * period_;
    if (!next) {
      if (!resume(sample, dt)) return;
    } else {
      if (frames_.full() || blocks_.wouldClose(dt)) flush();
      blocks_.addTime(dt);
    }
  }
  frames_.push({0, sample.free_time, sample.x, sample.y, sample.theta});
  last_ = sample;
}

double MsdAccumulator::segmentFrames() const {
  return (last_.free_time - segment_begin_) / period_ + 1;
}

void MsdAccumulator::beginSegment(const Sample& sample) {
  flush();
  if (!empty_) segments_.add(segmentFrames());
  segment_begin_ = sample.free_time;
  frames_.forget();
  segment_first_ = frames_.first();
  piece_first_ = frames_.first();
  angular_first_ = frames_.first();
  unbroken_ = 0;
  first_step_done_ = true;
  counted_ = sample;
  blocks_.openBlock().segments += 1;
  for (Cursor& cursor : cursors_) {
    cursor.start = levels_[cursor.level].head;  // no window begins before the segment
    cursor.due = frames_.first();
  }
  empty_ = false;
}

bool MsdAccumulator::resume(const Sample& sample, double dt) {
  flush();
  const double frames = std::round(dt / period_);
  if (!(frames >= 1)) {
    return false;  // shortly after a join: closer to the last slot than to the next one
  }
  if (frames > kMostLost) {
    beginSegment(sample);
    return true;
  }
  const bool is_hole = dt > std::max(kLongestStep, 1.5 * period_);
  blocks_.addTime(is_hole ? period_ : dt);
  const bool join = sample.piece != last_.piece;
  if (!join && frames > 1 && dt <= kLongestGap) {
    BlockSums& block = blocks_.openBlock();
    block.lost += frames - 1;
    block.lost2 += (frames - 1) * (frames - 1);
    if (is_hole) block.unseen += dt - period_;
  }
  addStep({0, sample.free_time, sample.x, sample.y, sample.theta}, frames, join);
  first_step_done_ = true;
  frames_.lose(static_cast<std::int64_t>(frames) - 1);
  unbroken_ = 0;
  if (join) {
    piece_first_ = frames_.first();
    for (Cursor& cursor : cursors_)
      cursor.due = frames_.first();  // ends now go by time, not by slot
  }
  if (sample.angular_segment != last_.angular_segment) angular_first_ = frames_.first();
  return true;
}

double MsdAccumulator::shortened(double turn, double frames) const {
  // The estimate of the speed corrects what a step of one frame has (Estimator). A part of a run is
  // projected on the mean heading: shorter by turn^2 / 8, which is proportional to dt^3 for a turn
  // that begins or ends at a random time of the step. The chord of an arc is shorter by turn^2
  // / 24.
  return turns_on_the_spot_ ? turn * turn * (1 - 1 / (frames * frames * frames)) / 8
                            : turn * turn * (1 - 1 / (frames * frames)) / 24;
}

/// Adds the step to a frame that does not directly follow the previous one.
void MsdAccumulator::addStep(const Fix& to, double frames, bool join) {
  const double dt = to.time - previous_.time;
  if (!join) {
    period_time_ += dt;
    period_frames_ += frames;
    period_ = period_time_ / period_frames_;
  }
  if (dt > kLongestStep && frames > 1) {
    blocks_.openBlock().breaks += 1;
    return;
  }
  // The step across a join counts too: robots meet walls while they move, so leaving it out would
  // select slow steps.
  const double heading = 0.5 * (previous_.theta + to.theta);
  if (!std::isfinite(heading)) {
    return;
  }
  double c = 0;
  double s = 0;
  cosSin(&heading, 1, &c, &s);
  const double dx = to.x - previous_.x;
  const double dy = to.y - previous_.y;
  const double turn = join ? 0 : to.theta - previous_.theta;
  BlockSums& block = blocks_.openBlock();
  block.forward += (1 + shortened(turn, frames)) * (c * dx + s * dy);
  block.forward_time += dt;
  block.joins += join ? 1 : 0;
  if (!join) {
    block.turn += turn;
    block.turn_time += dt;
  }
  if (frames > 1) {
    block.long_steps += 1;
    block.long_frames2 += frames * frames;
  }
  if (frames == 1 && !join) {
    const double sideways = c * dy - s * dx;
    block.sideways2 += sideways * sideways;
    block.steps += 1;
  }
}

void MsdAccumulator::flush() {
  if (frames_.count() == 0) return;
  addSteps();
  addDenseWindows();
  for (std::size_t c = 0; c < cursors_.size(); ++c) {
    if (cursors_[c].due <= frames_.newest()) endLongWindows(c);
  }
  static_assert(FrameHistory::kCollection <= kDenseLags, "a window may end where it begins");
  for (Level& level : levels_) beginLongWindows(level);
  BlockSums& block = blocks_.openBlock();
  block.run_time += last_.run_time - counted_.run_time;
  block.run_span += last_.free_time - counted_.free_time;
  block.tumbles += static_cast<double>(last_.tumble_count - counted_.tumble_count);
  counted_ = last_;
  previous_ = frames_.at(frames_.end() - 1);
  unbroken_ += frames_.count();
  frames_.retire();
  first_step_done_ = false;
}

/// Adds the steps between consecutive frames of the collection.
void MsdAccumulator::addSteps() {
  const std::size_t first = kBegin + (first_step_done_ ? 1 : 0);
  const std::size_t steps = frames_.end() - first;
  const FrameHistory::Values& time = frames_.time();
  const FrameHistory::Values& x = frames_.x();
  const FrameHistory::Values& y = frames_.y();
  const FrameHistory::Values& theta = frames_.theta();
  std::array<double, FrameHistory::kCollection> headings{};
  std::array<double, FrameHistory::kCollection> cosines;
  std::array<double, FrameHistory::kCollection> sines;
  for (std::size_t k = 0; k < steps; ++k) {
    headings[k] = 0.5 * (theta[first + k - 1] + theta[first + k]);
  }
  cosSin(headings.data(), steps, cosines.data(), sines.data());
  BlockSums sums;
  for (std::size_t k = 0; k < steps; ++k) {
    if (!std::isfinite(headings[k])) continue;
    const std::size_t at = first + k;
    const double dx = x[at] - x[at - 1];
    const double dy = y[at] - y[at - 1];
    const double sideways = cosines[k] * dy - sines[k] * dx;
    sums.forward += cosines[k] * dx + sines[k] * dy;
    sums.forward_time += time[at] - time[at - 1];
    sums.sideways2 += sideways * sideways;
    sums.steps += 1;
    sums.turn += theta[at] - theta[at - 1];
    sums.turn_time += time[at] - time[at - 1];
  }
  blocks_.openBlock() += sums;
  period_time_ += time[first + steps - 1] - time[first - 1];
  period_frames_ += static_cast<double>(steps);
  period_ = period_time_ / period_frames_;
}

void MsdAccumulator::addDenseWindows() {
  std::array<Ends, kSteps> ends;
  for (std::size_t j = 0; j < frames_.count(); ++j) {
    const auto slot = static_cast<std::uint64_t>(frames_.first()) + j;
    const std::size_t most = std::min(mostStepAt(slot), kSteps - 1);
    for (std::size_t step = 0; step <= most; ++step) {
      ends[step].at[ends[step].count++] = static_cast<std::uint32_t>(kBegin + j);
    }
  }
  for (std::size_t i = 0; i < dense_lags_; ++i) addWindows(i, ends[stepOf(lags_[i])]);
}

/// Adds the windows of a dense lag that end at these frames.
void MsdAccumulator::addWindows(std::size_t i, const Ends& ends) {
  const auto lag = static_cast<std::size_t>(lags_[i]);
  std::size_t k = 0;
  for (; k < ends.count && ends.at[k] + unbroken_ < kBegin + lag; ++k) {
    addBrokenWindow(i, ends.at[k]);
  }
  PairSums sums;
  const auto windows = static_cast<std::uint32_t>(ends.count - k);
  if (lags_[i] < kEveryLags) {  // all frames: consecutive pairs in memory
    for (; k + 1 < ends.count; k += 2) {
      const std::size_t a = kBegin + k;
      const auto differences = [&](const auto& of) {
        return load(of.data() + a) - load(of.data() + (a - lag));
      };
      sums.add(differences(frames_.time()), differences(frames_.x()), differences(frames_.y()),
               differences(frames_.theta()));
    }
  }
  for (; k + 1 < ends.count; k += 2) {
    const std::size_t a = ends.at[k];
    const std::size_t b = ends.at[k + 1];
    const auto differences = [&](const auto& of) {
      return Pair{of[a], of[b]} - Pair{of[a - lag], of[b - lag]};
    };
    sums.add(differences(frames_.time()), differences(frames_.x()), differences(frames_.y()),
             differences(frames_.theta()));
  }
  if (k < ends.count) {
    const std::size_t a = ends.at[k];
    const auto difference = [&](const auto& of) { return Pair{of[a] - of[a - lag], 0}; };
    sums.add(difference(frames_.time()), difference(frames_.x()), difference(frames_.y()),
             difference(frames_.theta()));
  }
  LagSums& lag_sums = blocks_.openBlock().lags[i];
  lag_times_[i] += sum(sums.time);
  lag_sums.windows += windows;
  lag_sums.angular_windows += windows;
  lag_sums.r2 += sum(sums.r2);
  lag_sums.a2 += sum(sums.a2);
  lag_sums.r4 += sum(sums.r4);
  lag_sums.a4 += sum(sums.a4);
}

/// Adds a window that begins before the unbroken frames.
void MsdAccumulator::addBrokenWindow(std::size_t i, std::size_t end_position) {
  const Fix end = frames_.at(end_position);
  const std::int64_t start_slot = end.slot - lags_[i];
  if (start_slot < segment_first_) return;
  if (start_slot >= piece_first_) {
    const std::optional<Fix> start = frames_.find(start_slot);
    if (start) addWindow(i, *start, end, end.time - start->time);
    return;
  }
  const double lag = lags_[i] * period_;
  const std::optional<Fix> start = frames_.interpolated(end.time - lag, start_slot, period_);
  if (start) addWindow(i, *start, end, lag);
}

inline void MsdAccumulator::addWindow(std::size_t i, const Fix& start, const Fix& end,
                                      double duration) {
  const double dx = end.x - start.x;
  const double dy = end.y - start.y;
  const double r2 = dx * dx + dy * dy;
  LagSums& sums = blocks_.openBlock().lags[i];
  lag_times_[i] += duration;
  ++sums.windows;
  sums.r2 += r2;
  sums.r4 += r2 * r2;
  if (start.slot < angular_first_) return;
  const double turn = end.theta - start.theta;
  const double a2 = turn * turn;
  ++sums.angular_windows;
  sums.a2 += a2;
  sums.a4 += a2 * a2;
}

/// Stores the frames of the collection with which windows of the level begin.
void MsdAccumulator::beginLongWindows(Level& level) const {
  if (wholeSlot(level.next) < frames_.first()) {  // the frame was lost, or slots were skipped
    const auto now = static_cast<std::uint64_t>(frames_.first()) << kFraction;
    level.next += (now - level.next + level.stride - 1) / level.stride * level.stride;
  }
  for (; wholeSlot(level.next) <= frames_.newest(); level.next += level.stride) {
    level.fixes[level.head] = frames_.collected(wholeSlot(level.next));
    level.head = static_cast<std::uint16_t>((level.head + 1U) % kFixes);
  }
}

/// Adds the windows of a cursor that end in the collection, and drops those whose end was lost.
void MsdAccumulator::endLongWindows(std::size_t c) {
  Cursor& cursor = cursors_[c];
  const Level& level = levels_[cursor.level];
  for (; cursor.start != level.head;
       cursor.start = static_cast<std::uint16_t>((cursor.start + 1U) % kFixes)) {
    const Fix& start = level.fixes[cursor.start];
    if (start.slot >= piece_first_) {
      cursor.due = start.slot + cursor.lag;
      if (cursor.due > frames_.newest()) return;
      if (cursor.due >= frames_.first()) {  // else its end frame was lost
        const Fix end = frames_.collected(cursor.due);
        addWindow(dense_lags_ + c, start, end, end.time - start.time);
      }
      continue;
    }
    const double now = frames_.time()[frames_.end() - 1];
    const double ahead = (start.time - now) / period_ + cursor.lag;
    if (ahead > kSameTime) {
      cursor.due = frames_.newest() + std::max<std::int64_t>(1, static_cast<std::int64_t>(ahead));
      return;
    }
    addEndedAcrossJoin(dense_lags_ + c, start);
  }
  cursor.due = std::max(wholeSlot(level.next), frames_.first()) +
               cursor.lag;  // the next window has not begun
}

/// Adds a window that ends in the collection between two frames.
void MsdAccumulator::addEndedAcrossJoin(std::size_t i, const Fix& start) {
  const double lag = lags_[i] * period_;
  const double end_time = start.time + lag;
  std::size_t at = frames_.end() - 1;
  while (at > kBegin && frames_.time()[at - 1] >= end_time - kSameTime * period_) --at;
  const Fix before = at > kBegin ? frames_.at(at - 1) : previous_;
  const Fix after = frames_.at(at);
  const double step = after.time - before.time;
  const double w = (end_time - before.time) / step;
  if (!(w > -kSameTime) || step > kBracket * period_ || before.slot < segment_first_) {
    return;  // frames were lost there
  }
  const Fix end{after.slot, end_time, before.x + w * (after.x - before.x),
                before.y + w * (after.y - before.y),
                before.theta + w * (after.theta - before.theta)};
  addWindow(i, start, end, lag);
}

}  // namespace lab::analysis
