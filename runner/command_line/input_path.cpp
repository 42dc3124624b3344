#include "runner/command_line/input_path.hpp"

#include <fmt/format.h>

#include <string>
#include <system_error>

#include "runner/command_line/exit_code.hpp"

namespace lab::runner {
namespace fs = std::filesystem;

void requireFolderOrFile(const fs::path& input, const FileKind& expected) {
  std::error_code error;
  if (fs::is_directory(input, error)) return;
  if (!fs::exists(input, error)) {
    throw UserError(fmt::format("{}: found nothing, expected {}", input.string(), expected.name));
  }
  if (const std::string problem = regularFileProblem(input, expected); !problem.empty()) {
    throw UserError(fmt::format("{}: {}", input.string(), problem));
  }
}

}  // namespace lab::runner
