/// Pipes.
#pragma once

#include "common/process/file_descriptor.hpp"

namespace lab {

/// Both ends are closed by exec.
struct Pipe {
  FileDescriptor out;  ///< to read from
  FileDescriptor in;   ///< to write to
};

/// @throws std::system_error if no file descriptor is left
[[nodiscard]] Pipe makePipe();

}  // namespace lab
