/// The numbers that programs read as sense(i).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <lab/robot_senses_t.hpp>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab::report {

/// The values of one virtual sense over all robots and times, in cm, s and rad as programs read
/// them.
struct SenseRecord {
  int index = 0;     ///< i of sense(i)
  std::string what;  ///< "neighbours within 12 cm"; empty: the experiment does not say
  std::int64_t values = 0;
  double mean = 0;
  double deviation = 0;  ///< standard deviation over robots and times
  double lowest = 0;
  double highest = 0;
};

/// Collects ROBOT_SENSES.
class SenseRecords {
 public:
  void take(const robot_senses_t& senses);

  /// Those that the experiment defines, and others that were ever different from 0.
  [[nodiscard]] std::vector<SenseRecord> records(const Senses& senses) const;

 private:
  struct Sums {
    std::int64_t values = 0;
    double mean = 0;
    double squares = 0;  ///< sum of squared deviations from the mean
    double lowest = 0;
    double highest = 0;
  };
  std::array<Sums, 8> sums_;
};

}  // namespace lab::report
