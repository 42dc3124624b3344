/// Identifies a robot that was just flashed, and gives it a uid if it has none.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "common/loop/loop.hpp"
#include "common/serial/serial.hpp"
#include "robot/wire/frame.hpp"
#include "robot/wire/messages.hpp"

namespace lab::runner {

/// Waits on an open line for the HELLO of a robot. Stores a uid if its EEPROM has none.
///
/// Nothing is sent at first, because the bootloader, which runs before the program, would take it.
class RobotAdoption {
 public:
  struct Result {
    bool ok = false;
    wire::Hello hello;        ///< the last one received
    bool uid_is_new = false;  ///< it had none and was given one
    std::string problem;      ///< one line, when not ok
  };

  /// @param loop must run on for 10 s, until the last timer of this object
  /// @param fresh_uid for a robot without one; not 0
  RobotAdoption(Loop& loop, std::unique_ptr<SerialPort> line, std::uint32_t fresh_uid,
                std::function<void(const Result&)> done);
  ~RobotAdoption();
  RobotAdoption(const RobotAdoption&) = delete;
  RobotAdoption& operator=(const RobotAdoption&) = delete;

 private:
  struct Talk;
  std::shared_ptr<Talk> talk_;  ///< timers of the loop hold weak pointers
};

/// A random uid that is neither 0 nor that of a simulated robot.
[[nodiscard]] std::uint32_t randomUid();

}  // namespace lab::runner
