#include "runner/live/robot_owners.hpp"

#include <algorithm>
#include <utility>

#include "common/math/units.hpp"

namespace lab::runner {
namespace {

std::string ownerName(const std::string& sender, std::int64_t instance) {
  return sender + " (instance " + std::to_string(instance) + ")";
}

/// Messages of a former instance may still be on their way for some tenths of a second. Whoever
/// sends later than this still lives.
constexpr std::int64_t kLate_us = units::kSecond_us;
/// Former instances that are remembered, more than there are restarts within kLate_us.
constexpr std::size_t kMostFormer = 8;

}  // namespace

std::vector<std::string> RobotOwners::take(const robot_status_t& status, std::int64_t now) {
  std::vector<std::string> disputes;
  for (const robot_state_t& robot : status.robots) {
    Owner& owner = owners_[robot.robot_id];
    if (owner.sender == status.sender && owner.instance == status.instance) {
      owner.heard_utime = now;
      continue;
    }
    const bool other_is_alive =
        !owner.sender.empty() && now - owner.heard_utime < units::kSecond_us;
    const bool same_sender = owner.sender == status.sender;
    const bool former = same_sender && std::ranges::count(owner.former, status.instance) > 0;
    if (!other_is_alive || (same_sender && !former)) {
      std::deque<std::int64_t> before;
      if (same_sender) before = std::move(owner.former);
      if (same_sender) before.push_back(owner.instance);
      if (before.size() > kMostFormer) before.pop_front();
      owner = {status.sender, status.instance, now, now, std::move(before)};
    } else if (former && now - owner.since_utime < kLate_us) {
      continue;
    } else if (disputed_.insert(robot.robot_id).second) {
      disputes.push_back("robot " + std::to_string(robot.robot_id) + " has two owners, " +
                         ownerName(owner.sender, owner.instance) + " and " +
                         ownerName(status.sender, status.instance) +
                         ": stop one of them or give its robot another id");
    }
  }
  return disputes;
}

}  // namespace lab::runner
