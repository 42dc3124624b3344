/// Writes a movie by a pipe to the program ffmpeg.
#pragma once

#include <filesystem>
#include <optional>

#include "common/files/atomic_file.hpp"
#include "common/process/child_process.hpp"
#include "common/process/file_descriptor.hpp"
#include "light/optics/rgb_image.hpp"

namespace lab::runner {

/// The movie has its name when it is complete. Until then it is .NAME.part.mp4 beside it.
class MovieWriter {
 public:
  static constexpr int kMostPixels = 16384;  ///< width and height that H.264 takes

  /// Starts ffmpeg: H.264 for .mp4 and .mkv, MJPEG for .avi.
  /// @param file the movie; an existing file is replaced
  /// @param width, height size of all pictures [px] @param fps frame rate [1/s]
  /// @throws UserError if ffmpeg is not installed, or for pictures that are too large
  MovieWriter(const std::filesystem::path& file, int width, int height, double fps);

  /// Kills ffmpeg and removes the part if finish() was not called.
  ~MovieWriter();
  MovieWriter(const MovieWriter&) = delete;
  MovieWriter& operator=(const MovieWriter&) = delete;

  /// @throws std::runtime_error with ffmpeg's message if ffmpeg has ended
  void write(const optics::RgbImage& image);

  /// Waits until the movie is complete. @throws std::runtime_error if it could not be written
  void finish();

 private:
  void wait();
  [[noreturn]] void fail();

  AtomicFile file_;
  FileDescriptor input_;     ///< standard input of ffmpeg
  FileDescriptor messages_;  ///< temporary file with ffmpeg's standard error
  std::optional<ChildProcess> child_;
};

/// Whether an executable file with this name is in $PATH.
[[nodiscard]] bool isInstalled(const char* program);

}  // namespace lab::runner
