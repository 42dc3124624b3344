/// The loop over frames, timed by a clock or by the swaps of a display.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/loop/loop.hpp"
#include "projector_ctl/display/frame_clock.hpp"
#include "projector_ctl/display/presenter.hpp"

namespace lab::projector {

/// For each frame, calls back to compute the light field, shows it, and reports it. Without a
/// display, a frame is shown at the next tick of FrameClock (its boundary). With a display, the
/// light field is computed as late as possible before the swap. The swap is the next display
/// refresh. If the display does not wait for its refresh, the swap is the next boundary. If the
/// display is closed or does not answer, frames continue by the
/// clock, and the state reports the fault.
class FrameLoop {
 public:
  static constexpr std::int64_t kPoll = 500;  ///< [us] polling interval for a late swap
  /// [us] Longest wait for a swap; then the loop continues without it.
  static constexpr std::int64_t kSwapTimeout = 1'000'000;
  static constexpr double kMargin = 1.5e-3;  ///< [s] time between the end of painting and the swap
  /// [1] Factor per frame by which the estimate of the painting time decays.
  static constexpr double kWorkDecay = 0.98;

  /// The report of a frame.
  struct SwappedFrame {
    std::int64_t utime = 0;  ///< [us] of the swap
    double period = 0;       ///< [s] until the next swap
    std::string display{};   ///< as in LIGHT_STATUS
    std::string vsync{};
    std::string trouble{};  ///< fault of the display; empty: none
    std::string calibration_id{};
  };

  struct Callbacks {
    /// Returns the field for a swap expected at `swap_utime`, which increases from call to call.
    /// The field must be valid until the next call.
    std::function<const light::Field&(std::int64_t swap_utime)> decide;
    /// Called after that field was shown.
    std::function<void(const SwappedFrame&)> shown;
    /// Returns the text of the overlay; only called while it is on.
    std::function<std::vector<std::string>()> overlay{};
  };

  /// Begins with the next boundary.
  /// @param presenter null: no display
  FrameLoop(Loop& loop, FrameClock clock, Callbacks callbacks,
            std::unique_ptr<Presenter> presenter);

  /// Measured frame rate, a mean over about the last second [Hz].
  [[nodiscard]] double rate() const { return interval_ > 0 ? 1 / interval_ : 0; }

 private:
  void schedule();
  void begin(std::int64_t swap_utime);
  void poll();
  void finish(std::int64_t swap_utime);
  void finishJob(const ScreenResult& result);
  [[nodiscard]] std::int64_t nextSwap() const;
  /// Whether the display determines the times of frames.
  [[nodiscard]] bool paced() const {
    return state_.open && answers_ && state_.pace == Pace::kDisplay;
  }

  Loop& loop_;
  FrameClock clock_;
  Callbacks callbacks_;
  std::unique_ptr<Presenter> presenter_;
  ScreenState state_;
  bool answers_ = true;         ///< the display answers in time
  bool waiting_ = false;        ///< a job is in progress
  std::int64_t target_ = 0;     ///< [us] expected swap of the frame in progress
  std::int64_t frame_ = 0;      ///< number of the last boundary used
  std::int64_t last_swap_ = 0;  ///< [us]
  double work_ = 0;             ///< [s] longest painting time, with slow decay
  double interval_ = 0;         ///< [s] between swaps, mean
};

}  // namespace lab::projector
