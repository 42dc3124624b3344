/// Sequences of pictures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tracker_svc/film_reader.hpp"

namespace lab::cameras {

/// A picture of a sequence.
struct PictureFile {
  std::filesystem::path path;
  std::int64_t number = 0;
  std::optional<std::int64_t> utime;  ///< [us] since the first, if there is a frames.csv
};

/// Whether this names pictures: a folder, a pattern, or a file with a picture's extension.
[[nodiscard]] bool isPictureSource(const std::string& source);

/// The pictures in order of the numbers in their names, f2 before f10.
/// @throws CameraError if there are none, or a frames.csv beside them is invalid
[[nodiscard]] std::vector<PictureFile> findPictures(const std::string& source);

/// @param fps [1/s] of pictures without times
/// @throws CameraError as FilmReader::open()
[[nodiscard]] std::unique_ptr<FilmReader> openPictures(const std::string& source, double fps);

}  // namespace lab::cameras
