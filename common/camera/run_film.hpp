/// The films of a run: their folders, their facts (film.json) and the tables of their frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/camera/cameras.hpp"

namespace lab {

namespace film_files {
inline constexpr const char* kFolder = "film";  ///< in the run's folder; later parts: film_2, ...
inline constexpr const char* kMovie = "film.mkv";
inline constexpr const char* kFacts = "film.json";
}  // namespace film_files

/// The table of a movie's frames: film.mkv has film.frames.csv.
[[nodiscard]] std::filesystem::path filmTableOf(const std::filesystem::path& movie);

/// One frame of a film, and what the tracker knew when it came.
struct FilmFrame {
  std::int64_t frame = 0;            ///< position in the movie, from 0
  double time = 0;                   ///< [s] since the first frame of the film
  std::int64_t number = 0;           ///< of the camera
  std::int64_t camera_utime = 0;     ///< as the camera gave it
  std::int64_t arrived_utime = 0;    ///< when the tracker received it
  bool searched = false;             ///< the whole picture was searched, not only near known caps
  std::int64_t status_instance = 0;  ///< of the last ROBOT_STATUS before it; 0: none came yet
  std::int64_t status_seq = 0;
  std::uint64_t lost_cameras = 0;  ///< of several: bit i is set if the i-th was not waited for
};

/// Which columns a table has.
enum class FilmTable {
  kOneCamera,
  kSeveralCameras  ///< with lost_cameras
};

/// The header line of the table, with its line end.
[[nodiscard]] std::string filmTableHeader(FilmTable table);
[[nodiscard]] std::string filmTableLine(const FilmFrame& frame, FilmTable table);

/// No film lasts longer [us]: ten days, as the longest run, and a day for what is before and after
/// it. A tracker whose timers run from frame to frame has done so in a minute.
inline constexpr std::int64_t kLongestFilm_us = 11 * std::int64_t{86'400'000'000};

/// Reads a table. A line that is cut off at the end is left out.
/// @throws CameraError that names the file and the line: of a number that is none; of a time before
///   1970 or after the year 2100; of a camera_utime that does not increase; of an arrived_utime
///   more than kLongestFilm_us after the first
[[nodiscard]] std::vector<FilmFrame> readFilmTable(const std::filesystem::path& file);

/// Merges the frames of the films of several cameras to the order in which the tracker received
/// them. It receives one after the other, and in virtual time those of one instant in the order of
/// the cameras.
/// @param tables of the films, in the order of the cameras
/// @return whose film has the next frame; as many as there are frames
[[nodiscard]] std::vector<std::size_t> orderOfArrival(
    std::span<const std::vector<FilmFrame>> tables);

/// What is known about a film as a whole.
struct FilmFacts {
  std::string camera;            ///< name of one of several cameras; empty: there is only one
  std::string codec;             ///< "ffv1", "ffvhuff", "h264"
  int crf = 0;                   ///< of H.264
  CameraFormat format;           ///< of the camera
  std::int64_t start_utime = 0;  ///< time 0 of the tracker
  std::int64_t first_utime = 0;  ///< of the first frame, in the time of the run
  std::int64_t last_utime = 0;   ///< of the last frame
  std::int64_t frames = 0;       ///< in the film
  std::int64_t lost = 0;         ///< frames that the tracker used, left out: the encoder was busy
  std::int64_t after_end = 0;    ///< frames that the tracker used after the film had ended
  std::int64_t bytes = 0;        ///< of the movie
  double cpu = 0;                ///< [s] processor time of the recording
  bool complete = false;         ///< false: it is being recorded, or the tracker was killed
  std::string problem;           ///< why it ends before the run does; empty: it does not

  [[nodiscard]] bool lossless() const { return codec != "h264"; }
  /// [s] from the first to the last frame
  [[nodiscard]] double duration() const {
    return static_cast<double>(last_utime - first_utime) * 1e-6;
  }
};

/// Replaces the file at once or not at all.
/// @return false if it cannot be written
[[nodiscard]] bool writeFilmFacts(const std::filesystem::path& file, const FilmFacts& facts);

/// @throws ExperimentError that names the file and the key
[[nodiscard]] FilmFacts readFilmFacts(const std::filesystem::path& file);

/// The folders of the films of a run, by start of the tracker, which begins new films when it is
/// restarted. One camera has one film for each start, film, film_2, ...; of several cameras each
/// has its own, film/NAME, sorted by name.
[[nodiscard]] std::vector<std::vector<std::filesystem::path>> filmStarts(
    const std::filesystem::path& run);

/// The same as one list.
[[nodiscard]] std::vector<std::filesystem::path> filmFolders(const std::filesystem::path& run);

/// Makes the folder of the next start of the tracker.
/// @throws std::filesystem::filesystem_error
[[nodiscard]] std::filesystem::path makeFilmFolder(const std::filesystem::path& run);

}  // namespace lab
