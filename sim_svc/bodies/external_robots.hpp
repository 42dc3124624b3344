/// The robots whose programs run outside the world, in step with it, and their serial lines.
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
  /// World and programs advance by at most this much at a time: what a program senses is at most
  /// this old (a robot moves 0.54 mm in it), and what it sends is at most this late.
  static constexpr std::int64_t kSlice_us = 2000;

  /// @param ports where the robots' lines are offered
  /// @param catch_up advances world and robots to the present: called before bytes are taken from a
  /// line, so that they come at their time
  ExternalRobots(World& world, SerialPorts& ports, std::function<void()> catch_up)
      : world_(world), ports_(ports), catch_up_(std::move(catch_up)) {}

  /// Takes in a driver and offers a line for each of its robots, named robot_07 for id 7.
  /// @throws SerialError when a line cannot be made
  void add(std::unique_ptr<BodyDriver> driver);

  [[nodiscard]] bool empty() const { return robots_.empty(); }

  /// Advances everything to the given world time.
  void advanceTo(std::int64_t time_us);

  /// The kind of program that the world's robot i runs, BodyDriver::kUnknown where nobody knows.
  [[nodiscard]] std::int8_t kind(std::size_t i) const;

 private:
  struct Robot {
    BodyDriver* driver = nullptr;
    std::size_t k = 0;
    std::unique_ptr<SerialPort> port;
  };

  void takeBytes(Robot& robot);

  World& world_;
  SerialPorts& ports_;
  std::function<void()> catch_up_;
  std::vector<std::unique_ptr<BodyDriver>> drivers_;
  std::map<std::size_t, Robot> robots_;  ///< By the world's robot. They stay where they are.
};

/// The name under which the line of a simulated robot is offered.
[[nodiscard]] std::string lineName(std::int32_t robot_id);

}  // namespace lab::sim
