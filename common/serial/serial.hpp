/// Serial lines to robots, given to a service from outside like its bus and its clock: devices and
/// pseudo terminals in real time, memory in virtual time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/loop/loop.hpp"

namespace lab {

/// A line that cannot be opened or is gone: which, what was found, and the way out.
class SerialError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One end of an open line. Destroying it closes it.
class SerialPort {
 public:
  SerialPort() = default;
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;
  virtual ~SerialPort() = default;

  /// Calls `callback` whenever there is something to read, or the line is gone. The callback may
  /// destroy the port.
  virtual void onReadable(Loop::Callback callback) = 0;

  /// Reads what is there without waiting. @return how many bytes, 0: nothing now.
  /// @throws SerialError when the other end or the device is gone.
  [[nodiscard]] virtual std::size_t read(std::span<std::uint8_t> bytes) = 0;

  /// Writes without waiting. @return how many bytes the line took, possibly fewer than given.
  /// @throws SerialError when the other end or the device is gone.
  [[nodiscard]] virtual std::size_t write(std::span<const std::uint8_t> bytes) = 0;

  /// Whether the other end is open, as far as the line can tell: only an offered one can.
  [[nodiscard]] virtual bool isConnected() const { return true; }
};

/// All lines there are.
class SerialPorts {
 public:
  SerialPorts() = default;
  SerialPorts(const SerialPorts&) = delete;
  SerialPorts& operator=(const SerialPorts&) = delete;
  virtual ~SerialPorts() = default;

  /// The lines that stand-ins offer now, as open() takes them, in order. Real devices are not among
  /// them: opening one resets what hangs on it, so they are only opened by name or pattern.
  [[nodiscard]] virtual std::vector<std::string> offered() const = 0;

  /// The devices that fit a pattern with * and ? ("/dev/serial/by-id/*"), or one of several
  /// separated by spaces: each device once, in order.
  [[nodiscard]] virtual std::vector<std::string> matching(const std::string& pattern) const = 0;

  /// Opens a line for this process alone and forgets what was waiting in it.
  /// @throws SerialError: it does not exist, no permission, in use, no such speed.
  [[nodiscard]] virtual std::unique_ptr<SerialPort> open(const std::string& path, int baud) = 0;

  /// The robot's end of a new line, which open() finds under offered(). It exists until the port is
  /// destroyed. Bytes that nobody reads are lost, as on a cable that is out.
  [[nodiscard]] virtual std::unique_ptr<SerialPort> offer(const std::string& name) = 0;
};

/// No lines at all: for what needs none.
[[nodiscard]] SerialPorts& noSerialPorts();

/// Where services started by hand meet the lines of simulated robots: a folder of this user's.
[[nodiscard]] std::string defaultPortsFolder();

}  // namespace lab
