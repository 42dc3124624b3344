/// Run times of run-and-tumble robots, as they count them themselves.
#pragma once

#include <array>
#include <cstdint>
#include <lab/robot_status_t.hpp>
#include <map>
#include <string>
#include <vector>

#include "dashboard/views/run_info.hpp"

namespace lab::dashboard {

/// A robot counts a tumble as it begins, and its run time stands still while it tumbles: the least
/// run time heard under one count is that of all runs before this tumble, exactly where a message
/// was sampled within the tumble. Only runs between two counted tumbles that follow each other
/// count.
class RunTimes {
 public:
  static constexpr std::size_t kBins = 24;
  static constexpr double kBinsPerMeanRun = 4;

  explicit RunTimes(const RunInfo& run_info) : run_info_(run_info) {}

  void take(const robot_status_t& status);
  void clear();

  /// Programs with runs that are newer than when this was asked last.
  [[nodiscard]] std::vector<std::string> takeChanged();

  /// Of topic `runtimes/...`; runs beyond the last edge are in "runs" and "mean_s" alone.
  [[nodiscard]] std::string json(const std::string& program) const;

 private:
  struct Robot {
    std::int32_t epoch = 0;
    std::int32_t tumbles = 0;
    double run_time = 0;  ///< [s] the least under this count
    double before = -1;   ///< [s] the same under the count before; -1: not known
    bool whole = false;   ///< the count began in sight
  };
  struct Histogram {
    double gamma = 0;
    std::array<std::int64_t, kBins> counts{};
    std::int64_t runs = 0;
    double sum = 0;  ///< [s]
    bool changed = false;
  };

  void take(const robot_state_t& state);
  void add(const program_t& program, double run);

  const RunInfo& run_info_;
  std::map<std::int32_t, Robot> robots_;
  std::map<std::string, Histogram> programs_;
};

}  // namespace lab::dashboard
