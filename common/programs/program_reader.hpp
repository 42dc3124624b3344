/// Reads programs of motion from TOML tables. Include it only from .cpp files, because toml++ is a
/// large header.
#pragma once

#include <toml++/toml.h>

#include <string>

#include "common/files/file_problems.hpp"
#include "common/files/toml_document.hpp"
#include "common/programs/program_file.hpp"

namespace lab {

/// What a program is read with.
struct ProgramContext {
  dynamics::WheelLimits limits;
  /// Whether `model` may name another program, as in an experiment file: the texts of the shipped
  /// programs, and files relative to this one. Empty: it may not.
  ModelLookup model_of;
  LawCheck check_law;  ///< Empty: laws are not checked.
};

/// Reads and compiles the table of a program.
/// @param path of the table, for messages: "programs.fast"; empty for a file of its own
/// @return the program; with an entry in `problems` it is incomplete
[[nodiscard]] ProgramFile readProgramTable(const keys::TomlDocument& document,
                                           const toml::table& table, const std::string& path,
                                           const std::string& name, const ProgramContext& context,
                                           keys::Problems& problems);

}  // namespace lab
