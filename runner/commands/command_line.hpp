#pragma once

namespace lab::runner {

/// Parses the command line of `lab` and executes the command. Commands that are programs of their
/// own replace this process (becomeProgram()).
/// @return the exit code. @throws what the commands throw
int runCommandLine(int argc, char** argv);

}  // namespace lab::runner
