#include "analyzer/curves/whole_motion.hpp"

#include <cmath>

#include "common/math/angle.hpp"

namespace lab::analysis {
namespace {

constexpr double kLongestStep = 0.3;  // s; across a longer gap the heading is ambiguous

}  // namespace

TimeShares sharesOf(const ProgramTally& tally) {
  const auto frames = static_cast<double>(tally.samples + tally.in_reversal + tally.in_contact +
                                          tally.stopped + tally.lost);
  TimeShares shares;
  if (!(frames > 0)) return shares;
  shares.free = static_cast<double>(tally.samples) / frames;
  shares.reversing = static_cast<double>(tally.in_reversal) / frames;
  shares.contact = static_cast<double>(tally.in_contact) / frames;
  shares.stopped = static_cast<double>(tally.stopped) / frames;
  shares.lost = static_cast<double>(tally.lost) / frames;
  return shares;
}

void WholeSums::pool(const WholeSums& other) {
  blocks.pool(other.blocks);
  forward += other.forward;
  time += other.time;
}

WholeMotion WholeSums::motion() const {
  WholeMotion whole;
  whole.observed = blocks.observed();
  if (time > 0) whole.speed = forward / time;
  const BlockSums total = blocks.total();
  for (std::size_t i = 0; i < total.lags.size(); ++i) {
    const LagSums& lag = total.lags[i];
    if (lag.windows == 0) continue;
    whole.lags.push_back({blocks.lagTime(i, total), lag.r2 / lag.windows,
                          lag.angular_windows > 0 ? lag.a2 / lag.angular_windows : units::kNan,
                          static_cast<double>(lag.windows)});
  }
  return whole;
}

void WholeAccumulator::add(const FrameReport& frame) {
  if (frame.state == FrameState::kLost) return;
  Sample sample = last_;
  sample.time = sample.free_time = frame.time;
  sample.x = frame.x;
  sample.y = frame.y;
  const bool begins = last_state_ == FrameState::kLost || frame.epoch != epoch_;
  const double gap = frame.time - last_.time;
  if (begins) {
    ++sample.segment;
    ++sample.angular_segment;
    ++sample.piece;
    sample.theta = frame.theta;
  } else {
    if (!(gap <= kLongestStep)) ++sample.angular_segment;
    sample.theta = last_.theta + wrapAngle(frame.theta - last_.theta);
    addStep(sample, frame.state);
  }
  epoch_ = frame.epoch;
  last_ = sample;
  last_state_ = frame.state;
  accumulator_.add(sample);
}

void WholeAccumulator::addStep(const Sample& to, FrameState state) {
  const double dt = to.time - last_.time;
  const double heading = 0.5 * (last_.theta + to.theta);
  if (!std::isfinite(heading) || !(dt <= kLongestStep)) return;
  const double forward =
      (to.x - last_.x) * std::cos(heading) + (to.y - last_.y) * std::sin(heading);
  const bool reversing = state == FrameState::kReversing || last_state_ == FrameState::kReversing;
  forward_ += reversing ? std::abs(forward) : forward;
  time_ += dt;
}

}  // namespace lab::analysis
