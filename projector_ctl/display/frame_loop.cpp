#include "projector_ctl/display/frame_loop.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/experiment/experiment.hpp"
#include "common/math/units.hpp"

namespace lab::projector {

FrameLoop::FrameLoop(Loop& loop, FrameClock clock, Callbacks owner,
                     std::unique_ptr<Presenter> presenter)
    : loop_(loop),
      clock_(clock),
      callbacks_(std::move(owner)),
      presenter_(std::move(presenter)),
      frame_(clock_.numberAtOrAfter(loop_.now()) - 1) {
  if (presenter_) state_ = presenter_->opened();
  schedule();
}

/// A loop that is late skips frames, as a display would.
std::int64_t FrameLoop::nextSwap() const {
  const std::int64_t now = loop_.now();
  if (paced() && last_swap_ > 0) {
    const double behind = std::max(0.0, units::seconds(now - last_swap_));
    const double refreshes = std::floor(behind / state_.period) + 1;
    return last_swap_ + std::llround(1e6 * refreshes * state_.period);
  }
  return clock_.boundary(std::max(frame_ + 1, clock_.numberAtOrAfter(now)));
}

void FrameLoop::schedule() {
  const std::int64_t swap = nextSwap();
  // Frames of a display must not be counted as boundaries of the clock: with a fast display the
  // number would run ahead, and if the display were closed, the loop would wait until that
  // boundary.
  frame_ =
      paced() ? clock_.numberAtOrAfter(swap) : std::max(frame_ + 1, clock_.numberAtOrAfter(swap));
  const bool shows = presenter_ && state_.open && answers_;
  const double lead = shows && work_ > 0 ? std::min(1.25 * work_ + kMargin, clock_.period()) : 0;
  loop_.at(swap - std::llround(1e6 * lead), [this, swap] { begin(swap); });
}

void FrameLoop::begin(std::int64_t swap_utime) {
  target_ = swap_utime;
  if (presenter_ && waiting_) {
    if (const auto result = presenter_->poll()) finishJob(*result);
  }
  const light::Field& field = callbacks_.decide(swap_utime);
  if (!presenter_ || waiting_) return finish(swap_utime);
  ScreenJob job{field, swap_utime, {}};
  if (state_.overlay && callbacks_.overlay) job.overlay = callbacks_.overlay();
  presenter_->submit(std::move(job));
  waiting_ = true;
  poll();
}

void FrameLoop::poll() {
  if (const auto result = presenter_->poll()) {
    finishJob(*result);
    return finish(result->swap_utime != 0 ? result->swap_utime : target_);
  }
  const std::int64_t now = loop_.now();
  if (now - target_ > kSwapTimeout) {
    answers_ = false;
    return finish(target_);
  }
  loop_.at(std::max(target_ + kPoll / 4, now + kPoll), [this] { poll(); });
}

void FrameLoop::finishJob(const ScreenResult& result) {
  waiting_ = false;
  answers_ = true;
  state_ = result.state;
  work_ = std::max(result.work, kWorkDecay * work_);
}

void FrameLoop::finish(std::int64_t swap_utime) {
  // Ensures that times of frames increase, whatever the display reports.
  swap_utime = std::max(swap_utime, last_swap_ + 1);
  if (last_swap_ > 0) {
    const double interval = units::seconds(swap_utime - last_swap_);
    interval_ = interval_ > 0 ? interval_ + (interval - interval_) / 60 : interval;
  }
  last_swap_ = swap_utime;
  SwappedFrame swapped{swap_utime, clock_.period(), kHeadless, "clock", state_.trouble, {}};
  if (presenter_) {
    if (paced()) swapped.period = state_.period;
    swapped.display = state_.open ? state_.name : state_.name + " (gone)";
    swapped.vsync = paced() ? "display" : state_.open && answers_ ? "none" : "clock";
    swapped.calibration_id = state_.calibration_id;
    if (!answers_) swapped.trouble = "display " + state_.name + ": does not answer";
  }
  callbacks_.shown(swapped);
  schedule();
}

}  // namespace lab::projector
