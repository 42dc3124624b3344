/// When the online analyzer computes results.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/math/units.hpp"

namespace lab::analysis {

/// Who reads the online results, which decides how often they are computed by default.
enum class ResultReaders : std::int8_t {
  kLive,     ///< a person, or a script that waits for them: once a second
  kLogOnly,  ///< only the log: each tenth of the time so far, 1 to 10 s
};

/// The times of the results. A run in virtual time has as many seconds as one in real time, but
/// results cost as much as all of the rest. It has no clock: times are arguments [us].
class ResultSchedule {
 public:
  /// @param every time between results [s]; 0: by the readers
  explicit ResultSchedule(double every = 0, ResultReaders readers = ResultReaders::kLive)
      : every_us_(std::llround(every * units::kSecond_us)), readers_(readers) {}

  [[nodiscard]] bool isDue(std::int64_t now) const { return now >= next_utime_; }

  /// Results are computed at `now`.
  void computed(std::int64_t now) {
    if (first_utime_ == 0) first_utime_ = now;
    interval_us_ = interval(now - first_utime_);
    next_utime_ = now + interval_us_;
  }

  /// From the last results to the next ones.
  [[nodiscard]] std::int64_t interval() const { return interval_us_; }

 private:
  [[nodiscard]] std::int64_t interval(std::int64_t elapsed) const {
    if (every_us_ > 0) return every_us_;
    if (readers_ == ResultReaders::kLive) return kShortest_us;
    return std::clamp(elapsed / kPart, kShortest_us, kLongest_us);
  }

  static constexpr std::int64_t kPart = 10;
  static constexpr std::int64_t kShortest_us = units::kSecond_us;
  static constexpr std::int64_t kLongest_us = 10 * units::kSecond_us;
  std::int64_t every_us_;
  ResultReaders readers_;
  std::int64_t interval_us_ = kShortest_us;
  std::int64_t first_utime_ = 0;  ///< of the first results; 0: none
  std::int64_t next_utime_ = 0;
};

}  // namespace lab::analysis
