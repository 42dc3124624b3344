/// Movies, read by the program ffmpeg as a child process.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tracker_svc/film_reader.hpp"

namespace lab::cameras {

/// What ffprobe says of a movie or a network camera.
struct MovieInfo {
  int width = 0;
  int height = 0;
  double fps = 0;                    ///< [1/s] mean rate as the file claims it, 0: not known
  std::string pixels;                ///< "gray (ffv1)"
  bool compressed = false;           ///< as CameraFormat has it
  bool grey = false;                 ///< one channel: needs no mixing
  int rotation = 0;                  ///< [deg] by which players turn it
  std::int64_t claimed = 0;          ///< frames by the file's own header, 0: it does not say
  std::int64_t never_shown = 0;      ///< of them, as in a film that was cut without decoding it
  std::vector<std::int64_t> utimes;  ///< [us] of each frame since the first, in order
  std::string warning;               ///< what ffprobe found wrong on the way
};

/// Asks ffprobe. @param packets whether to go through the whole file for the times of its frames
/// @throws CameraError: no such file, no movie, no ffprobe.
[[nodiscard]] MovieInfo probeMovie(const std::string& source, bool packets);

/// The command that decodes it to grey bytes or RGB on its output, every frame once.
[[nodiscard]] std::vector<std::string> decodeCommand(const std::string& source, bool grey);

/// @throws CameraError as FilmReader::open()
[[nodiscard]] std::unique_ptr<FilmReader> openMovie(const std::string& source, double fps);

}  // namespace lab::cameras
