/// The latest value of one collective number of the analyzer.
#pragma once

#include <cstdint>
#include <deque>
#include <lab/collective_t.hpp>
#include <string>
#include <utility>

#include "common/experiment/experiment.hpp"
#include "common/math/units.hpp"

namespace lab::runner {

/// Of all robots, or of those of a program. Values are in the unit of the report (cm/s).
class CrowdValue {
 public:
  /// @param program name in the experiment; empty: all robots
  CrowdValue(const Experiment& experiment, std::string name, const std::string& program);

  /// @return whether the message has the number
  bool take(const collective_t& message);

  [[nodiscard]] double now() const { return now_; }      ///< nan: none
  [[nodiscard]] double error() const { return error_; }  ///< standard error of its average / value
  [[nodiscard]] std::int64_t utime() const { return utime_; }  ///< of the latest value; 0: none
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_;
  std::int64_t hash_ = 0;  ///< of the program; 0: all robots
  double now_ = units::kNan;
  double error_ = units::kNan;
  std::int64_t utime_ = 0;
};

/// A condition on a collective number: its mean over a time is above or below a limit, or its
/// average over the run is known to a relative error.
class CrowdCondition {
 public:
  /// @param until names the number
  CrowdCondition(const Experiment& experiment, const EndCondition& until);

  /// @return whether the message has the number
  bool take(const collective_t& message);

  [[nodiscard]] bool holds() const;

  /// "polar_order 0.42 over 10 s, wanted above 0.8".
  [[nodiscard]] std::string progress() const;

 private:
  [[nodiscard]] double mean() const;

  EndCondition until_;
  CrowdValue value_;
  std::deque<std::pair<std::int64_t, double>> values_;  ///< of the last `over` s, by utime
  bool whole_ = false;                                  ///< they cover that time
};

}  // namespace lab::runner
