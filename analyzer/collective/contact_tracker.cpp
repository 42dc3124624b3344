#include "analyzer/collective/contact_tracker.hpp"

#include <algorithm>
#include <cmath>

namespace lab::collective {
namespace {

constexpr double kBegin = 1.03;     // diameters
constexpr double kEnd = 1.06;       // diameters
constexpr double kForgotten = 0.5;  // [s]

}  // namespace

const ContactFrame& ContactTracker::take(double time, const std::vector<CrowdRobot>& robots) {
  // After a step of the clock backwards nothing is known about the time before.
  if (time < last_time_) {
    contacts_.clear();
    at_wall_.clear();
    first_seen_.clear();
  }
  last_time_ = time;
  frame_.pairs.clear();
  frame_.ended.clear();
  frame_.left_wall.clear();
  frame_.touching.assign(robots.size(), 0);
  frame_.at_wall.assign(robots.size(), 0);
  points_.clear();
  index_.clear();
  for (std::size_t i = 0; i < robots.size(); ++i) {
    points_.push_back({robots[i].x, robots[i].y});
    index_[robots[i].id] = i;
    first_seen_.try_emplace(robots[i].id, time);
  }
  const double begin2 = kBegin * settings_.diameter * kBegin * settings_.diameter;
  forEachPair(
      points_, kEnd * settings_.diameter, order_,
      [&](std::size_t i, std::size_t j, double, double, double r2) {
        const auto key = std::minmax(robots[i].id, robots[j].id);
        auto known = contacts_.find(key);
        if (known == contacts_.end()) {
          if (r2 >= begin2) return;
          const bool from_start = first_seen_[key.first] == time || first_seen_[key.second] == time;
          known = contacts_.emplace(key, Contact{from_start ? units::kNan : time, time}).first;
        }
        known->second.seen = time;
        frame_.pairs.emplace_back(i, j);
        frame_.touching[i] = 1;
        frame_.touching[j] = 1;
      });
  for (auto contact = contacts_.begin(); contact != contacts_.end();) {
    const auto& [ids, state] = *contact;
    if (state.seen == time) {
      ++contact;
      continue;
    }
    const auto first = index_.find(ids.first);
    const auto second = index_.find(ids.second);
    const bool seen = first != index_.end() && second != index_.end();
    const bool forgotten = time - state.seen > kForgotten;
    if (seen && !forgotten) {
      frame_.ended.push_back({first->second, second->second, time - state.begin});
    }
    contact = seen || forgotten ? contacts_.erase(contact) : std::next(contact);
  }
  walls(time, robots);
  return frame_;
}

void ContactTracker::forget(int robot) {
  at_wall_.erase(robot);
  first_seen_.erase(robot);
}

void ContactTracker::walls(double time, const std::vector<CrowdRobot>& robots) {
  const Rectangle& arena = settings_.arena;
  const double radius = 0.5 * settings_.diameter;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const CrowdRobot& robot = robots[i];
    const double distance = std::min(std::min(robot.x - arena.left, arena.right - robot.x),
                                     std::min(robot.y - arena.bottom, arena.top - robot.y));
    const double gap = (distance - radius) / settings_.diameter;
    const auto known = at_wall_.find(robot.id);
    const bool was = known != at_wall_.end() && time - known->second <= kForgotten;
    const bool is = gap < (was ? kEnd : kBegin) - 1;
    if (is) {
      at_wall_[robot.id] = time;
      frame_.at_wall[i] = 1;
    } else {
      if (was) frame_.left_wall.push_back(i);
      if (known != at_wall_.end()) at_wall_.erase(known);
    }
  }
}

}  // namespace lab::collective
