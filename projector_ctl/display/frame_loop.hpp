/// When frames fall: at the boundaries of a clock, or when a display has swapped.
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

/// Frame after frame it has the field decided, shown, and said. Without a display a frame is shown
/// where its boundary lies. With one, the field is decided as late as painting allows before the
/// moment of the swap: the display's next refresh, or a boundary of the clock where the display
/// does not wait. A display that is closed or does not answer changes nothing in the bookkeeping:
/// frames go on by the clock, and the state says what is wrong.
class FrameLoop {
 public:
  static constexpr std::int64_t kPoll = 500;  ///< [us] between looks for a late swap
  static constexpr std::int64_t kSwapTimeout =
      1'000'000;                             ///< [us] for a swap, then it goes on without
  static constexpr double kMargin = 1.5e-3;  ///< [s] of painting's end before the swap
  static constexpr double kWorkDecay =
      0.98;  ///< [1] a frame: how fast a slow painting is forgotten

  /// What is said of a frame.
  struct SwappedFrame {
    std::int64_t utime = 0;  ///< [us] of the swap
    double period = 0;       ///< [s] to the next one
    std::string display{};   ///< as in LIGHT_STATUS
    std::string vsync{};
    std::string trouble{};  ///< of the display, empty: none
    std::string calibration_id{};
  };

  struct Callbacks {
    /// The field for a swap expected at `swap_utime`, which rises; valid until the next call.
    std::function<const light::Field&(std::int64_t swap_utime)> decide;
    /// That field was shown.
    std::function<void(const SwappedFrame&)> shown;
    /// Text for the overlay; called only while it is on.
    std::function<std::vector<std::string>()> overlay{};
  };

  /// Begins with the first boundary from now on.
  /// @param presenter null: there is no display
  FrameLoop(Loop& loop, FrameClock clock, Callbacks owner, std::unique_ptr<Presenter> presenter);

  /// Frames a second over the last second or so, measured.
  [[nodiscard]] double rate() const { return interval_ > 0 ? 1 / interval_ : 0; }

 private:
  void schedule();
  void begin(std::int64_t swap_utime);
  void poll();
  void finish(std::int64_t swap_utime);
  void take(const ScreenResult& result);
  [[nodiscard]] std::int64_t nextSwap() const;
  /// The display decides when frames fall.
  [[nodiscard]] bool paced() const {
    return state_.open && answers_ && state_.pace == Pace::kDisplay;
  }

  Loop& loop_;
  FrameClock clock_;
  Callbacks callbacks_;
  std::unique_ptr<Presenter> presenter_;
  ScreenState state_;
  bool answers_ = true;         ///< the display, in time
  bool waiting_ = false;        ///< a job is under way
  std::int64_t target_ = 0;     ///< [us] swap expected of the frame under way
  std::int64_t frame_ = 0;      ///< number of the last boundary used
  std::int64_t last_swap_ = 0;  ///< [us]
  double work_ = 0;             ///< [s] longest painting, slowly forgotten
  double interval_ = 0;         ///< [s] between swaps, mean
};

}  // namespace lab::projector
