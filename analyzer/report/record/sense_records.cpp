#include "analyzer/report/record/sense_records.hpp"

#include <algorithm>
#include <cmath>

#include "common/experiment/experiment_describe.hpp"

namespace lab::report {

void SenseRecords::take(const robot_senses_t& senses) {
  for (const sense_values_t& robot : senses.robots) {
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const double value = static_cast<double>(robot.values[i]);
      Sums& sums = sums_[i];
      const bool first = sums.values == 0;
      sums.lowest = first ? value : std::min(sums.lowest, value);
      sums.highest = first ? value : std::max(sums.highest, value);
      // Welford's recursion.
      ++sums.values;
      const double before = value - sums.mean;
      sums.mean += before / static_cast<double>(sums.values);
      sums.squares += before * (value - sums.mean);
    }
  }
}

std::vector<SenseRecord> SenseRecords::records(const Senses& senses) const {
  std::vector<SenseRecord> records;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const Sums& sums = sums_[i];
    const auto spec =
        std::ranges::find(senses.values, static_cast<std::int64_t>(i), &SenseSpec::index);
    const bool defined = spec != senses.values.end();
    if (sums.values == 0 || (!defined && sums.lowest == 0 && sums.highest == 0)) continue;
    records.push_back({.index = static_cast<int>(i),
                       .what = defined ? senseText(*spec) : "",
                       .values = sums.values,
                       .mean = sums.mean,
                       .deviation = std::sqrt(sums.squares / static_cast<double>(sums.values)),
                       .lowest = sums.lowest,
                       .highest = sums.highest});
  }
  return records;
}

}  // namespace lab::report
