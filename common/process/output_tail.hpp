/// The end of what a child process prints.
#pragma once

#include <cstddef>
#include <string>

#include "common/process/file_descriptor.hpp"

namespace lab {

/// Reads a pipe and keeps its last bytes. However much a child prints, memory stays bounded; a
/// child that prints faster than take() is called waits.
class OutputTail {
 public:
  /// @param most [byte] that are kept
  explicit OutputTail(std::size_t most) : most_(most) {}

  /// Reads from this pipe from now on, and forgets the text.
  void open(FileDescriptor pipe);
  void close() { pipe_ = FileDescriptor(); }

  /// Takes what has arrived, without waiting.
  void take();

  /// The descriptor of the pipe, readable when take() has something to do; -1 after its end.
  [[nodiscard]] int descriptor() const { return pipe_.get(); }

  /// At most the last `most` bytes.
  [[nodiscard]] std::string text() const;

 private:
  std::size_t most_;
  FileDescriptor pipe_;
  std::string kept_;  ///< less than twice as long as `most_`
};

}  // namespace lab
