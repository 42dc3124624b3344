#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "dds_gateway/dds/domain.hpp"

namespace lab::gateway {

/// Finds endpoints of other participants that use the name of one of our topics with another type.
/// DDS does not match such endpoints and does not report them.
class ForeignEndpoints {
 public:
  /// @throws DdsError
  explicit ForeignEndpoints(const dds::Domain& domain);

  /// Reads the endpoints of the domain.
  /// @param types DDS's names of the types, by DDS's name of each of our topics
  void update(const std::multimap<std::string, std::string>& types);

  /// Number of such endpoints at the last update().
  [[nodiscard]] std::int64_t count() const { return count_; }
  /// The last of them: "rt/lab/robot1/cmd_vel has std_msgs::msg::dds_::String_"; empty: none.
  [[nodiscard]] const std::string& last() const { return last_; }

 private:
  void update(const dds::Entity& reader, const std::multimap<std::string, std::string>& types);

  dds::Entity publications_;
  dds::Entity subscriptions_;
  std::int64_t count_ = 0;
  std::string last_;
};

}  // namespace lab::gateway
