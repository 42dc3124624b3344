/// Files that a command line names.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "cameras/film_reader.hpp"

namespace lab::runner {

/// @throws UserError when the file is there already, unless it may be replaced.
void refuseExisting(const std::filesystem::path& path, bool force);

/// FilmReader::open(). @throws UserError when there is no such film.
[[nodiscard]] std::unique_ptr<FilmReader> openFilm(const std::string& source);

}  // namespace lab::runner
