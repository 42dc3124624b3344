/// What robot_bridge does without an experiment.
#pragma once

namespace lab::bridge {

/// Whether the command line asks for one of them.
[[nodiscard]] bool wantsLineTool(int argc, char** argv);

/// --list: the lines and who is on them. --set-uid N LINE: gives a robot its number.
/// @return 0, or 2 with one line on stderr
int lineToolMain(int argc, char** argv);

}  // namespace lab::bridge
