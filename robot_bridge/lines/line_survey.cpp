#include "robot_bridge/lines/line_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "common/text/printable.hpp"

namespace lab::bridge {
namespace {

std::string resetText(std::uint8_t cause) {
  switch (cause) {
    case wire::kResetPower:
      return "power";
    case wire::kResetPin:
      return "reset pin";
    case wire::kResetBrownOut:
      return "brown-out";
    case wire::kResetWatchdog:
      return "watchdog";
    default:
      return "unknown";
  }
}

std::string boardText(std::uint8_t board) {
  switch (board) {
    case 1:
      return "Pro Mini";
    case 2:
      return "host";
    default:
      return std::to_string(board);
  }
}

std::vector<std::string> cellsOf(const LineSurvey::Row& row) {
  const std::optional<wire::Hello>& hello = row.hello;
  const std::string path = printable(row.path);
  const std::string finding = printable(row.finding);
  if (!hello) return {path, "-", "-", "-", "-", "-", finding};
  return {path,
          std::to_string(hello->uid),
          fmt::format("{}.{} ({:08x})", hello->firmware >> 8, hello->firmware & 0xFF, hello->build),
          boardText(hello->board),
          std::to_string(hello->baud),
          resetText(hello->reset_cause),
          finding};
}

}  // namespace

LineSurvey::LineSurvey(Loop& loop, SerialPorts& ports, const std::vector<std::string>& paths,
                       int baud)
    : loop_(loop), baud_(baud) {
  for (const std::string& path : paths) {
    Line& line = lines_.emplace_back(Line{{path, {}, {}}, nullptr, LineSession(loop.now())});
    try {
      line.port = ports.open(path, baud);
      line.port->onReadable([this, &line] { read(line); });
    } catch (const SerialError& error) {
      line.row.finding = error.what();
      if (line.row.finding.starts_with(path + ": ")) line.row.finding.erase(0, path.size() + 2);
    }
  }
}

void LineSurvey::read(Line& line) {
  std::array<std::uint8_t, 512> bytes;
  try {
    const std::size_t count = line.port->read(bytes);
    line.session.receive({bytes.data(), count}, loop_.now(), [](const wire::Frame&) {});
  } catch (const SerialError&) {
    line.row.finding = "gone";
    line.port.reset();
    return;
  }
  finishIfDecided(line);
}

void LineSurvey::finishIfDecided(Line& line) {
  if (!line.port || line.session.verdict() == LineSession::Verdict::kWaiting) return;
  line.row.hello = line.session.hello();
  line.row.finding = line.session.reason(baud_);
  if (line.row.hello && line.row.hello->uid == 0 && line.row.finding.empty()) {
    line.row.finding = "has no uid; give it one: robot_bridge --set-uid N " + line.row.path;
  }
  line.port.reset();
}

bool LineSurvey::tick() {
  for (Line& line : lines_) {
    if (!line.port) continue;
    line.session.tick(loop_.now());
    try {
      if (!line.session.outgoing().empty()) {
        static_cast<void>(line.port->write(line.session.outgoing()));
      }
      line.session.outgoing().clear();
      finishIfDecided(line);
    } catch (const SerialError&) {
      line.row.finding = "gone";
      line.port.reset();
    }
  }
  return std::none_of(lines_.begin(), lines_.end(), [](const Line& line) { return !!line.port; });
}

std::vector<LineSurvey::Row> LineSurvey::rows() const {
  std::vector<Row> rows;
  for (const Line& line : lines_) rows.push_back(line.row);
  return rows;
}

std::string surveyText(const std::vector<LineSurvey::Row>& rows) {
  std::vector<std::vector<std::string>> table = {
      {"line", "uid", "firmware", "board", "baud", "last reset", "finding"}};
  for (const LineSurvey::Row& row : rows) table.push_back(cellsOf(row));
  std::array<std::size_t, 7> widths{};
  for (const auto& cells : table) {
    for (std::size_t i = 0; i < widths.size(); ++i) {
      widths[i] = std::max(widths[i], cells[i].size());
    }
  }
  std::string text;
  for (const auto& cells : table) {
    std::string line;
    for (std::size_t i = 0; i < widths.size(); ++i) {
      line += fmt::format("{:{}}  ", cells[i], widths[i]);
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

}  // namespace lab::bridge
