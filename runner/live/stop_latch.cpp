#include "runner/live/stop_latch.hpp"

#include <utility>

namespace lab::runner {

StopLatch::StopLatch(const Experiment& experiment) {
  for (const RobotSpec& robot : experiment.robots) all_robots_.push_back(robot.id);
}

bool StopLatch::take(const robot_stop_t& stop) {
  if (!taken_.insert(stop.seq).second) return false;
  set(stop);
  return true;
}

void StopLatch::set(const robot_stop_t& stop) {
  for (const std::int32_t id : stop.robot_ids.empty() ? all_robots_ : stop.robot_ids) {
    if (stop.clear != 0) {
      latched_.erase(id);
    } else {
      latched_[id] = stop.seq;
    }
  }
}

std::vector<robot_stop_t> StopLatch::inForce(std::int64_t now) const {
  std::map<std::int64_t, robot_stop_t> by_seq;
  for (const auto& [id, seq] : latched_) {
    robot_stop_t& stop = by_seq[seq];
    stop.seq = seq;
    stop.utime = now;
    stop.clear = 0;
    stop.reason = "stop in force";
    stop.robot_ids.push_back(id);
    stop.num_robots = static_cast<std::int32_t>(stop.robot_ids.size());
  }
  std::vector<robot_stop_t> stops;
  for (auto& [seq, stop] : by_seq) stops.push_back(std::move(stop));
  return stops;
}

}  // namespace lab::runner
