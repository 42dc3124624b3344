/// The stops in force in a run. The runner repeats them until a sender releases them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <lab/robot_stop_t.hpp>
#include <map>
#include <set>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "runner/live/robot_admission.hpp"

namespace lab::runner {

/// Whatever arrives on the bus, its memory and the number of messages that it repeats stay bounded.
class StopLatch {
 public:
  /// Robots that are not of the experiment whose stop is kept: more than a lab lends to others.
  static constexpr std::size_t kMostOthers = 64;
  /// Messages that are repeated. Beyond, the oldest stops are repeated in one message.
  static constexpr std::size_t kMostMessages = 16;
  /// Stops that are recognised when they are repeated: a sender repeats one for seconds.
  static constexpr std::size_t kMostTaken = 4096;

  explicit StopLatch(const Experiment& experiment);

  /// Takes a stop or release from the bus.
  /// @return false when this one (by seq) was taken before
  bool take(const robot_stop_t& stop);

  /// Sets or releases a stop. Without robot_ids it applies to all robots.
  void set(const robot_stop_t& stop);

  /// How many robots are under a stop that nobody has released.
  [[nodiscard]] std::size_t robotsStopped() const { return latched_.size(); }

  /// The messages to repeat now: one for each stop that some robot is still under, at most
  /// kMostMessages.
  [[nodiscard]] std::vector<robot_stop_t> inForce(std::int64_t now) const;

  /// Whether stops of robots beyond kMostOthers were not kept.
  [[nodiscard]] bool refused() const { return admission_.refused(); }

 private:
  std::vector<std::int32_t> all_robots_;
  RobotAdmission admission_;
  std::map<std::int32_t, std::int64_t> latched_;  ///< seq of the stop in force, by robot
  std::set<std::int64_t> taken_;                  ///< by seq
  std::deque<std::int64_t> order_;                ///< the same, oldest first
};

}  // namespace lab::runner
