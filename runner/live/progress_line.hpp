/// One line on the terminal that says how the run stands.
#pragma once

#include "runner/live/experiment_controller.hpp"

namespace lab::runner {

/// Rewrites its line on a terminal; elsewhere (a log file, CI) it prints one now and then.
class ProgressLine {
 public:
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
  double next_print_ = 0;  ///< [s] of the script, where it is not a terminal
  std::int64_t last_shown_us_ = 0;
};

/// "12 s left | light: ABP | 3 of robots seen: 2 abp, 1 bp | 0 messages lost"
[[nodiscard]] std::string progressText(const Progress& progress);

/// Prints a line over the progress line, which comes again below.
void printLine(std::string_view text);

}  // namespace lab::runner
