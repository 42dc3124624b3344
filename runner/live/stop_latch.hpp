/// The stops in force in a run. The runner repeats them until a sender releases them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <lab/robot_stop_t.hpp>
#include <map>
#include <set>
#include <vector>

#include "common/experiment/experiment.hpp"

namespace lab::runner {

class StopLatch {
 public:
  explicit StopLatch(const Experiment& experiment);

  /// Takes a stop or release from the bus.
  /// @return false when this one (by seq) was taken before
  bool take(const robot_stop_t& stop);

  /// Sets or releases a stop. Without robot_ids it applies to all robots.
  void set(const robot_stop_t& stop);

  /// How many robots are under a stop that nobody has released.
  [[nodiscard]] std::size_t robotsStopped() const { return latched_.size(); }

  /// The messages to repeat now: one for each stop that some robot is still under.
  [[nodiscard]] std::vector<robot_stop_t> inForce(std::int64_t now) const;

 private:
  std::vector<std::int32_t> all_robots_;
  std::map<std::int32_t, std::int64_t> latched_;  ///< seq of the stop in force, by robot
  std::set<std::int64_t> taken_;                  ///< by seq
};

}  // namespace lab::runner
