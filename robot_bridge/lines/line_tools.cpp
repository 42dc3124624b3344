#include "robot_bridge/lines/line_tools.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "common/command_line/parse_arguments.hpp"
#include "common/experiment/experiment.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/serial/serial_devices.hpp"
#include "common/text/printable.hpp"
#include "robot_bridge/lines/line_survey.hpp"
#include "robot_bridge/lines/uid_writer.hpp"

namespace lab::bridge {
namespace {

constexpr std::int64_t kTick_us = 20'000;

struct Options {
  bool list = false;
  std::uint32_t uid = 0;
  int baud = SerialLines().baud;
  std::string folder = defaultPortsFolder();
  std::vector<std::string> lines;
};

/// Runs the loop until `tool` is done.
template <class Tool>
void runUntilDone(AsioLoop& loop, Tool& tool) {
  loop.every(kTick_us, loop.now(), [&] {
    if (tool.tick()) loop.stop();
  });
  loop.run();
}

/// The lines that match the patterns of the command line. A name without wildcards is used as it
/// is, so that opening it reports what is wrong.
std::vector<std::string> linesOf(const SerialDevices& ports, const Options& options) {
  std::vector<std::string> paths;
  const auto add = [&paths](const std::vector<std::string>& more) {
    paths.insert(paths.end(), more.begin(), more.end());
  };
  for (const std::string& line : options.lines) {
    const bool is_pattern = line.find_first_of("*?[") != std::string::npos;
    add(is_pattern ? ports.matching(line) : std::vector<std::string>{line});
  }
  if (options.lines.empty()) {
    add(ports.matching(SerialLines().ports));
    add(ports.offered());
  }
  return paths;
}

int list(const Options& options) {
  AsioLoop loop;
  SerialDevices ports(loop, options.folder);
  const std::vector<std::string> paths = linesOf(ports, options);
  if (paths.empty()) {
    std::cout << (options.lines.empty()
                      ? "no lines: nothing matches " + SerialLines().ports +
                            " and no simulated robot offers one in " + printable(options.folder)
                      : "no lines match")
              << "\n";
    return 0;
  }
  LineSurvey survey(loop, ports, paths, options.baud);
  runUntilDone(loop, survey);
  std::cout << surveyText(survey.rows());
  return 0;
}

int setUid(const Options& options) {
  if (options.lines.size() != 1) {
    std::cerr << "robot_bridge: --set-uid needs one line, as in --set-uid 7 /dev/ttyUSB0\n";
    return 2;
  }
  AsioLoop loop;
  SerialDevices ports(loop, options.folder);
  try {
    UidWriter writer(loop, ports, options.lines.front(), options.baud, options.uid);
    runUntilDone(loop, writer);
    if (writer.failure().empty()) {
      std::cout << printable(options.lines.front()) << ": this robot now has uid " << options.uid
                << "\n";
      return 0;
    }
    std::cerr << printable(writer.failure()) << "\n";
  } catch (const SerialError& error) {
    std::cerr << printable(error.what()) << "\n";
  }
  return 2;
}

}  // namespace

bool wantsLineTool(int argc, char** argv) {
  return std::any_of(argv + 1, argv + argc, [](const std::string& word) {
    return word == "--list" || word.starts_with("--set-uid");
  });
}

int lineToolMain(int argc, char** argv) {
  CLI::App app{"Serial lines and the robots on them", "robot_bridge"};
  Options options;
  app.add_flag("--list", options.list, "List the lines and the robots on them");
  app.add_option("--set-uid", options.uid, "Store this number in the robot on the line")
      ->check(CLI::Range(1U, 0xFFFFFFFFU));
  app.add_option("--baud", options.baud, "Speed of the lines")->capture_default_str();
  app.add_option("--ports", options.folder, "Folder of the lines to simulated robots")
      ->capture_default_str();
  app.add_option("line", options.lines,
                 "Lines; * and ? are allowed (--list without lines: all lines)");
  if (const std::optional<int> code = parseArguments(app, argc, argv)) return *code;
  return options.list ? list(options) : setUid(options);
}

}  // namespace lab::bridge
