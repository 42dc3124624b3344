/// A progress bar on the terminal.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace lab::runner {

/// "[#####.....] 123 of 400 frames, 96 a second, 3 s left". Without bar and remaining time if the
/// length is not known (0).
[[nodiscard]] std::string progressBarText(std::int64_t done, std::int64_t length, double seconds,
                                          const char* unit = "frames");

/// Rewrites its line on a terminal; elsewhere prints nothing.
class ProgressBar {
 public:
  /// @param unit what is counted; a string literal
  explicit ProgressBar(std::int64_t length, const char* unit = "frames");
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(std::int64_t done);

  /// Time since construction [s].
  [[nodiscard]] double seconds() const;

 private:
  std::int64_t length_;
  const char* unit_;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double next_ = 0;  ///< [s]
};

}  // namespace lab::runner
