/// A display with the light field on it: opens it, paints, presents, and says what became of each
/// picture. All of it may take long, so that the bus loop has it done by a thread (presenter.hpp).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "light/field/field.hpp"
#include "light/optics/projector_model.hpp"
#include "projector_ctl/display/display.hpp"
#include "projector_ctl/painter/screen_painter.hpp"

namespace lab::projector {

/// A picture to show.
struct ScreenJob {
  light::Field field{};
  std::int64_t present_utime = 0;      ///< not before, where the display itself does not wait
  std::vector<std::string> overlay{};  ///< lines of text
};

/// Who decides when pictures change.
enum class Pace : std::int8_t {
  kDisplay,  ///< its vertical blank
  kUnpaced,  ///< the display takes them at any time
};

/// What a display is doing.
struct ScreenState {
  bool open = false;
  std::string name{};  ///< of the display
  Pace pace = Pace::kUnpaced;
  double period = 0;      ///< [s] between swaps, measured (Pace::kDisplay)
  std::string trouble{};  ///< why something else than the job's field is shown, empty: it is
  bool overlay = false;
  std::string calibration_id{};  ///< empty: the arena fills the picture
};

/// What became of a job.
struct ScreenResult {
  ScreenState state{};
  std::int64_t swap_utime = 0;  ///< 0: it was not shown
  double work = 0;              ///< [s] that painting and handing over took, without waiting
};

class Screen {
 public:
  /// How the picture lies on the arena.
  struct Placement {
    optics::ProjectorModel model;
    std::string calibration_id{};
    std::shared_ptr<const Tone> tone{};  ///< null: the identity
  };

  struct Setup {
    OpenDisplay open;
    /// For a display of columns x rows. What it throws is a trouble: the safe field is shown.
    std::function<Placement(int columns, int rows)> place;
    light::Field safe_field{};
    std::function<std::int64_t()> now;                ///< [us]
    std::function<void(std::int64_t)> sleep_until{};  ///< [us] null: pictures are not held back
    bool overlay = false;
  };

  static constexpr std::int64_t kReopen = 1'000'000;  ///< [us] between attempts
  static constexpr std::int64_t kTwice = 1'000'000;   ///< [us] within which Escape counts as two
  static constexpr double kLeastWait = 0.7;  ///< [1] of a refresh, below: the display does not wait

  explicit Screen(Setup setup) : setup_(std::move(setup)) {}
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  /// Shows the safe field a last time.
  ~Screen();

  /// The safe field on the display. What it throws leaves it closed, its trouble as it was.
  /// @throws DisplayError, and what `place` throws.
  void open();

  /// Takes events in, opens again what has come back, paints and presents.
  ScreenResult run(const ScreenJob& job);

  [[nodiscard]] const ScreenState& state() const { return state_; }

 private:
  void openPlaced(const std::function<Placement(int columns, int rows)>& place);
  void tryOpen();
  void drop();
  void close(const std::string& why, bool reopen);
  void takeEvents();
  void measurePace();
  void present(const light::Field& field);
  void drawOverlay(const std::vector<std::string>& lines);

  Setup setup_;
  std::unique_ptr<Display> display_;
  std::unique_ptr<ScreenPainter> painter_;
  ScreenState state_;
  std::vector<Box> changed_;
  Box overlaid_{};
  bool misplaced_ = false;         ///< the calibration does not fit the display
  bool reopens_ = true;            ///< when it is closed
  std::int64_t closed_utime_ = 0;  ///< or of the last attempt
  std::int64_t escape_utime_ = 0;
  bool escaped_ = false;
};

}  // namespace lab::projector
