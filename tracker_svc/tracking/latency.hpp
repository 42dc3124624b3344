/// Percentiles of the latest durations of a repeated task.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace lab::tracker {

class Latency {
 public:
  /// @param duration [s]
  void add(double duration) {
    if (durations_.size() < kMost) {
      durations_.push_back(duration);
    } else {
      durations_[next_] = duration;
    }
    next_ = (next_ + 1) % kMost;
  }

  /// The duration [s] that a share `part` of the last kMost durations did not exceed; 0 without
  /// any.
  [[nodiscard]] double percentile(double part) const {
    if (durations_.empty()) return 0;
    std::vector<double> sorted = durations_;
    const auto last = static_cast<double>(sorted.size() - 1);
    const auto place = sorted.begin() + static_cast<std::ptrdiff_t>(part * last + 0.5);
    std::nth_element(sorted.begin(), place, sorted.end());
    return *place;
  }

 private:
  static constexpr std::size_t kMost = 1000;
  std::vector<double> durations_;
  std::size_t next_ = 0;
};

}  // namespace lab::tracker
