/// ROBOT_STOP in a run: which stops are in force, who gave them, and their repetition on the bus.
#pragma once

#include <cstddef>
#include <lab/robot_stop_t.hpp>
#include <string>

#include "common/experiment/experiment.hpp"
#include "common/loop/loop.hpp"
#include "common/service/node.hpp"
#include "runner/live/experiment_record.hpp"
#include "runner/live/rate_limit.hpp"
#include "runner/live/stop_latch.hpp"

namespace lab::runner {

/// StopLatch decides which stops are in force; this class sends them and writes the record.
class StopRepeater {
 public:
  StopRepeater(Node& node, Loop& loop, const Experiment& experiment, ExperimentRecord& record);

  /// Takes a stop or release of another sender.
  void take(const robot_stop_t& stop);

  /// Sends every stop in force once. The controller calls it at 10 Hz and before every command.
  void repeat();

  /// Stops every robot until a sender releases them.
  void stopAll(const std::string& why);

  /// How many robots are under a stop that nobody has released.
  [[nodiscard]] std::size_t robotsStopped() const { return latch_.robotsStopped(); }

 private:
  Node& node_;
  Loop& loop_;
  ExperimentRecord& record_;
  StopLatch latch_;
  RateLimit recorded_;  ///< stops that are recorded one by one
};

}  // namespace lab::runner
