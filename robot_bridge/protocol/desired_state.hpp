/// The desired state of one robot, from its ROBOT_COMMANDs.
#pragma once

#include <cstdint>
#include <deque>
#include <lab/program_id_t.hpp>
#include <lab/robot_order_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/experiment/order_settings.hpp"
#include "robot/wire/messages.hpp"

namespace lab::bridge {

/// Identifies a ROBOT_COMMAND: the number that its sender gave it, and the sender's instance.
struct CommandKey {
  std::int64_t seq = 0;
  std::int64_t instance = 0;
  bool operator==(const CommandKey&) const = default;
};

/// The order in force, its lease, and the robot's settings that it needs.
///
/// A new order is first stored unconverted, because its conversion to wheel speeds needs the
/// robot's own wheel base, which may not be known yet. An order that a robot cannot follow leaves
/// the previous one in force.
class DesiredState {
 public:
  /// @param robot_id what programs read as `id`
  /// @param max_wheel_speed [m/s]
  /// @param sensor_period [s]
  DesiredState(std::int32_t robot_id, double max_wheel_speed, double sensor_period)
      : robot_id_(robot_id), max_wheel_speed_(max_wheel_speed), sensor_period_(sensor_period) {}

  /// Stores the order of a ROBOT_COMMAND and extends the lease. @return whether it is a new one
  bool command(const CommandKey& key, std::int32_t lease_ms, const robot_order_t& order,
               std::int64_t now);

  /// Converts the stored order, if there is one.
  /// @param wheel_base of the robot [m]
  /// @return why the order is rejected; empty if it is in force now or there was none
  std::string convert(double wheel_base);

  /// The robot stands until a new order is converted.
  void stand() { standing_ = true; }
  /// The robot refused the settings: nothing is sent until a new order is converted.
  void refuse() { refused_ = rejected_ = true; }

  [[nodiscard]] bool hasOrder() const { return has_order_; }
  [[nodiscard]] bool isRefused() const { return refused_; }
  /// Whether the last order was rejected, here or by the robot.
  [[nodiscard]] bool isRejected() const { return rejected_; }
  /// Whether the order needs the settings to be in the robot.
  [[nodiscard]] bool needsSettings() const { return mode_ != robot_order_t::STAND && !standing_; }
  /// Whether a robot that reports this order number follows the order in force.
  [[nodiscard]] bool isInForce(std::uint8_t order_id) const {
    return has_order_ && !standing_ && !rejected_ && order_id == order_id_;
  }

  /// The last ROBOT_COMMAND received.
  [[nodiscard]] const CommandKey& received() const { return received_; }
  /// The ROBOT_COMMAND that the order in force came with.
  [[nodiscard]] const CommandKey& active() const { return active_; }

  /// The settings that the robot needs, and their CRC (0: any settings will do).
  [[nodiscard]] const dynamics::CoreSettings& settings() const { return wanted_.core; }
  [[nodiscard]] std::uint16_t config() const { return config_; }

  /// The definition of a program of these settings; null if none of them has this hash.
  [[nodiscard]] const program_t* definition(std::uint32_t hash) const;

  /// The ORDER message. @param config CRC of the settings in the robot
  [[nodiscard]] wire::Order orderMessage(std::uint16_t config, std::int64_t now) const;

  [[nodiscard]] bool leaseExpired(std::int64_t now) const { return now >= lease_end_; }
  [[nodiscard]] std::uint32_t leaseLeft_ms(std::int64_t now) const;

  /// The program in a slot of the settings with this CRC; hash 0 if it is not known.
  [[nodiscard]] program_id_t programOf(std::uint16_t config, std::uint8_t slot) const;

 private:
  struct ProgramTable {
    std::uint16_t config = 0;
    std::vector<program_id_t> programs;
  };

  void rememberPrograms();

  std::int32_t robot_id_;
  double max_wheel_speed_;
  double sensor_period_;
  CommandKey received_;
  CommandKey active_;
  std::optional<robot_order_t> unconverted_;
  OrderSettings wanted_;
  std::int8_t mode_ = robot_order_t::STAND;
  bool has_order_ = false;
  bool refused_ = false;
  bool rejected_ = false;
  bool standing_ = false;
  std::uint16_t config_ = 0;
  std::uint8_t order_id_ = 0;
  double wheel_left_ = 0;            ///< [m/s] of the last DRIVE order
  double wheel_right_ = 0;           ///< [m/s]
  std::deque<ProgramTable> tables_;  ///< the last ones; a robot may still report an older one
  std::int64_t lease_end_ = 0;       ///< [us]
};

}  // namespace lab::bridge
