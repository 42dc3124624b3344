#include "runner/command_line/output_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "common/files/output_links.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner {

namespace fs = std::filesystem;

void checkOutput(const fs::path& path, bool force) {
  if (fs::is_directory(path)) {
    throw UserError(fmt::format("{}: is a folder, expected the name of a file", path.string()));
  }
  if (fs::exists(path) && !fs::is_regular_file(path)) {
    throw UserError(fmt::format("{}: is a device, a pipe or a socket, expected the name of a file",
                                path.string()));
  }
  if (fs::exists(path) && !force) {
    throw UserError(fmt::format(
        "{}: is there already; choose another name, or --force to replace it", path.string()));
  }
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(folder)) {
    throw UserError(fmt::format("{}: there is no folder {}", path.string(), folder.string()));
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    throw UserError(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(errno)));
  }
}

void refuseLink(const fs::path& path) {
  if (const std::string problem = explainLink(path); !problem.empty()) throw UserError(problem);
}

}  // namespace lab::runner
