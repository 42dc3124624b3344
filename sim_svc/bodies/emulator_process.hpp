/// The child process that runs the simulated chips, and its socket.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace lab::sim {

/// robot_emulator as a child that ends with this process. sim_svc/bodies/chip_link.hpp describes
/// the packets.
class EmulatorProcess {
 public:
  /// Starts `program --arena-socket 3`.
  /// @throws std::runtime_error if the program does not exist or no process can be created
  explicit EmulatorProcess(const std::filesystem::path& program);

  /// Kills the process.
  ~EmulatorProcess();
  EmulatorProcess(const EmulatorProcess&) = delete;
  EmulatorProcess& operator=(const EmulatorProcess&) = delete;

  /// Sends one packet and waits for the answer.
  /// @param timeout_ms real time, also in virtual time
  /// @throws std::runtime_error (text without the program's name) if it ended or does not answer
  [[nodiscard]] std::span<const std::uint8_t> exchange(std::span<const std::uint8_t> packet,
                                                       int timeout_ms);

  [[nodiscard]] pid_t pid() const { return pid_; }

 private:
  [[nodiscard]] std::string howItEnded();

  int socket_ = -1;
  pid_t pid_ = -1;
  std::vector<std::uint8_t> answer_;
};

}  // namespace lab::sim
