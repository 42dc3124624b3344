/// Who outside the lab may set the light: no bus, no clock.
#pragma once

#include <cstdint>
#include <lab/light_command_t.hpp>
#include <optional>
#include <string>

#include "common/service/manual_light.hpp"
#include "dds_gateway/ros/command_arbiter.hpp"

namespace lab::gateway {

/// One light for the whole arena, as `lab light 0.5` sets it: it outranks the experiment's script
/// until it is given back. One publisher holds it until it has been silent for `timeout`.
class LightArbiter {
 public:
  explicit LightArbiter(std::int64_t timeout_us) : timeout_us_(timeout_us) {}

  /// @param intensity [1] 0..1
  /// @param hold [s] after which it is given back, 0: until somebody gives it back
  Answer show(dds::WriterId writer, double intensity, double hold, const std::string& label,
              std::int64_t now);
  Answer release(dds::WriterId writer, std::int64_t now);

  /// What is to be sent now, header left empty but for seq: at once, then at 2 Hz.
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
