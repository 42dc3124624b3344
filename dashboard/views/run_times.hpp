/// Histograms of the run times of robots that run and tumble.
#pragma once

#include <array>
#include <cstdint>
#include <lab/robot_status_t.hpp>
#include <map>
#include <string>
#include <vector>

#include "dashboard/views/run_info.hpp"

namespace lab::dashboard {

/// A robot reports its number of tumbles and its total run time. It counts a tumble when it begins,
/// and the run time does not grow during a tumble. Therefore the smallest run time reported with
/// one count is the total of all runs before that tumble; it is exact if a message was sent during
/// the tumble. Only runs between two consecutive observed counts are used.
class RunTimes {
 public:
  static constexpr std::size_t kBins = 24;
  static constexpr double kBinsPerMeanRun = 4;

  explicit RunTimes(const RunInfo& run_info) : run_info_(run_info) {}

  void take(const robot_status_t& status);
  void clear();

  /// Programs with new runs since the previous call.
  [[nodiscard]] std::vector<std::string> takeChanged();

  /// JSON of topic `runtimes/...`. Runs beyond the last edge are only part of "runs" and
  /// "mean_s".
  [[nodiscard]] std::string json(const std::string& program) const;

 private:
  struct Robot {
    std::int32_t epoch = 0;
    std::int32_t tumbles = 0;
    double run_time = 0;  ///< [s] smallest value reported with this count
    double before = -1;   ///< [s] the same with the previous count, -1: unknown
    bool whole = false;   ///< the begin of this count was observed
  };
  struct Histogram {
    double gamma = 0;
    std::array<std::int64_t, kBins> counts{};
    std::int64_t runs = 0;
    double sum = 0;  ///< [s]
    bool changed = false;
  };

  void take(const robot_state_t& state);
  /// The rate at which runs end by the program's law [1/s]; 0: it has no such law.
  [[nodiscard]] double runRate(int program) const;
  void add(const program_id_t& program, double run);

  const RunInfo& run_info_;
  std::map<std::int32_t, Robot> robots_;
  std::map<std::string, Histogram> programs_;
};

}  // namespace lab::dashboard
