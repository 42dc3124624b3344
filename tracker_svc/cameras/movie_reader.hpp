/// Movies, read by the program ffmpeg as a child process.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tracker_svc/film_reader.hpp"

namespace lab::cameras {

/// Result of ffprobe for a movie or a network camera.
struct MovieInfo {
  int width = 0;
  int height = 0;
  double fps = 0;            ///< [1/s] mean rate stated by the file, 0 if unknown
  std::string pixels;        ///< "gray (ffv1)"
  bool compressed = false;   ///< as in CameraFormat
  bool grey = false;         ///< one channel: needs no conversion
  int rotation = 0;          ///< [deg] rotation applied by players
  std::int64_t claimed = 0;  ///< number of frames in the file's header, 0 if not stated
  /// number of those that are not displayed, as in a movie cut without re-encoding
  std::int64_t never_shown = 0;
  std::vector<std::int64_t> utimes;  ///< [us] of each frame since the first, in order
  std::string time_problem;          ///< what is wrong with `utimes`, as PacketTimes::problem()
  std::string warning;               ///< a problem that ffprobe reported
};

/// As lab::movieInput().
[[nodiscard]] std::vector<std::string> inputOfMovie(const std::string& file);

/// Runs ffprobe.
/// @param most_packets reads the whole file for the times of its frames, at most so many
///   (kMostPackets); 0: does not read it
/// @throws CameraError if there is no such file, it is no movie, its pictures are larger than
///   kMostPicturePixels, it has more packets, or ffprobe is missing
[[nodiscard]] MovieInfo probeMovie(const std::string& source, std::size_t most_packets);

/// The command that decodes every frame once, to grey or RGB bytes on its output.
[[nodiscard]] std::vector<std::string> decodeCommand(const std::string& source, bool grey);

/// @throws CameraError as FilmReader::open()
[[nodiscard]] std::unique_ptr<FilmReader> openMovie(const std::string& source, double fps);

}  // namespace lab::cameras
