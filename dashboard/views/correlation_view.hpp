/// C(l) = <n(0) . n(l)>: the correlation of the heading n along the path, for programs
/// of constant speed whose heading diffuses.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/analysis_feed.hpp"
#include "analyzer/laws.hpp"
#include "dashboard/views/curves_view.hpp"
#include "dashboard/views/run_info.hpp"

namespace lab::dashboard {

/// The correlation for one program: averages over pairs of headings whose distance in free time is
/// a multiple of a step. Standard errors come from the jackknife over blocks of time and robots.
/// Blocks of time are merged when there are too many, so that memory is bounded.
class HeadingCorrelation {
 public:
  static constexpr std::size_t kLags = 24;
  static constexpr double kReach = 4;        ///< longest lag in persistence times
  static constexpr std::size_t kGroups = 8;  ///< groups of robots
  static constexpr std::size_t kMaxTimes = 16;

  /// @param law with a constant speed and a rotational diffusivity above 0
  explicit HeadingCorrelation(const analysis::ProgramLaw& law);

  /// Adds a heading of a robot's track.
  void add(int robot, const analysis::Sample& sample);

  /// The speed is constant, so l is speed times time. A path length summed over frames
  /// would mostly be noise of the tracker.
  /// @param speed [m/s] measured
  [[nodiscard]] LengthCurve curve(double speed) const;

 private:
  struct Heading {
    double time = 0;   ///< [s] free time
    double theta = 0;  ///< [rad]
    int segment = 0;
  };
  struct Sums {
    std::array<double, kLags> cosines{};
    std::array<double, kLags> times{};
    std::array<double, kLags> pairs{};
    void add(const Sums& other);
  };
  using Row = std::array<Sums, kGroups>;

  Row& rowAt(double time);

  analysis::ExactLaw law_;
  double step_;        ///< [s] between lags
  double block_ = 0;   ///< [s] duration of a row
  double begin_ = -1;  ///< [s] begin of the first row, -1: none yet
  std::vector<Row> rows_;
  std::map<int, std::deque<Heading>> headings_;
};

/// The correlation for each program of the experiment that has one. Uses the analyzer's code for
/// tracks.
class CorrelationView {
 public:
  explicit CorrelationView(const RunInfo& run_info) : run_info_(run_info) {}

  void take(const robot_status_t& status);
  void take(const tracked_frame_t& frame);
  void clear();

  /// @param speed [m/s] measured; if it is not above 0, the programmed speed is used
  /// @return nothing if the speed or the noise of the program is not constant, or with too few data
  [[nodiscard]] std::optional<LengthCurve> curve(const std::string& program, double speed) const;

 private:
  analysis::AnalysisFeed* feed();

  const RunInfo& run_info_;
  std::unique_ptr<analysis::AnalysisFeed> feed_;
  bool wanted_ = true;  ///< false if the experiment has no such program
  std::map<std::string, HeadingCorrelation> programs_;
};

}  // namespace lab::dashboard
