/// Movies and pictures on disk, read frame by frame without pacing.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/camera/cameras.hpp"

namespace lab {

inline constexpr double kAssumedFps = 30;  ///< [1/s] rate of pictures without time stamps

/// Reads a recording from beginning to end. Calls block until the frame is decoded.
class FilmReader {
 public:
  FilmReader() = default;
  FilmReader(const FilmReader&) = delete;
  FilmReader& operator=(const FilmReader&) = delete;
  virtual ~FilmReader() = default;

  /// Opens a folder of pictures, a pattern of pictures ("dir/f*.png"), one picture, or a movie
  /// (docs/cameras.md). Movies need the programs ffmpeg and ffprobe.
  /// @param fps [1/s] for pictures: the rate if they have no time stamps, 0: kAssumedFps. For a
  ///   movie: replaces its own time stamps, which are wrong in slow motion; 0: keep them.
  /// @throws CameraError, one line, if it does not exist, is empty, is no movie, or ffmpeg is
  ///   missing; if its pictures have more than 200 million pixels; for a movie of more than 20
  ///   million frames, and one whose times are beyond the year 2100 or 11 days apart
  [[nodiscard]] static std::unique_ptr<FilmReader> open(const std::string& source, double fps = 0);

  /// Reads the next frame. Its number is the number in the picture's name, or the position in the
  /// movie, from 0; its utime counts from the first frame. The view is valid until the next call.
  /// @return false at the end; problem() tells whether the end came early
  [[nodiscard]] virtual bool next(CameraFrame& frame) = 0;

  /// Expected number of frames, 0 if not known.
  [[nodiscard]] virtual std::int64_t length() const = 0;

  /// Size, pixel type and median frame rate; rate 0 if the times are assumed.
  [[nodiscard]] virtual CameraFormat format() const = 0;

  /// Name of the table of time stamps ("frames.csv", "film.frames.csv"), empty if there is none.
  [[nodiscard]] virtual std::string table() const { return ""; }

  /// The orientation mark by which players rotate or mirror the pictures ("rotation 90", "EXIF
  /// orientation 6"), as phones write it; empty if there is none or it is not known. Frames are
  /// returned as stored. Runs ffprobe for JPEG pictures, so it is too slow to call per frame.
  [[nodiscard]] virtual std::string mark() const = 0;

  /// Frames that the recording lacks, up to the current position.
  [[nodiscard]] virtual std::int64_t dropped() const = 0;

  /// Describes a premature end of the recording or unreadable pictures; empty if there was no
  /// problem so far.
  [[nodiscard]] virtual std::string problem() const = 0;
};

/// The arguments by which ffmpeg and ffprobe read a movie on disk, which may come from a stranger.
/// Its name is taken neither for an option nor for a protocol, and it must be in a container of
/// movies: a list of other files or addresses is refused.
/// @throws CameraError if it is no regular file
[[nodiscard]] std::vector<std::string> movieInput(const std::string& file);

}  // namespace lab
