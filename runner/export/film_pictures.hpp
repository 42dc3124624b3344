/// The pictures of films as JPEG, with their times.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "runner/export/mcap_export.hpp"

namespace lab::runner {

/// The film in the folder of a run: the only movie in it, or the only folder of pictures with
/// frames.csv; empty: there is none, or several.
[[nodiscard]] std::string filmOfRun(const std::filesystem::path& folder);

/// The films in the folder of a run of several cameras; empty: it is none, or has no film.
[[nodiscard]] std::vector<std::filesystem::path> camerasFilms(const std::filesystem::path& folder);

/// Reads these films picture by picture, merged by time, with the times of the run, for
/// McapOptions::film.
/// @param folders as camerasFilms()
/// @throws UserError, ExperimentError when one cannot be read
[[nodiscard]] std::function<std::optional<FilmPicture>()> camerasPictures(
    const std::vector<std::filesystem::path>& folders);

/// Reads a film picture by picture, for McapOptions::film.
/// @param source as `lab track` takes it
/// @param begin_utime of its first picture [us since 1970]
/// @throws UserError when it cannot be read
[[nodiscard]] std::function<std::optional<FilmPicture>()> filmPictures(const std::string& source,
                                                                       std::int64_t begin_utime);

}  // namespace lab::runner
