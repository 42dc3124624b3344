/// Who is on which line, without an experiment: robot_bridge --list.
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

/// Opens lines, waits until each has said HELLO or nothing can be expected any more, and closes
/// them. Opening resets many boards: a robot at work should not be surveyed, and a line that a
/// bridge holds is not.
class LineSurvey {
 public:
  struct Row {
    std::string path;
    std::optional<wire::Hello> hello;
    std::string finding;  ///< what else there is to say; of a good robot nothing
  };

  LineSurvey(Loop& loop, SerialPorts& ports, const std::vector<std::string>& paths, int baud);

  /// To be called every 20 ms or so. @return whether all is known
  bool tick();

  /// In the order of the paths.
  [[nodiscard]] std::vector<Row> rows() const;

 private:
  struct Line {
    Row row;
    std::unique_ptr<SerialPort> port;  ///< none: done with it
    LineSession session;
  };

  void read(Line& line);
  void settle(Line& line);

  Loop& loop_;
  int baud_;
  std::list<Line> lines_;
};

/// The rows as a table for people.
[[nodiscard]] std::string surveyText(const std::vector<LineSurvey::Row>& rows);

}  // namespace lab::bridge
