/// Movies and pictures on disk, frame by frame, as fast as they are asked for.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/camera/cameras.hpp"

namespace lab {

inline constexpr double kAssumedFps = 30;  ///< [1/s] of pictures that say nothing of their times

/// A recording that is read from its beginning to its end, waiting where it must.
class FilmReader {
 public:
  FilmReader() = default;
  FilmReader(const FilmReader&) = delete;
  FilmReader& operator=(const FilmReader&) = delete;
  virtual ~FilmReader() = default;

  /// Opens a folder of pictures, a pattern of pictures ("dir/f*.png"), one picture, or a movie
  /// (docs/cameras.md). Movies need the programs ffmpeg and ffprobe.
  /// @param fps [1/s] of pictures that have no times of their own, 0: kAssumedFps; of a movie
  ///   instead of its own times, which a film in slow motion has wrong, 0: its own
  /// @throws CameraError, one line: not there, nothing in it, no movie, ffmpeg is missing.
  [[nodiscard]] static std::unique_ptr<FilmReader> open(const std::string& source, double fps = 0);

  /// The next frame. Its number is that in the picture's name, or the position in a movie, from 0;
  /// its utime counts from the first frame. The view lives until the next call.
  /// @return false at the end; problem() says whether that came early.
  [[nodiscard]] virtual bool next(CameraFrame& frame) = 0;

  /// How many frames there should be, 0: not known.
  [[nodiscard]] virtual std::int64_t length() const = 0;

  /// Size, kind of pixels, and rate: the median one, 0 where the times are not known but assumed.
  [[nodiscard]] virtual CameraFormat format() const = 0;

  /// The table that says when each picture was taken, "frames.csv"; empty: there is none.
  [[nodiscard]] virtual std::string table() const { return ""; }

  /// By what mark players turn or mirror its pictures ("rotation 90", "EXIF orientation 6"), as
  /// phones leave it; empty: none, or not known. Frames come as they are stored. Asks ffprobe of
  /// JPEG pictures: not for every frame.
  [[nodiscard]] virtual std::string mark() const = 0;

  /// Frames that the recording skips, as far as next() has come.
  [[nodiscard]] virtual std::int64_t dropped() const = 0;

  /// What was wrong with the end of the recording, or with pictures in it; empty: nothing so far.
  [[nodiscard]] virtual std::string problem() const = 0;
};

}  // namespace lab
