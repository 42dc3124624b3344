/// Files that a command line names.
#pragma once

#include <memory>
#include <string>

#include "tracker_svc/film_reader.hpp"

namespace lab::runner {

/// FilmReader::open().
/// @param fps [1/s] of pictures without times, 0: 30
/// @throws UserError when there is no such film, and for a network stream, which has no end.
[[nodiscard]] std::unique_ptr<FilmReader> openFilm(const std::string& source, double fps = 0);

}  // namespace lab::runner
