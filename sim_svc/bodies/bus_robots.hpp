/// Robots that are simulated completely: executes their orders from the bus and reports their
/// state.
#pragma once

#include <cstdint>
#include <lab/program_id_t.hpp>
#include <lab/robot_calibration_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_senses_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/experiment/order_settings.hpp"
#include "sim_svc/world.hpp"

namespace lab::sim {

/// Has the same behaviour on the bus as robot_bridge has for robots on the wire.
class BusRobots {
 public:
  /// @param bodies indices of these robots in the world
  /// @param sensor_period [s]
  BusRobots(World& world, const std::vector<std::size_t>& bodies, double sensor_period);

  [[nodiscard]] bool empty() const { return links_.empty(); }

  /// @return why an order in it was rejected; empty if none was
  std::string handle(const robot_command_t& command);

  void handle(const robot_stop_t& stop);

  /// Writes the virtual senses of these robots.
  /// @param utime when they are received
  void handle(const robot_senses_t& senses, std::int64_t utime);

  /// Stores the calibrations for these robots. @return the calibrations that they hold now; empty
  /// if the message is for none of them
  std::optional<robot_calibration_t> handle(const robot_calibration_t& calibration);

  /// Adds the state of every robot.
  /// @param origin_utime the utime of world time 0
  void report(std::int64_t origin_utime, std::vector<robot_state_t>& states);

 private:
  /// The state of each robot that is not part of the world.
  struct Link {
    std::size_t body = 0;
    std::int64_t command_seq = 0;
    std::int64_t command_instance = 0;
    std::int64_t stop_seq = 0;
    std::int32_t messages_to = 0;
    std::int32_t messages_from = 0;
    bool rejected = false;
    std::vector<program_id_t> programs;  ///< by slot
    std::int64_t senses_utime = 0;
    std::int64_t senses_since_utime = 0;
    std::int64_t robot_contacts = 0;  ///< already reported
    std::int64_t wall_contacts = 0;
    std::uint32_t saturations = 0;
  };

  /// Makes the programs of an order known to the robots, or refuses the order.
  void keepPrograms(OrderSettings& settings);
  void execute(Link& link, const robot_order_t& order, const OrderSettings& settings);
  [[nodiscard]] robot_state_t stateOf(Link& link, std::int64_t origin_utime);

  World& world_;
  double sensor_period_;
  std::map<std::int32_t, Link> links_;  ///< by id
};

}  // namespace lab::sim
