/// Results of the analyzer as JSON for the page.
#pragma once

#include <cstdint>
#include <lab/analysis_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dashboard/web/json.hpp"

namespace lab::dashboard {

/// A curve that the dashboard measures itself: the heading correlation C(l).
struct LengthCurve {
  std::vector<double> length;  ///< [m]
  std::vector<double> value;   ///< [1]
  std::vector<double> sigma;   ///< [1]
  std::vector<double> exact;   ///< [1] nan if there is no exact law
  std::vector<double> windows;
};

/// JSON of topic `pool/...`, or the same for one robot. Lengths are in cm.
[[nodiscard]] Json analysisJson(const analysis_t& analysis);

/// An element of "curves".
[[nodiscard]] Json curveJson(const LengthCurve& curve);

/// Keeps the newest ANALYSIS of each pool, and of each robot and program.
class CurvesView {
 public:
  static constexpr std::size_t kMaxPools = 64;
  static constexpr std::size_t kMaxOfRobots = 2000;  ///< about 8 KB each, 50 KB at most

  void take(const analysis_t& analysis);
  void clear();

  /// Programs whose pool has changed since the previous call.
  [[nodiscard]] std::vector<std::string> takeChanged();

  /// The pool of a program; null if none was received.
  [[nodiscard]] const analysis_t* pool(const std::string& program) const;

  /// The response to the query `analysis`: all programs of one robot.
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
