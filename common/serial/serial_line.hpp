/// Opening a serial line exclusively.
#pragma once

#include <string>

#include "common/process/file_descriptor.hpp"

namespace lab {

/// Opens a serial device or pseudo terminal exclusively: non-blocking, raw, 8N1, without modem
/// control lines. Discards received bytes.
/// @throws SerialError with one line if it does not exist, is in use (and by whom), is no serial
///   device, does not support the speed, or permission is missing
[[nodiscard]] FileDescriptor openSerialLine(const std::string& path, int baud);

/// Sets an open terminal to raw, 8N1, at this speed (0: keep the speed).
/// @return 0 or an errno: ENOTTY no terminal, EINVAL speed not supported
[[nodiscard]] int makeRaw(int descriptor, int baud);

/// The first of the names, which are separated by spaces, that leads to something other than a
/// terminal; empty if there is none. It opens nothing. Patterns (with * ? [ or \) are not looked
/// up, because that may take long: what they match is refused when it is opened.
[[nodiscard]] std::string firstThatIsNoTerminal(const std::string& names);

/// The process that has opened the line, as "minicom (pid 1234)"; empty if there is none, or none
/// that is visible to this user.
[[nodiscard]] std::string lineHolder(const std::string& path);

}  // namespace lab
