#include <CLI/CLI.hpp>

#include "robot_bridge/bridge_service.hpp"
#include "robot_bridge/lines/line_tools.hpp"

int main(int argc, char** argv) {
  if (lab::bridge::wantsLineTool(argc, argv)) return lab::bridge::lineToolMain(argc, argv);
  lab::ServiceDescription description = lab::bridge::serviceDescription();
  description.add_options = [](CLI::App& app) {
    app.footer(
        "Without an experiment: robot_bridge --list (lines and robots), robot_bridge --set-uid");
  };
  return lab::serviceMain(argc, argv, description);
}
