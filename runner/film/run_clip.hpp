/// Stills and a sped-up clip of the films of a run, with the poses of its log drawn into them.
#pragma once

#include <filesystem>
#include <string>

#include "runner/film/retrack.hpp"

namespace lab::runner {

namespace clip_files {
inline constexpr const char* kClip = "film.mp4";
inline constexpr const char* kStills = "film.jpg";
/// {"t_s": [time of each picture of the clip, s since the first message of the log], "fps"}
inline constexpr const char* kTimes = "film_clip.json";
}  // namespace clip_files

/// Makes the three files. Reads only the frames that it shows, at most 240 of each camera, whatever
/// the length of the film. Several cameras are shown side by side.
/// @param of the run with the films, its calibrations and its settings
/// @param log the poses; that of the run, or one that was tracked again
/// @param out folder of the files
/// @return why there are none; empty: they are made, or the run has no film
[[nodiscard]] std::string makeRunClip(const RetrackOptions& of, const std::filesystem::path& log,
                                      const std::filesystem::path& out);

}  // namespace lab::runner
