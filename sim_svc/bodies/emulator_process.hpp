/// The process that runs the simulated chips, and the socket to it.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace lab::sim {

/// robot_emulator as a child that ends with this process. Packets as in
/// sim_svc/bodies/chip_link.hpp.
class EmulatorProcess {
 public:
  /// Starts `program --arena-socket 3`.
  /// @throws std::runtime_error: no such program, or no process can be made
  explicit EmulatorProcess(const std::filesystem::path& program);

  /// Ends it at once.
  ~EmulatorProcess();
  EmulatorProcess(const EmulatorProcess&) = delete;
  EmulatorProcess& operator=(const EmulatorProcess&) = delete;

  /// Sends one packet and waits for the one that answers it.
  /// @param patience_ms real time, also where the lab's time is simulated
  /// @throws std::runtime_error, without naming the program: it ended, it does not answer
  [[nodiscard]] std::span<const std::uint8_t> exchange(std::span<const std::uint8_t> packet,
                                                       int patience_ms);

  [[nodiscard]] pid_t pid() const { return pid_; }

 private:
  [[nodiscard]] std::string howItEnded();

  int socket_ = -1;
  pid_t pid_ = -1;
  std::vector<std::uint8_t> answer_;
};

}  // namespace lab::sim
