/// ffmpeg, ffprobe or gst-launch-1.0, whose output is read through a pipe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/process/child_process.hpp"
#include "common/process/file_descriptor.hpp"
#include "common/process/output_tail.hpp"

namespace lab::cameras {

/// Ends with this object, with the thread that started it, or by itself. It has no input, and
/// signals from the terminal do not reach it.
class MediaProcess {
 public:
  /// @param command the program, found in PATH, and its arguments
  /// @param for_what "film.mkv: movies are read by": start of the error message if the program is
  ///   not installed
  /// @param package that contains the program, for that message
  /// @throws CameraError if it cannot be started
  MediaProcess(const std::vector<std::string>& command, const std::string& for_what,
               const std::string& package);
  ~MediaProcess();
  MediaProcess(const MediaProcess&) = delete;
  MediaProcess& operator=(const MediaProcess&) = delete;

  /// Reads until `bytes` is full. @return number of bytes read; fewer only at the end
  [[nodiscard]] std::size_t read(std::span<std::uint8_t> bytes);

  /// Reads the rest of the output.
  [[nodiscard]] std::string readAll();

  /// Waits for its end. @return its exit status, or 128 + signal number
  int finish();

  /// Kills it and its own children, from any thread: read() then returns soon.
  void kill();

  /// The last 4 kB of its standard error.
  [[nodiscard]] std::string errors() const { return errors_.text(); }

  /// The last line of errors(), empty if none.
  [[nodiscard]] std::string lastErrorLine() const;

 private:
  FileDescriptor output_;
  OutputTail errors_{4096};
  std::optional<ChildProcess> child_;
};

}  // namespace lab::cameras
