#include "analyzer/msd_accumulator.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

namespace lab::analysis {
namespace {

constexpr double kFirstBlock = 0.25;  // s
constexpr double kLongestStep = 0.3;  // s between frames that still counts as observed
constexpr int kSearch = 8;            // slots
constexpr double kBracket = 2.2;      // frame periods between which an end is interpolated
constexpr double kSameTime = 1e-3;    // frame periods: a reversal may last a whole number of them
constexpr int kFraction = 24;         // bits of a slot behind the point

/// From 64 frames on: 0 up to 127, then one more an octave.
int octave(int lag) { return static_cast<int>(std::bit_width(static_cast<unsigned>(lag))) - 7; }

/// Frames between the begins of an octave's windows: lag/16 to lag/8.
double strideOf(int octave) { return std::ldexp(5 * std::numbers::phi, octave); }

/// Below 64 frames: log2 of the distance between the end frames used for a lag, from lag/16 to
/// lag/8.
std::size_t stepOf(int lag) { return lag < 16 ? 0 : lag < 32 ? 1 : 2; }

inline void addTo(LagSums& sum, double dx, double dy, double turn, bool angular) {
  const double r2 = dx * dx + dy * dy;
  ++sum.windows;
  if (!angular) {
    sum.r2 += r2;
    sum.r4 += r2 * r2;
    return;
  }
  const double a2 = turn * turn;
  ++sum.angular_windows;
  sum.r2 += r2;
  sum.a2 += a2;
  sum.r4 += r2 * r2;
  sum.a4 += a2 * a2;
}

std::int64_t wholeSlot(std::uint64_t slot) { return static_cast<std::int64_t>(slot >> kFraction); }

}  // namespace

MsdAccumulator::MsdAccumulator(std::vector<int> lags, double frame_period)
    : lags_(std::move(lags)),
      frame_period_(frame_period),
      lag_times_(lags_.size()),
      blocks_(lags_, std::max(kFirstBlock, 2 * frame_period)),
      period_time_(1),
      period_frames_(1 / frame_period),
      period_(frame_period) {
  const auto dense_end = std::lower_bound(lags_.begin(), lags_.end(), kDenseLags);
  dense_lags_ = static_cast<std::size_t>(dense_end - lags_.begin());
  const auto near_end = std::upper_bound(lags_.begin(), dense_end, static_cast<int>(NearSums::kLags));
  near_lags_ = static_cast<std::size_t>(near_end - lags_.begin());
  for (std::size_t i = 0; i < dense_lags_; ++i) {
    for (std::size_t step = stepOf(lags_[i]); step < kSteps; ++step) {
      active_[step] = i + 1;
    }
  }
  for (std::size_t i = dense_lags_; i < lags_.size(); ++i) {
    if (i == dense_lags_ || octave(lags_[i]) != octave(lags_[i - 1])) {
      levels_.emplace_back().stride =
          static_cast<std::uint64_t>(std::ldexp(strideOf(octave(lags_[i])), kFraction));
    }
    cursors_.push_back({lags_[i], static_cast<std::uint16_t>(levels_.size() - 1), 0});
  }
  levels_.shrink_to_fit();
  cursors_.shrink_to_fit();
  following_.resize(cursors_.size() + levels_.size());
}

BlockData MsdAccumulator::data() const {
  std::vector<double> times = lag_times_;
  for (std::size_t i = 0; i < near_lags_; ++i) times[i] += blocks_.nearDuration(lags_[i]);
  BlockData data{lags_, frame_period_, std::move(times), {}};
  data.tracks.push_back(blocks_.blocks());
  return data;
}

std::size_t MsdAccumulator::memoryBytes() const {
  return sizeof(*this) + lags_.capacity() * sizeof(int) + lag_times_.capacity() * sizeof(double) +
         blocks_.memoryBytes() - sizeof(blocks_) + levels_.capacity() * sizeof(Level) +
         cursors_.capacity() * sizeof(Cursor) + following_.capacity() * sizeof(std::uint16_t);
}

void MsdAccumulator::Recent::push(const Fix& fix) {
  newest = (newest + kLength - 1) % kLength;
  for (const std::size_t at : {newest, newest + kLength}) {
    time[at] = fix.time;
    x[at] = fix.x;
    y[at] = fix.y;
    theta[at] = fix.theta;
  }
  ++unbroken;
}

const MsdAccumulator::Fix* MsdAccumulator::find(std::int64_t slot) const {
  const Fix& fix = dense_[static_cast<std::size_t>(slot) % kDenseFixes];
  return slot >= segment_first_ && fix.slot == slot ? &fix : nullptr;
}

void MsdAccumulator::beginSegment() {
  slot_ += static_cast<std::int64_t>(kDenseFixes);  // makes every dense slot stale
  segment_first_ = slot_;
  piece_first_ = slot_;
  angular_first_ = slot_;
  in_segment_ = 0;
  in_piece_ = 0;
  in_angular_ = 0;
  recent_.unbroken = 0;
  blocks_.open().segments += 1;
  for (Cursor& cursor : cursors_) {
    cursor.start = levels_[cursor.level].head;  // no window begins before the segment
  }
}

void MsdAccumulator::add(const Sample& sample) {
  Fix fix{0, sample.free_time, sample.x, sample.y, sample.theta};
  std::int64_t first_due = slot_ + 1;
  if (empty_ || sample.segment != last_.segment) {
    beginSegment();
    scheduleAll();
    first_due = slot_;
  } else {
    const double dt = sample.free_time - last_.free_time;
    const double frames = std::round(dt / period_);
    if (frames < 1) {
      return;  // just after a join: nearer to the last slot than to the next one
    }
    slot_ += static_cast<std::int64_t>(frames);
    blocks_.addTime(dt > std::max(kLongestStep, 1.5 * period_) ? period_ : dt);
    const bool join = sample.piece != last_.piece;
    if (join) {
      piece_first_ = slot_;
      in_piece_ = 0;
    }
    if (join || frames > 1) recent_.unbroken = 0;
    if (join || frames >= static_cast<double>(kWheel)) {
      scheduleAll();  // what was expected at a slot has to be looked at again
      first_due = slot_;
    }
    addStep(previous_, fix, frames, join);
    if (sample.angular_segment != last_.angular_segment) {
      angular_first_ = slot_;
      in_angular_ = 0;
      recent_.unbroken = 0;
    }
    BlockSums& block = blocks_.open();
    block.run_time += sample.run_time - last_.run_time;
    block.run_span += dt;
    block.tumbles += static_cast<double>(sample.tumble_count - last_.tumble_count);
  }
  empty_ = false;
  last_ = sample;
  fix.slot = slot_;
  dense_[static_cast<std::size_t>(slot_) % kDenseFixes] = fix;
  recent_.push(fix);
  addDenseWindows(fix);
  turnWheel(first_due, fix);
  previous_ = fix;
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
  BlockSums& block = blocks_.open();
  block.forward += c * dx + s * dy;
  block.forward_time += dt;
  block.joins += join ? 1 : 0;
  if (frames == 1 && !join) {
    const double sideways = c * dy - s * dx;
    block.sideways2 += sideways * sideways;
    block.steps += 1;
  }
}

inline void MsdAccumulator::addWindow(std::size_t i, const Fix& start, const Fix& end,
                                      double duration, bool angular) {
  lag_times_[i] += duration;
  addTo(blocks_.open().lags[i], end.x - start.x, end.y - start.y, end.theta - start.theta, angular);
}

bool MsdAccumulator::addNearWindows(const Fix& end) {
  if (recent_.unbroken <= NearSums::kLags) return false;
  NearSums& sums = blocks_.near();
  const std::size_t first = recent_.newest + 1;
  const double* time = recent_.time.data() + first;
  const double* x = recent_.x.data() + first;
  const double* y = recent_.y.data() + first;
  const double* theta = recent_.theta.data() + first;
  const Fix fix = end;
  for (std::size_t i = 0; i < NearSums::kLags; ++i) {
    const double dx = fix.x - x[i];
    const double dy = fix.y - y[i];
    const double turn = fix.theta - theta[i];
    const double r2 = dx * dx + dy * dy;
    const double a2 = turn * turn;
    sums.duration[i] += fix.time - time[i];
    sums.r2[i] += r2;
    sums.a2[i] += a2;
    sums.r4[i] += r2 * r2;
    sums.a4[i] += a2 * a2;
  }
  ++sums.windows;
  return true;
}

void MsdAccumulator::addDenseWindows(const Fix& end) {
  const auto extend = [&](std::size_t& count, std::int64_t first) {
    while (count < dense_lags_ && lags_[count] <= slot_ - first) {
      ++count;
    }
  };
  extend(in_segment_, segment_first_);
  extend(in_piece_, piece_first_);
  extend(in_angular_, angular_first_);
  constexpr std::uint64_t kGoldenRatio = 0x9E3779B97F4A7C15ULL;
  const auto step = std::min(
      static_cast<std::size_t>(std::countl_zero(static_cast<std::uint64_t>(slot_) * kGoldenRatio)),
      kSteps - 1);
  const std::size_t active = std::min(active_[step], in_segment_);
  const std::size_t direct = std::min(active, in_piece_);
  const Fix fix = end;
  const auto here = static_cast<int>(fix.slot % static_cast<std::int64_t>(kDenseFixes));
  const int* lags = lags_.data();
  LagSums* sums = blocks_.open().lags.data();
  double* times = lag_times_.data();
  for (std::size_t i = addNearWindows(end) ? near_lags_ : 0; i < direct; ++i) {
    const int at = here - lags[i];
    const int wrapped = at < 0 ? at + static_cast<int>(kDenseFixes) : at;
    const Fix& start = dense_[static_cast<std::size_t>(wrapped)];
    if (start.slot == fix.slot - lags[i]) {
      times[i] += fix.time - start.time;
      addTo(sums[i], fix.x - start.x, fix.y - start.y, fix.theta - start.theta, i < in_angular_);
    }
  }
  for (std::size_t i = direct; i < active; ++i) {
    addJoinWindow(i, end);
  }
}

void MsdAccumulator::addJoinWindow(std::size_t i, const Fix& end) {
  const double lag = lags_[i] * period_;
  const std::optional<Fix> start = interpolated(end.time - lag, slot_ - lags_[i]);
  if (start) {
    addWindow(i, *start, end, lag, start->slot >= angular_first_);
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

/// Puts a task where the wheel will be at slot `due`.
inline void MsdAccumulator::schedule(std::size_t task, std::int64_t due) {
  const std::int64_t slot = std::min(due, slot_ + static_cast<std::int64_t>(kWheel) - 1);
  std::uint16_t& first = wheel_[static_cast<std::size_t>(slot) % kWheel];
  following_[task] = first;
  first = static_cast<std::uint16_t>(task + 1);
}

/// All tasks at this slot.
void MsdAccumulator::scheduleAll() {
  wheel_.fill(0);
  for (std::size_t task = 0; task < following_.size(); ++task) {
    schedule(task, slot_);
  }
}

/// Everything that was to be done from slot `from` until now.
void MsdAccumulator::turnWheel(std::int64_t from, const Fix& end) {
  for (std::int64_t slot = from; slot <= slot_; ++slot) {
    std::size_t next = std::exchange(wheel_[static_cast<std::size_t>(slot) % kWheel], 0);
    while (next != 0) {
      const std::size_t task = next - 1;
      next = following_[task];
      schedule(task, task < cursors_.size() ? endWindows(task, end)
                                            : keep(levels_[task - cursors_.size()], end));
    }
  }
}

/// Keeps the frame if windows of the level begin with it.
/// @return the next slot to be kept
inline std::int64_t MsdAccumulator::keep(Level& level, const Fix& fix) const {
  if (wholeSlot(level.next) < slot_) {  // the frame was lost, or slots were jumped over
    const auto now = static_cast<std::uint64_t>(slot_) << kFraction;
    level.next += (now - level.next + level.stride - 1) / level.stride * level.stride;
  }
  if (wholeSlot(level.next) == slot_) {
    level.fixes[level.head] = fix;
    level.head = static_cast<std::uint16_t>((level.head + 1U) % kFixes);
    level.next += level.stride;
  }
  return wholeSlot(level.next);
}

/// Ends the windows of a cursor that end at this frame or before it.
/// @return a slot after this one before which its next window does not end
inline std::int64_t MsdAccumulator::endWindows(std::size_t c, const Fix& end) {
  Cursor& cursor = cursors_[c];
  const Level& level = levels_[cursor.level];
  for (; cursor.start != level.head;
       cursor.start = static_cast<std::uint16_t>((cursor.start + 1U) % kFixes)) {
    const Fix& start = level.fixes[cursor.start];
    const std::int64_t due = start.slot + cursor.lag;
    if (start.slot >= piece_first_) {
      if (due > slot_) {
        return due;
      }
      if (due == slot_) {  // otherwise its end frame was lost
        addWindow(dense_lags_ + c, start, end, end.time - start.time,
                  start.slot >= angular_first_);
      }
      continue;
    }
    const double ahead = (start.time - end.time) / period_ + cursor.lag;
    if (ahead > kSameTime) {
      return slot_ + std::max<std::int64_t>(1, static_cast<std::int64_t>(ahead));
    }
    addEndedAcrossJoin(dense_lags_ + c, start, end);
  }
  return std::max(wholeSlot(level.next), slot_) + cursor.lag;  // it has not even begun
}

/// The window ended between the frame before and this one.
void MsdAccumulator::addEndedAcrossJoin(std::size_t i, const Fix& start, const Fix& end) {
  const double lag = lags_[i] * period_;
  const double step = end.time - previous_.time;
  const double w = (start.time + lag - previous_.time) / step;
  if (!(w > -kSameTime) || step > kBracket * period_ || previous_.slot < segment_first_) {
    return;  // frames were lost there
  }
  const Fix between{slot_, start.time + lag, previous_.x + w * (end.x - previous_.x),
                    previous_.y + w * (end.y - previous_.y),
                    previous_.theta + w * (end.theta - previous_.theta)};
  addWindow(i, start, between, lag, start.slot >= angular_first_);
}

}  // namespace lab::analysis
