/// Runs external robots in step with the world and connects them with serial lines.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/serial/serial.hpp"
#include "sim_svc/bodies/body_driver.hpp"

namespace lab::sim {

/// Advances drivers and world together and carries bytes between drivers and lines.
class ExternalRobots {
 public:
  /// Longest step of world and programs. Sensor readings are at most this old (a robot moves
  /// 0.54 mm in this time), and sent bytes are at most this late.
  static constexpr std::int64_t kSlice_us = 2000;

  /// @param ports offers the robots' lines
  /// @param catch_up advances world and robots to the present; called before bytes are read from a
  ///        line, so that they arrive at the right time
  ExternalRobots(World& world, SerialPorts& ports, std::function<void()> catch_up)
      : world_(world), ports_(ports), catch_up_(std::move(catch_up)) {}

  /// Adds a driver and offers a line for each of its robots, named robot_07 for id 7.
  /// @throws SerialError if a line cannot be created
  void add(std::unique_ptr<BodyDriver> driver);

  [[nodiscard]] bool empty() const { return robots_.empty(); }

  /// Advances everything to the given world time.
  void advanceTo(std::int64_t time_us);

  /// The kind of program that the world's robot i runs, or BodyDriver::kUnknown.
  [[nodiscard]] std::int64_t program(std::size_t i) const;

 private:
  struct Robot {
    BodyDriver* driver = nullptr;
    std::size_t k = 0;
    std::unique_ptr<SerialPort> port;
  };

  void readBytes(Robot& robot);

  World& world_;
  SerialPorts& ports_;
  std::function<void()> catch_up_;
  std::vector<std::unique_ptr<BodyDriver>> drivers_;
  std::map<std::size_t, Robot> robots_;  ///< By the world's robot; callbacks keep references.
};

/// The name under which the line of a simulated robot is offered.
[[nodiscard]] std::string lineName(std::int32_t robot_id);

}  // namespace lab::sim
