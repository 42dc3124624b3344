#pragma once

namespace lab::runner {

/// Parses the command line of `lab` and does what it says.
/// @return the exit code. @throws what the commands throw.
int runCommandLine(int argc, char** argv);

}  // namespace lab::runner
