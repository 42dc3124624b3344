/// Estimates of the pools as functions of time.
#pragma once

#include <cstdint>
#include <lab/analysis_t.hpp>
#include <map>
#include <string>
#include <vector>

namespace lab::dashboard {

/// Adds a point every 5 s. When there are 600 points, every second one is dropped and the time
/// between points doubles.
class HistoryView {
 public:
  static constexpr std::size_t kMaxPoints = 600;
  static constexpr std::size_t kMaxPools = 64;
  static constexpr std::int64_t kStep_us = 5'000'000;

  /// @param start of the run [us since 1970]; if 0 (unknown), time counts from the first point
  /// @return whether a point was added
  bool take(const analysis_t& pool, std::int64_t start);
  void clear() { pools_.clear(); }

  /// JSON of topic `history/...`; empty if there is none for the program.
  [[nodiscard]] std::string json(const std::string& program) const;

  [[nodiscard]] std::size_t points(const std::string& program) const;

 private:
  struct Point {
    double value = 0;
    double low = 0;
    double high = 0;
  };
  struct Line {
    std::string unit;
    double theory = 0;
    std::vector<Point> points;  ///< one per time
  };
  struct Pool {
    std::int64_t begin_utime = 0;
    std::int64_t step_us = kStep_us;
    std::int64_t next_utime = 0;
    std::vector<double> times;  ///< [s]
    std::map<std::string, Line> lines;
  };

  static void thin(Pool& pool);

  std::map<std::string, Pool> pools_;
};

}  // namespace lab::dashboard
