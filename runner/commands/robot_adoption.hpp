/// A robot that was just flashed: who it is, and a number if it has none.
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

/// Waits on an open line for the HELLO of a robot; if its electronics have no uid, stores one.
///
/// The line is left alone at first: the bootloader, which comes before the program, would take
/// what is said to it.
class RobotAdoption {
 public:
  struct Result {
    bool ok = false;
    wire::Hello hello;        ///< the latest one heard
    bool uid_is_new = false;  ///< it had none and holds one now
    std::string problem;      ///< one line, when not ok
  };

  /// @param loop must outlive this object's last timer, 10 s
  /// @param fresh_uid not 0: for a robot without
  RobotAdoption(Loop& loop, std::unique_ptr<SerialPort> line, std::uint32_t fresh_uid,
                std::function<void(const Result&)> done);
  ~RobotAdoption();
  RobotAdoption(const RobotAdoption&) = delete;
  RobotAdoption& operator=(const RobotAdoption&) = delete;

 private:
  struct Talk;
  std::shared_ptr<Talk> talk_;  ///< timers of the loop hold it weakly
};

/// A uid for a robot: neither 0 nor one of the simulated robots'.
[[nodiscard]] std::uint32_t randomUid();

}  // namespace lab::runner
