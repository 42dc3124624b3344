/// A program that runs beside this one and writes into a pipe.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "common/serial/serial_line.hpp"

namespace lab::cameras {

/// Ends with this object, with the thread that began it, or by itself. It has no input, and a
/// signal from the terminal does not reach it.
class ChildProcess {
 public:
  /// @param command the program, looked for in PATH, and its arguments
  /// @param for_what "film.mkv: movies are read by": begins the message when it is not installed
  /// @param package that brings the program, for the message
  /// @throws CameraError when it cannot be started.
  ChildProcess(const std::vector<std::string>& command, const std::string& for_what,
               const std::string& package);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Waits for as many bytes as fit. @return how many there were: fewer only at the end.
  [[nodiscard]] std::size_t read(std::span<std::uint8_t> bytes);

  /// All that is still to come.
  [[nodiscard]] std::string readAll();

  /// Waits for its end. @return its exit status, 128 + signal when a signal ended it.
  int finish();

  /// Ends it, and what it has begun itself, from any thread: read() then returns soon.
  void kill();

  /// What it wrote to its standard error, the last 4 kB of it.
  [[nodiscard]] std::string errors() const;

  /// The last line of errors(); empty: none.
  [[nodiscard]] std::string lastErrorLine() const;

 private:
  FileDescriptor output_;
  FileDescriptor errors_;  ///< memory that takes its standard error
  pid_t pid_ = -1;         ///< of it and of the group that it leads
  std::mutex mutex_;       ///< of status_: nobody is killed by a number that is free again
  int status_ = -1;        ///< below 0: its number is still its own
};

}  // namespace lab::cameras
