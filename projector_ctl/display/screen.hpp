/// Shows the light field on a display: opens the display, paints, presents, and reports the result
/// of each picture. Any of this may take long; therefore it runs in a thread (presenter.hpp).
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
  std::int64_t present_utime = 0;      ///< earliest time, if the display itself does not wait
  std::vector<std::string> overlay{};  ///< lines of text
};

/// What determines when pictures change.
enum class Pace : std::int8_t {
  kDisplay,  ///< the display's vertical blank
  kUnpaced,  ///< nothing: the display shows pictures at any time
};

/// The state of a display.
struct ScreenState {
  bool open = false;
  std::string name{};  ///< of the display
  Pace pace = Pace::kUnpaced;
  double period = 0;      ///< [s] between swaps, measured (Pace::kDisplay)
  std::string trouble{};  ///< why another field than the job's is shown; empty: none
  bool overlay = false;
  std::string calibration_id{};  ///< empty: the arena fills the picture
};

/// Result of a job.
struct ScreenResult {
  ScreenState state{};
  std::int64_t swap_utime = 0;  ///< 0: it was not shown
  double work = 0;              ///< [s] time for painting and transfer, without waiting
};

class Screen {
 public:
  /// How the picture is projected onto the arena.
  struct Placement {
    optics::ProjectorModel model;
    std::string calibration_id{};
    std::shared_ptr<const Tone> tone{};  ///< null: the identity
  };

  struct Setup {
    OpenDisplay open;
    /// For a display of columns x rows. If it throws, the safe field is shown and the text becomes
    /// the trouble.
    std::function<Placement(int columns, int rows)> place;
    light::Field safe_field{};
    std::function<std::int64_t()> now;                ///< [us]
    std::function<void(std::int64_t)> sleep_until{};  ///< [us] null: pictures are not delayed
    bool overlay = false;
  };

  static constexpr std::int64_t kReopen = 1'000'000;  ///< [us] between attempts
  static constexpr std::int64_t kTwice = 1'000'000;   ///< [us] longest time between two Escapes
  /// [1] If presenting takes less than this share of a refresh, the display does not wait.
  static constexpr double kLeastWait = 0.7;

  explicit Screen(Setup setup) : setup_(std::move(setup)) {}
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  /// Shows the safe field.
  ~Screen();

  /// Opens the display and shows the safe field. If it throws, the display stays closed and its
  /// trouble unchanged.
  /// @throws DisplayError, and the exceptions of `place`.
  void open();

  /// Handles events, opens a display again that has come back, paints and presents.
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
  bool reopens_ = true;            ///< whether a closed display is to be opened again
  std::int64_t closed_utime_ = 0;  ///< when it was closed, or of the last attempt to open it
  std::int64_t escape_utime_ = 0;
  bool escaped_ = false;
};

}  // namespace lab::projector
