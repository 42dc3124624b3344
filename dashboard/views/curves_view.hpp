/// What the analyzer says, as the page draws it.
#pragma once

#include <cstdint>
#include <lab/analysis_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dashboard/views/json.hpp"

namespace lab::dashboard {

/// A curve that the dashboard measures itself: C(l).
struct LengthCurve {
  std::vector<double> length;  ///< [m]
  std::vector<double> value;   ///< [1]
  std::vector<double> sigma;   ///< [1]
  std::vector<double> exact;   ///< [1] nan: no law
  std::vector<double> windows;
};

/// Of topic `pool/...`, and the same of one robot. Lengths in cm.
[[nodiscard]] Json analysisJson(const analysis_t& analysis);

/// As an element of "curves".
[[nodiscard]] Json curveJson(const LengthCurve& curve);

/// The newest ANALYSIS of each pool, and of each robot and program.
class CurvesView {
 public:
  static constexpr std::size_t kMostPools = 64;
  static constexpr std::size_t kMostOfRobots = 2000;  ///< some 8 KB each

  void take(const analysis_t& analysis);
  void clear();

  /// Programs whose pool is newer than when this was asked last.
  [[nodiscard]] std::vector<std::string> takeChanged();

  /// The pool of a program; null: none was heard of.
  [[nodiscard]] const analysis_t* pool(const std::string& program) const;

  /// Of `analysis`: all programs of one robot.
  [[nodiscard]] std::string robotJson(std::int32_t robot) const;

  [[nodiscard]] std::size_t size() const { return pools_.size() + robots_.size(); }
  [[nodiscard]] std::int64_t leftOut() const { return left_out_; }

 private:
  struct Pool {
    analysis_t analysis;
    bool changed = false;
  };

  std::map<std::string, Pool> pools_;
  std::map<std::pair<std::int32_t, std::string>, analysis_t> robots_;
  std::int64_t left_out_ = 0;
};

}  // namespace lab::dashboard
