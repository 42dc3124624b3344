#include <CLI/CLI.hpp>

#include "robot_bridge/bridge_service.hpp"
#include "robot_bridge/lines/line_tools.hpp"

int main(int argc, char** argv) {
  if (lab::bridge::wantsLineTool(argc, argv)) return lab::bridge::lineToolMain(argc, argv);
  lab::ServiceDescription description = lab::bridge::serviceDescription();
  description.add_options = [](CLI::App& app) {
    // lineToolMain() has them. Here they are for --help, and to suggest them.
    app.add_flag("--list")->description(
        "List the lines and the robots on them, without an experiment (robot_bridge --list "
        "--help)");
    app.add_flag("--set-uid")
        ->description("Store a number in the robot on a line, without an experiment");
  };
  return lab::serviceMain(argc, argv, description);
}
