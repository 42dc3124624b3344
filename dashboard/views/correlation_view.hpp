/// C(l) = <n(0) . n(l)>: how the heading is forgotten along the path, of active Brownian programs.
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

/// Of one program: sums over pairs of headings, some multiple of a step apart in free time. Errors
/// by the jackknife over blocks of time and robots; where these are many, blocks of time are
/// merged.
class HeadingCorrelation {
 public:
  static constexpr std::size_t kLags = 24;
  static constexpr double kReach = 4;        ///< persistence times up to which it is measured
  static constexpr std::size_t kGroups = 8;  ///< of robots
  static constexpr std::size_t kMostTimes = 16;

  /// @param law of an ABP with a turning rate above 0
  explicit HeadingCorrelation(const analysis::ProgramLaw& law);

  void add(int robot, const analysis::Sample& sample);

  /// An ABP's speed is constant, so that l is speed times time: a path length summed from frames
  /// would be that of the tracker's noise.
  /// @param speed [m/s] as measured
  [[nodiscard]] LengthCurve curve(double speed) const;

 private:
  struct Heading {
    double time = 0;   ///< [s] free
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
  double block_ = 0;   ///< [s] of a row
  double begin_ = -1;  ///< [s] of the first row, -1: none yet
  std::vector<Row> rows_;
  std::map<int, std::deque<Heading>> headings_;
};

/// Of all ABP programs of the experiment, with the analyzer's own stitched tracks.
class CorrelationView {
 public:
  explicit CorrelationView(const RunInfo& run_info) : run_info_(run_info) {}

  void take(const robot_status_t& status);
  void take(const tracked_frame_t& frame);
  void clear();

  /// @param speed [m/s] as measured; not above 0: the programmed one
  /// @return nothing: no ABP, or too little was seen.
  [[nodiscard]] std::optional<LengthCurve> curve(const std::string& program, double speed) const;

 private:
  analysis::AnalysisFeed* feed();

  const RunInfo& run_info_;
  std::unique_ptr<analysis::AnalysisFeed> feed_;
  bool wanted_ = true;  ///< the experiment has such a program
  std::map<std::string, HeadingCorrelation> programs_;
};

}  // namespace lab::dashboard
