/// Finds, opens and reopens the serial lines to the robots.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "common/loop/loop.hpp"
#include "common/serial/serial.hpp"
#include "robot_bridge/lines/line_session.hpp"
#include "robot_bridge/protocol/robot_link.hpp"

namespace lab::bridge {

struct PortSettings {
  bool offered = false;  ///< use the lines that simulated robots offer
  std::string patterns;  ///< device patterns, separated by spaces; empty: no devices
  int baud = 38400;
};

/// Keeps all lines with robots of this experiment open. Robots are identified by the uid in their
/// HELLO, not by the name of the line, so a robot may come back under another name.
///
/// A fault of a line is reported once, until the line or the fault changes.
class PortManager {
 public:
  using Note = std::function<void(const std::string&)>;
  using Robots = std::map<std::uint32_t, RobotLink*>;  ///< by uid

  /// @param robots must outlive this object
  PortManager(Loop& loop, SerialPorts& ports, PortSettings settings, Robots robots, Note note);
  ~PortManager();

  /// Looks for lines (twice a second), opens them, and handles the timeouts of sessions and robots.
  /// To be called about every 20 ms.
  void tick();

  /// Writes the bytes that new orders have produced.
  void flush();

  /// The line that a robot is on; empty if none.
  [[nodiscard]] std::string lineOf(const RobotLink& robot) const;

 private:
  struct Line {
    bool found = false;                ///< whether it exists, since it was last lost
    std::unique_ptr<SerialPort> port;  ///< null: closed
    std::optional<LineSession> session;
    RobotLink* robot = nullptr;
    std::string refusal;  ///< why the line is to be closed; empty: it is not
    std::int64_t retry_utime = 0;
    std::int64_t back_off_us = 0;
    std::string last_fault;  ///< so that it is not reported twice
  };
  using Lines = std::map<std::string, Line>;
  using Entry = Lines::value_type;

  void scan(std::int64_t now);
  void open(Entry& entry, std::int64_t now);
  void read(Entry& entry);
  void handle(Entry& entry, const wire::Frame& frame, std::int64_t now);
  void attachRobot(Entry& entry, const wire::Hello& hello, std::int64_t now);
  void closeIfUnusable(Entry& entry, std::int64_t now);
  void write(Entry& entry);
  void close(Entry& entry, std::int64_t retry_utime);
  void handleLoss(Entry& entry, const std::string& why);
  void reportFault(Entry& entry, const std::string& kind, const std::string& text);
  [[nodiscard]] Entry* lineWith(const RobotLink& robot);

  Loop& loop_;
  SerialPorts& ports_;
  PortSettings settings_;
  Robots robots_;
  Note note_;
  Lines lines_;
  std::int64_t scan_utime_ = 0;
};

}  // namespace lab::bridge
