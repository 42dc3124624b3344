/// A child process whose standard output is read through a pipe.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "common/process/file_descriptor.hpp"

namespace lab::cameras {

/// Ends with this object, with the thread that started it, or by itself. It has no input, and
/// signals from the terminal do not reach it.
class ChildProcess {
 public:
  /// @param command the program, found in PATH, and its arguments
  /// @param for_what "film.mkv: movies are read by": start of the error message if the program is
  ///   not installed
  /// @param package that contains the program, for that message
  /// @throws CameraError if it cannot be started
  ChildProcess(const std::vector<std::string>& command, const std::string& for_what,
               const std::string& package);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Reads until `bytes` is full. @return number of bytes read; fewer only at the end
  [[nodiscard]] std::size_t read(std::span<std::uint8_t> bytes);

  /// Reads the rest of the output.
  [[nodiscard]] std::string readAll();

  /// Waits for its end. @return its exit status, or 128 + signal number
  int finish();

  /// Kills it and its own children, from any thread: read() then returns soon.
  void kill();

  /// The last 4 kB of its standard error.
  [[nodiscard]] std::string errors() const;

  /// The last line of errors(), empty if none.
  [[nodiscard]] std::string lastErrorLine() const;

 private:
  FileDescriptor output_;
  FileDescriptor errors_;  ///< anonymous file for its standard error
  pid_t pid_ = -1;         ///< of the child, and of the process group that it leads
  std::mutex mutex_;       ///< guards status_: a pid that may be reused is never signalled
  int status_ = -1;        ///< below 0: not reaped, the pid is still valid
};

}  // namespace lab::cameras
