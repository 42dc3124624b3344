/// ffmpeg, to which pictures are written through a pipe.
#pragma once

#include <csignal>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/process/child_process.hpp"
#include "common/process/file_descriptor.hpp"
#include "common/process/output_tail.hpp"

namespace lab::cameras {

/// Encodes what is written to its standard input. It may outlive this process: if that is killed,
/// the encoder completes its file with what it has.
class EncoderProcess {
 public:
  /// @param command the program, found in PATH, and its arguments
  /// @throws CameraError if it cannot be started
  explicit EncoderProcess(const std::vector<std::string>& command);
  ~EncoderProcess();
  EncoderProcess(const EncoderProcess&) = delete;
  EncoderProcess& operator=(const EncoderProcess&) = delete;

  /// Blocks until all bytes are written. @return false if the encoder has ended
  [[nodiscard]] bool write(std::span<const std::uint8_t> bytes);

  /// Ends its input and waits for its end. @return its exit status, or 128 + signal number
  int finish();

  /// Kills it, from any thread: write() and finish() then return soon.
  void kill() { child_->signal(SIGKILL); }

  /// [s] processor time so far; 0 after finish()
  [[nodiscard]] double cpu() const;

  /// The first line of its errors, empty if none.
  [[nodiscard]] std::string errorLine() const;

 private:
  FileDescriptor input_;
  OutputTail errors_{4096};
  std::optional<ChildProcess> child_;
};

}  // namespace lab::cameras
