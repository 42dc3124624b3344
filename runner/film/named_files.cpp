#include "runner/film/named_files.hpp"

#include <fmt/format.h>

#include "runner/command_line/exit_code.hpp"

namespace lab::runner {

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
