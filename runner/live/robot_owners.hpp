/// Which service reports which robot.
#pragma once

#include <cstdint>
#include <deque>
#include <lab/robot_status_t.hpp>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace lab::runner {

/// Finds robots that two living services report at once. A restarted service takes its robots over;
/// late messages of its previous instance are ignored. Who lives is decided by the time of arrival:
/// the stamps of a service that was restarted after a step of the wall clock differ from those of
/// all others, by hours and in both directions.
class RobotOwners {
 public:
  /// @param now of the arrival
  /// @return a sentence for each robot that now has two owners, once per robot
  [[nodiscard]] std::vector<std::string> take(const robot_status_t& status, std::int64_t now);

 private:
  struct Owner {
    std::string sender;
    std::int64_t instance = 0;
    std::int64_t heard_utime = 0;       ///< arrival of its last status
    std::int64_t since_utime = 0;       ///< arrival of its first status
    std::deque<std::int64_t> former{};  ///< instances of the same sender, oldest first
  };
  std::map<std::int32_t, Owner> owners_;
  std::set<std::int32_t> disputed_;
};

}  // namespace lab::runner
