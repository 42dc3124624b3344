/// Lists the serial lines and the robots on them, without an experiment: robot_bridge --list.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/loop/loop.hpp"
#include "common/serial/serial.hpp"
#include "robot_bridge/lines/line_session.hpp"

namespace lab::bridge {

/// Opens lines, waits for HELLO or a timeout on each, and closes them. Opening a line resets many
/// boards, so lines in use should not be surveyed. A line that a bridge has open cannot be opened.
class LineSurvey {
 public:
  struct Row {
    std::string path;
    std::optional<wire::Hello> hello;
    std::string finding;  ///< problem with the line or the robot; empty if there is none
  };

  LineSurvey(Loop& loop, SerialPorts& ports, const std::vector<std::string>& paths, int baud);

  /// To be called about every 20 ms. @return whether the survey is complete
  bool tick();

  /// In the order of the paths.
  [[nodiscard]] std::vector<Row> rows() const;

 private:
  struct Line {
    Row row;
    std::unique_ptr<SerialPort> port;  ///< null: this line is done
    LineSession session;
  };

  void read(Line& line);
  void finishIfDecided(Line& line);

  Loop& loop_;
  int baud_;
  std::list<Line> lines_;
};

/// The rows as a text table for a terminal.
[[nodiscard]] std::string surveyText(const std::vector<LineSurvey::Row>& rows);

}  // namespace lab::bridge
