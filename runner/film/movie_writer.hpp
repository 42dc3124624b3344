/// A movie made by the program ffmpeg, fed picture by picture.
#pragma once

#include <sys/types.h>

#include <filesystem>

#include "light/optics/rgb_image.hpp"

namespace lab::runner {

class MovieWriter {
 public:
  /// Starts ffmpeg: H.264 for .mp4 and .mkv, MJPEG for .avi.
  /// @param file the movie; replaced where it is there
  /// @param width, height of all its pictures [px]
  /// @throws UserError when ffmpeg is not installed.
  MovieWriter(std::filesystem::path file, int width, int height, double fps);

  /// Ends ffmpeg; a movie that was not finished is not worth keeping.
  ~MovieWriter();
  MovieWriter(const MovieWriter&) = delete;
  MovieWriter& operator=(const MovieWriter&) = delete;

  /// @throws std::runtime_error with what ffmpeg said when it has ended.
  void write(const tracker::RgbImage& image);

  /// Waits until the movie is complete. @throws std::runtime_error when ffmpeg failed.
  void finish();

 private:
  [[nodiscard]] int wait();
  [[noreturn]] void fail();

  std::filesystem::path file_;
  int input_ = -1;     ///< ffmpeg's stdin
  int messages_ = -1;  ///< what it said
  pid_t pid_ = -1;
};

/// Whether a program is on the PATH.
[[nodiscard]] bool isInstalled(const char* program);

}  // namespace lab::runner
