/// The robots that sim_svc simulates as a whole: their orders from the bus, their reports for it.
#pragma once

#include <cstdint>
#include <lab/robot_calibration_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/experiment/order_settings.hpp"
#include "sim_svc/world.hpp"

namespace lab::sim {

/// Obeys and reports as robot_bridge does for robots on the wire.
class BusRobots {
 public:
  /// @param bodies the world's robots that are on the bus
  /// @param sensor_period of all of them, s
  BusRobots(World& world, const std::vector<std::size_t>& bodies, double sensor_period);

  [[nodiscard]] bool empty() const { return links_.empty(); }

  /// @return what is wrong with an order in it, empty when nothing is
  std::string take(const robot_command_t& command);

  void take(const robot_stop_t& stop);

  /// Stores what is meant for these robots. @return what they hold now, nothing when none was meant
  std::optional<robot_calibration_t> take(const robot_calibration_t& calibration);

  /// Adds the state of every robot.
  /// @param origin_utime of world time 0
  void report(std::int64_t origin_utime, std::vector<robot_state_t>& states);

 private:
  /// What is kept for each robot beside the world.
  struct Link {
    std::size_t body = 0;
    std::int64_t command_seq = 0;
    std::int64_t command_instance = 0;
    std::int64_t stop_seq = 0;
    std::int32_t messages_to = 0;
    std::int32_t messages_from = 0;
    bool rejected = false;
    std::vector<program_t> programs;  ///< by slot
    program_t driven{};               ///< what runs while it is driven by hand
    std::int64_t robot_contacts = 0;  ///< already reported
    std::int64_t wall_contacts = 0;
    std::uint32_t saturations = 0;
  };

  void obey(Link& link, const robot_order_t& order, const OrderSettings& settings);
  [[nodiscard]] robot_state_t stateOf(Link& link, std::int64_t origin_utime);

  World& world_;
  double sensor_period_;
  std::map<std::int32_t, Link> links_;  ///< by id
};

}  // namespace lab::sim
