/// Writes a movie by a pipe to the program ffmpeg.
#pragma once

#include <sys/types.h>

#include <filesystem>

#include "light/optics/rgb_image.hpp"

namespace lab::runner {

class MovieWriter {
 public:
  /// Starts ffmpeg: H.264 for .mp4 and .mkv, MJPEG for .avi.
  /// @param file the movie; an existing file is replaced
  /// @param width, height size of all pictures [px] @param fps frame rate [1/s]
  /// @throws UserError if ffmpeg is not installed
  MovieWriter(std::filesystem::path file, int width, int height, double fps);

  /// Kills ffmpeg if finish() was not called.
  ~MovieWriter();
  MovieWriter(const MovieWriter&) = delete;
  MovieWriter& operator=(const MovieWriter&) = delete;

  /// @throws std::runtime_error with ffmpeg's message if ffmpeg has ended
  void write(const optics::RgbImage& image);

  /// Waits until the movie is complete. @throws std::runtime_error if ffmpeg failed
  void finish();

 private:
  [[nodiscard]] int wait();
  [[noreturn]] void fail();

  std::filesystem::path file_;
  int input_ = -1;     ///< standard input of ffmpeg
  int messages_ = -1;  ///< temporary file with ffmpeg's standard error
  pid_t pid_ = -1;
};

/// Whether an executable file with this name is in $PATH.
[[nodiscard]] bool isInstalled(const char* program);

}  // namespace lab::runner
