/// Interface for serial lines to robots. A service gets it from outside, like its bus and its
/// clock: devices and pseudo terminals in real time, memory in virtual time.
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

/// A line that cannot be opened or is gone. what() names it, what was found, and what to do.
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

  /// Calls `callback` whenever there are bytes to read or the line is gone. The callback may
  /// destroy the port.
  virtual void onReadable(Loop::Callback callback) = 0;

  /// Reads without waiting.
  /// @return the number of bytes read, 0 if none is available
  /// @throws SerialError if the other end or the device is gone
  [[nodiscard]] virtual std::size_t read(std::span<std::uint8_t> bytes) = 0;

  /// Writes without waiting.
  /// @return the number of bytes written, possibly fewer than given
  /// @throws SerialError if the other end or the device is gone
  [[nodiscard]] virtual std::size_t write(std::span<const std::uint8_t> bytes) = 0;

  /// Whether the other end is open. Only an offered line can tell; others return true.
  [[nodiscard]] virtual bool isConnected() const { return true; }
};

/// The serial lines that a process can use.
class SerialPorts {
 public:
  SerialPorts() = default;
  SerialPorts(const SerialPorts&) = delete;
  SerialPorts& operator=(const SerialPorts&) = delete;
  virtual ~SerialPorts() = default;

  /// The sorted names of the lines that simulated robots offer now, for open(). Real devices are
  /// not included: opening one resets the attached robot, so they are opened only by name or
  /// pattern.
  [[nodiscard]] virtual std::vector<std::string> offered() const = 0;

  /// The devices that match a pattern with * and ? ("/dev/serial/by-id/*"), or one of several
  /// patterns separated by spaces. Each device once, sorted.
  [[nodiscard]] virtual std::vector<std::string> matching(const std::string& pattern) const = 0;

  /// Opens a line exclusively and discards received bytes.
  /// @throws SerialError if it does not exist, is in use or does not support the speed, or if
  ///   permission is missing
  [[nodiscard]] virtual std::unique_ptr<SerialPort> open(const std::string& path, int baud) = 0;

  /// Creates a line, listed by offered() until the returned port is destroyed, and returns the
  /// robot's end. Bytes written while no host reads are lost, as on an unplugged cable.
  [[nodiscard]] virtual std::unique_ptr<SerialPort> offer(const std::string& name) = 0;
};

/// Serial lines for services that use none; open() and offer() throw.
[[nodiscard]] SerialPorts& noSerialPorts();

/// The folder of the lines of simulated robots for services that are started by hand; one per user.
[[nodiscard]] std::string defaultPortsFolder();

}  // namespace lab
