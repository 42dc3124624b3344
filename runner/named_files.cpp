#include "runner/named_files.hpp"

#include "runner/exit_code.hpp"

namespace lab::runner {

void refuseExisting(const std::filesystem::path& path, bool force) {
  if (!std::filesystem::exists(path) || force) return;
  throw UserError(path.string() +
                  ": is there already; choose another name, or --force to replace it");
}

std::unique_ptr<FilmReader> openFilm(const std::string& source) {
  try {
    return FilmReader::open(source);
  } catch (const CameraError& error) {
    throw UserError(error.what());
  }
}

}  // namespace lab::runner
