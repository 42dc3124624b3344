/// Which service reports which robot.
#pragma once

#include <cstdint>
#include <lab/robot_status_t.hpp>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace lab::runner {

/// Finds robots that two living services report at once. A restarted service takes its robots over;
/// late messages of its previous instance are ignored.
class RobotOwners {
 public:
  /// @return a sentence for each robot that now has two owners, once per robot
  [[nodiscard]] std::vector<std::string> take(const robot_status_t& status);

 private:
  struct Owner {
    std::string sender;
    std::int64_t instance = 0;
    std::int64_t utime = 0;  ///< of its last status
  };
  std::map<std::int32_t, Owner> owners_;
  std::set<std::int32_t> disputed_;
};

}  // namespace lab::runner
