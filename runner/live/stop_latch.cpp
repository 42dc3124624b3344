#include "runner/live/stop_latch.hpp"

#include <utility>

namespace lab::runner {

StopLatch::StopLatch(const Experiment& experiment) : admission_(experiment, kMostOthers) {
  for (const RobotSpec& robot : experiment.robots) all_robots_.push_back(robot.id);
}

bool StopLatch::take(const robot_stop_t& stop) {
  if (!taken_.insert(stop.seq).second) return false;
  order_.push_back(stop.seq);
  if (order_.size() > kMostTaken) {
    taken_.erase(order_.front());
    order_.pop_front();
  }
  set(stop);
  return true;
}

void StopLatch::set(const robot_stop_t& stop) {
  for (const std::int32_t id : stop.robot_ids.empty() ? all_robots_ : stop.robot_ids) {
    if (stop.clear != 0) {
      latched_.erase(id);
    } else if (admission_.admits(id)) {
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
  // Seqs are times, so the first is the oldest. A robot obeys a stop whatever its seq is.
  while (by_seq.size() > kMostMessages) {
    const robot_stop_t oldest = std::move(by_seq.extract(by_seq.begin()).mapped());
    robot_stop_t& next = by_seq.begin()->second;
    next.robot_ids.insert(next.robot_ids.end(), oldest.robot_ids.begin(), oldest.robot_ids.end());
    next.num_robots = static_cast<std::int32_t>(next.robot_ids.size());
  }
  std::vector<robot_stop_t> stops;
  for (auto& [seq, stop] : by_seq) stops.push_back(std::move(stop));
  return stops;
}

}  // namespace lab::runner
