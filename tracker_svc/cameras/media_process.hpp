/// ffmpeg, ffprobe or gst-launch-1.0, whose output is read through a pipe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
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

  /// The longest text that readAll() returns, and the longest line of readLines() [byte].
  static constexpr std::size_t kMostAnswerBytes = 1'000'000;

  /// Reads the rest of the output.
  /// @throws CameraError if it is longer than kMostAnswerBytes
  [[nodiscard]] std::string readAll();

  /// Reads the rest of the output line by line, and keeps one line at a time.
  /// @param take gets each line without its end; false: no more is read. finish() would then wait
  ///   for a process that goes on writing
  /// @throws CameraError if a line is longer than kMostAnswerBytes
  void readLines(const std::function<bool(std::string_view)>& take);

  /// Waits for its end. @return its exit status, or 128 + signal number
  int finish();

  /// Kills it and its own children, from any thread: read() then returns soon.
  void kill();

  /// The last 4 kB of its standard error.
  [[nodiscard]] std::string errors() const { return errors_.text(); }

  /// The last line of errors(), empty if none.
  [[nodiscard]] std::string lastErrorLine() const;

 private:
  void readPieces(const std::function<bool(std::string_view)>& take);
  void requireFew(std::size_t bytes, const char* what) const;

  std::string reader_;  ///< "film.mkv: movies are read by ffprobe"
  FileDescriptor output_;
  OutputTail errors_{4096};
  std::optional<ChildProcess> child_;
};

}  // namespace lab::cameras
