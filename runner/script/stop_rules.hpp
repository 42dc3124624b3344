/// What ends a run before its time (stop_when): no bus, no clock.
#pragma once

#include <cstdint>
#include <lab/analysis_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "runner/script/estimate_precision.hpp"

namespace lab::runner {

/// Told what the analyzer says, it says whether the run is to end. Times are us since 1970.
class StopRules {
 public:
  explicit StopRules(const Experiment& experiment);

  [[nodiscard]] bool given() const { return !rules_.empty(); }

  /// The script begins. What was heard before does not count.
  void begin(std::int64_t utime) { begin_utime_ = utime; }

  void take(const analysis_t& analysis);

  /// Why the run ends; nothing: it goes on.
  [[nodiscard]] std::optional<std::string> met() const;

  /// What is to be said when the run's time is up and the rules are not met.
  [[nodiscard]] std::string unmet() const;

  /// How far each rule is and how long it will take: "D_r of abp 7.3 %, wanted 5 %: about 12 min".
  [[nodiscard]] std::string progress() const;

 private:
  struct Rule {
    EstimatePrecision estimate;
    double at_least = 0;     ///< [s]
    double heard = 0;        ///< [s] since begin, when it was heard of last
    std::int64_t utime = 0;  ///< of that sample
    [[nodiscard]] bool holds() const { return utime != 0 && heard >= at_least && estimate.holds(); }
  };
  [[nodiscard]] std::string progress(const Rule& rule) const;

  std::vector<Rule> rules_;
  bool any_;
  std::optional<std::int64_t> begin_utime_;
};

}  // namespace lab::runner
