/// The progress line of a run on the terminal.
#pragma once

#include <cstdint>
#include <string>

#include "runner/live/progress.hpp"

namespace lab::runner {

/// Rewrites its line on a terminal. Elsewhere (a log file, CI) prints about ten lines per run.
class ProgressLine {
 public:
  /// @param duration of the run [s]
  explicit ProgressLine(double duration);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const Progress& progress);

 private:
  void print(const Progress& progress);

  double duration_;
  bool terminal_;
  bool shown_ = false;
  double next_print_ = 0;  ///< [s] of the script, when not on a terminal
  std::int64_t last_shown_us_ = 0;
};

/// "12 s left | light blue | 3 robots seen | 2 slow, 1 fast | 0 lost"
[[nodiscard]] std::string progressText(const Progress& progress);

}  // namespace lab::runner
