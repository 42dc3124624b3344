#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "dds_gateway/dds/domain.hpp"

namespace lab::gateway {

/// Watches what others in the domain publish and subscribe under the names of our topics, but with
/// another type: DDS joins them with nobody and says nothing.
class ForeignEndpoints {
 public:
  /// @throws DdsError
  explicit ForeignEndpoints(const dds::Domain& domain);

  /// @param types DDS's names of the types by DDS's name of each of our topics
  void look(const std::multimap<std::string, std::string>& types);

  /// At the last look.
  [[nodiscard]] std::int64_t count() const { return count_; }
  /// The last: "rt/lab/robot1/cmd_vel has std_msgs::msg::dds_::String_"; empty: none.
  [[nodiscard]] const std::string& last() const { return last_; }

 private:
  void look(const dds::Entity& reader, const std::multimap<std::string, std::string>& types);

  dds::Entity publications_;
  dds::Entity subscriptions_;
  std::int64_t count_ = 0;
  std::string last_;
};

}  // namespace lab::gateway
