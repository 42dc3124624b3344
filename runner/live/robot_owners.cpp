#include "runner/live/robot_owners.hpp"

#include "common/math/units.hpp"

namespace lab::runner {
namespace {

std::string ownerName(const std::string& sender, std::int64_t instance) {
  return sender + " (instance " + std::to_string(instance) + ")";
}

}  // namespace

std::vector<std::string> RobotOwners::take(const robot_status_t& status) {
  std::vector<std::string> disputes;
  for (const robot_state_t& robot : status.robots) {
    Owner& owner = owners_[robot.robot_id];
    const bool same = owner.sender == status.sender && owner.instance == status.instance;
    const bool other_is_alive =
        !owner.sender.empty() && status.utime - owner.utime < units::kSecond_us;
    const bool takes_over = owner.sender == status.sender && status.instance > owner.instance;
    if (same || !other_is_alive || takes_over) {
      owner = {status.sender, status.instance, status.utime};
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
