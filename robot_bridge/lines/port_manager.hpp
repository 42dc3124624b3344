/// The lines to the robots: found, opened, lost and found again.
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
  bool offered = false;  ///< take the lines of simulated robots
  std::string patterns;  ///< of devices, separated by spaces; empty: none
  int baud = 38400;
};

/// Keeps every line open on which there is a robot of this lab. Robots are known by the uid they
/// say, never by the name of a line, so a robot may come back under another name.
///
/// Whatever is wrong with a line is said once, until the line or the fault changes.
class PortManager {
 public:
  using Note = std::function<void(const std::string&)>;
  using Robots = std::map<std::uint32_t, RobotLink*>;  ///< by uid

  /// @param robots outlive the keeper
  PortManager(Loop& loop, SerialPorts& ports, PortSettings settings, Robots robots, Note note);
  ~PortManager();

  /// Looks for lines (twice a second), opens what is due, lets sessions and robots repeat what they
  /// wait for. To be called every 20 ms or so.
  void tick();

  /// Writes what robots have to say after they were given orders.
  void flush();

  /// The line a robot is on, empty: none.
  [[nodiscard]] std::string lineOf(const RobotLink& robot) const;

 private:
  struct Line {
    bool found = false;                ///< since it was last lost
    std::unique_ptr<SerialPort> port;  ///< none: closed
    std::optional<LineSession> session;
    RobotLink* robot = nullptr;
    std::string refusal;  ///< not empty: to be closed, and why
    std::int64_t retry_utime = 0;
    std::int64_t back_off_us = 0;
    std::string complaint;  ///< the last, so that it is not repeated
  };
  using Lines = std::map<std::string, Line>;
  using Entry = Lines::value_type;

  void scan(std::int64_t now);
  void open(Entry& entry, std::int64_t now);
  void read(Entry& entry);
  void take(Entry& entry, const wire::Frame& frame, std::int64_t now);
  void adopt(Entry& entry, const wire::Hello& hello, std::int64_t now);
  void judge(Entry& entry, std::int64_t now);
  void write(Entry& entry);
  void close(Entry& entry, std::int64_t retry_utime);
  void lose(Entry& entry, const std::string& why);
  void complain(Entry& entry, const std::string& kind, const std::string& text);
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
