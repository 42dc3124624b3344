/// Serial lines in real time: devices, and pseudo terminals for the simulated robots.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/loop/asio_loop.hpp"
#include "common/serial/serial.hpp"

namespace lab {

/// Lines are offered as symbolic links to pseudo terminals, in a folder where any process that is
/// given the folder finds them. Beside each link lies a file that the offering process keeps
/// locked, so that a link that outlived its process leads nobody to a terminal of somebody else.
class SerialDevices final : public SerialPorts {
 public:
  /// @param loop must outlive every port
  /// @param offers the folder of the links; made when the first line is offered
  SerialDevices(AsioLoop& loop, std::filesystem::path offers);
  ~SerialDevices() override;

  [[nodiscard]] std::vector<std::string> offered() const override;
  [[nodiscard]] std::vector<std::string> matching(const std::string& pattern) const override;
  [[nodiscard]] std::unique_ptr<SerialPort> open(const std::string& path, int baud) override;
  /// What a process that crashed left behind under this name is replaced.
  /// @throws SerialError when another process offers this name, or the folder cannot be used.
  [[nodiscard]] std::unique_ptr<SerialPort> offer(const std::string& name) override;

 private:
  class Device;
  class Offer;
  class Cables;

  AsioLoop& loop_;
  std::filesystem::path offers_;
  std::shared_ptr<Cables> cables_;
};

}  // namespace lab
