/// Decides which ROS 2 publisher may set the light. Without bus and clock.
#pragma once

#include <cstdint>
#include <lab/light_command_t.hpp>
#include <optional>
#include <string>

#include "common/service/manual_light.hpp"
#include "dds_gateway/ros/command_arbiter.hpp"

namespace lab::gateway {

/// Uniform light on the whole arena, like `lab light 0.5`. It outranks the experiment's script
/// until it is released. One publisher owns the light until it has been silent for `timeout`.
class LightArbiter {
 public:
  explicit LightArbiter(std::int64_t timeout_us) : timeout_us_(timeout_us) {}

  /// @param intensity [1] 0..1
  /// @param hold [s] after which it is released, 0: until release()
  Answer show(dds::WriterId writer, double intensity, double hold, const std::string& label,
              std::int64_t now);
  Answer release(dds::WriterId writer, std::int64_t now);

  /// The command to send now: at once, then at 2 Hz. Of the header only seq is set.
  [[nodiscard]] std::optional<light_command_t> due(std::int64_t now);

 private:
  static constexpr double kLongestHold = 86400;  // [s]

  [[nodiscard]] bool isOwned(dds::WriterId writer, std::int64_t now) const;

  std::int64_t timeout_us_;
  dds::WriterId owner_ = 0;
  std::int64_t heard_utime_ = 0;
  ManualLight light_;
};

}  // namespace lab::gateway
