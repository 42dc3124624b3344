/// Command line tools of robot_bridge that need no experiment.
#pragma once

namespace lab::bridge {

/// Whether the command line selects one of these tools.
[[nodiscard]] bool wantsLineTool(int argc, char** argv);

/// --list: lists the lines and the robots on them. --set-uid N LINE: stores a robot's uid.
/// @return exit code: 0, or 2 after one line on stderr
int lineToolMain(int argc, char** argv);

}  // namespace lab::bridge
