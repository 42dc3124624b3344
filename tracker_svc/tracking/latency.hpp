/// Percentiles of the latest durations of a repeated task.
#pragma once

#include <cstddef>
#include <vector>

#include "common/math/percentiles.hpp"

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

  /// Of the last kMost durations [s]; 0 without any.
  [[nodiscard]] Percentiles percentiles() const {
    return durations_.empty() ? Percentiles{0, 0, 0, 0, 0} : percentilesOf(durations_);
  }

 private:
  static constexpr std::size_t kMost = 1000;
  std::vector<double> durations_;
  std::size_t next_ = 0;
};

}  // namespace lab::tracker
