/// Serial lines in real time: devices, and pseudo terminals for the simulated robots.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/loop/asio_loop.hpp"
#include "common/serial/serial.hpp"

namespace lab {

/// Lines are offered as symbolic links to pseudo terminals in a folder. Next to each link is a lock
/// file that the offering process keeps locked. A link that outlived its process is recognised by
/// its unlocked file, because its terminal may by now belong to another program. A folder of
/// another user, who could lead to any device, is not used.
class SerialDevices final : public SerialPorts {
 public:
  /// @param loop must outlive every port
  /// @param offers the folder of the links; created when the first line is offered
  SerialDevices(AsioLoop& loop, std::filesystem::path offers);
  ~SerialDevices() override;

  [[nodiscard]] std::vector<std::string> offered() const override;
  [[nodiscard]] std::vector<std::string> matching(const std::string& pattern) const override;
  [[nodiscard]] std::unique_ptr<SerialPort> open(const std::string& path, int baud) override;
  /// Replaces a link that a crashed process left behind.
  /// @throws SerialError if another process offers this name, or the folder cannot be used
  [[nodiscard]] std::unique_ptr<SerialPort> offer(const std::string& name) override;

 private:
  class Device;
  class Offer;
  class PtyMonitor;

  AsioLoop& loop_;
  std::filesystem::path offers_;
  std::shared_ptr<PtyMonitor> monitor_;
};

}  // namespace lab
