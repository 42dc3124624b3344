/// Rules that end a run early (`stop_when`). Pure: no bus, no clock.
#pragma once

#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/collective_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "runner/script/crowd_value.hpp"
#include "runner/script/estimate_precision.hpp"

namespace lab::runner {

/// Decides from the analyzer's estimates whether the run ends. Times are microseconds since 1970.
class StopRules {
 public:
  explicit StopRules(const Experiment& experiment);

  [[nodiscard]] bool given() const { return !rules_.empty(); }

  /// Sets the beginning of the script; earlier estimates are ignored.
  void begin(std::int64_t utime) { begin_utime_ = utime; }

  void take(const analysis_t& analysis);
  void take(const collective_t& message);

  /// @return why the run ends; nothing if it goes on
  [[nodiscard]] std::optional<std::string> met() const;

  /// Text for the report if the run ends without meeting the rules.
  [[nodiscard]] std::string unmet() const;

  /// Progress and remaining time of each rule: "D_r of slow 7.3 %, wanted 5 %: about 12 min".
  [[nodiscard]] std::string progress() const;

 private:
  struct Rule {
    EstimatePrecision estimate;
    std::optional<CrowdCondition> crowd;  ///< in place of the estimate
    double at_least = 0;                  ///< [s]
    double elapsed = 0;                   ///< [s] from begin() to the latest estimate
    std::int64_t utime = 0;               ///< of the latest estimate
    [[nodiscard]] bool isMet() const { return crowd ? crowd->holds() : estimate.holds(); }
    [[nodiscard]] bool holds() const { return utime != 0 && elapsed >= at_least && isMet(); }
  };
  [[nodiscard]] std::string progress(const Rule& rule) const;

  std::vector<Rule> rules_;
  bool any_;
  std::optional<std::int64_t> begin_utime_;
};

}  // namespace lab::runner
