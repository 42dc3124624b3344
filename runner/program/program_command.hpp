/// `lab program`: the programs of motion.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/programs/program_file.hpp"

namespace lab::runner {

struct TraceOptions {
  std::string program;  ///< Name of a shipped program, or a file.
  int holds = 10;
  std::uint64_t seed = 1;
  std::vector<std::string> set;  ///< what the sensors read: "light=0.5", see setInput()
};

/// Reads a file, or the shipped program of that name.
/// @throws UserError if there is none; ExperimentError with all problems of the file
[[nodiscard]] ProgramFile loadProgram(const std::string& named);

/// What is known of a program before it runs: size, ranges, times, warnings.
[[nodiscard]] std::string describeProgram(const ProgramFile& program);

/// Byte code, and the holds of one execution.
[[nodiscard]] std::string traceProgram(const ProgramFile& program, const TraceOptions& options);

int listPrograms();
int showProgram(const std::string& named);
int checkProgram(const std::string& named);
int traceProgram(const TraceOptions& options);

}  // namespace lab::runner
