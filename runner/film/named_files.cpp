#include "runner/film/named_files.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "runner/command_line/exit_code.hpp"

namespace lab::runner {

namespace fs = std::filesystem;

void checkOutput(const fs::path& path, bool force) {
  if (fs::is_directory(path)) {
    throw UserError(fmt::format("{}: is a folder, expected the name of a file", path.string()));
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

std::unique_ptr<FilmReader> openFilm(const std::string& source, double fps) {
  if (source.find("://") != std::string::npos) {
    throw UserError(fmt::format(
        "{}: is a network stream, expected a film or pictures; record it first (ffmpeg -i {} "
        "-c copy film.mkv), or use it as the camera of an experiment (docs/cameras.md)",
        source, source));
  }
  try {
    return FilmReader::open(source, fps);
  } catch (const CameraError& error) {
    throw UserError(error.what());
  }
}

}  // namespace lab::runner
