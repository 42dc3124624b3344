/// Where Python and the package active_lab are.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lab::runner {

/// The Python for which the package is made: Debian's, unless the user works in an environment of
/// venv or conda.
[[nodiscard]] std::string pythonProgram();

/// The folder with active_lab, for PYTHONPATH. In a clone that of the build; a Debian package puts
/// it where Python looks. Empty: it is not built, or not installed.
[[nodiscard]] std::filesystem::path pythonFolder();

/// How to get it.
[[nodiscard]] std::string pythonHint();

/// The environment of this process with `added` ("NAME=value"), and with the package in PYTHONPATH.
[[nodiscard]] std::vector<std::string> pythonEnvironment(std::vector<std::string> added);

}  // namespace lab::runner
