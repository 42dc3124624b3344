/// Opening a serial line for one process alone.
#pragma once

#include <string>

#include "common/process/file_descriptor.hpp"

namespace lab {

/// Opens a serial device or pseudo terminal: without waiting, raw, 8N1, without modem lines, for
/// this process alone, with nothing waiting in it.
/// @throws SerialError, one line: not there, no permission, in use and by whom, no serial device,
/// no such speed.
[[nodiscard]] FileDescriptor openSerialLine(const std::string& path, int baud);

/// Makes the line of an open terminal raw, 8N1, at this speed (0: as it is).
/// @return an errno: ENOTTY no terminal, EINVAL no such speed
[[nodiscard]] int makeRaw(int descriptor, int baud);

/// The process that has the line open, as "minicom (pid 1234)"; empty when there is none, or none
/// that this user may see.
[[nodiscard]] std::string lineHolder(const std::string& path);

}  // namespace lab
