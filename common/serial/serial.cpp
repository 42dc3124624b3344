#include "common/serial/serial.hpp"

#include <unistd.h>

#include <cstdlib>

namespace lab {
namespace {

class NoSerialPorts final : public SerialPorts {
 public:
  [[nodiscard]] std::vector<std::string> offered() const override { return {}; }
  [[nodiscard]] std::vector<std::string> matching(const std::string&) const override { return {}; }
  [[nodiscard]] std::unique_ptr<SerialPort> open(const std::string& path, int) override {
    throw SerialError(path + ": there are no serial lines here");
  }
  [[nodiscard]] std::unique_ptr<SerialPort> offer(const std::string& name) override {
    throw SerialError(name + ": there are no serial lines here");
  }
};

}  // namespace

SerialPorts& noSerialPorts() {
  static NoSerialPorts none;
  return none;
}

std::string defaultPortsFolder() {
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  const bool private_folder = runtime != nullptr && *runtime != 0;
  return private_folder ? std::string(runtime) + "/active-lab-ports"
                        : "/tmp/active-lab-ports-" + std::to_string(getuid());
}

}  // namespace lab
