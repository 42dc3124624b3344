/// Serial lines inside one process, for virtual time and for tests.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/serial/serial.hpp"

namespace lab {

/// Lines without delay: a writer that simulates the speed of a real line must pace itself. Both
/// ends behave as those of a pseudo terminal (serial_devices.hpp), with the same callbacks and
/// errors.
class MemorySerial final : public SerialPorts {
 public:
  /// @param loop must outlive every port
  explicit MemorySerial(Loop& loop) : loop_(loop) {}

  [[nodiscard]] std::vector<std::string> offered() const override;
  /// Matches offered lines, because there are no devices in memory.
  [[nodiscard]] std::vector<std::string> matching(const std::string& pattern) const override;
  [[nodiscard]] std::unique_ptr<SerialPort> open(const std::string& path, int baud) override;
  /// @throws SerialError if a line of this name exists
  [[nodiscard]] std::unique_ptr<SerialPort> offer(const std::string& name) override;

  /// The capacity of each end's receive queue [bytes], as that of a terminal.
  static constexpr std::size_t kCapacity = 4096;

 private:
  struct Line;
  class RobotEnd;
  class HostEnd;

  Loop& loop_;
  std::map<std::string, std::weak_ptr<Line>> lines_;
};

}  // namespace lab
