/// The child process that runs the simulated chips, and its socket.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/process/child_process.hpp"
#include "common/process/file_descriptor.hpp"

namespace lab::sim {

/// robot_emulator as a child that ends with this process. sim_svc/bodies/chip_link.hpp describes
/// the packets.
class EmulatorProcess {
 public:
  /// Starts `program --arena-socket 3`.
  /// @throws std::runtime_error if the program does not exist or no process can be created
  explicit EmulatorProcess(const std::filesystem::path& program);

  /// Sends one packet and waits for the answer.
  /// @param timeout_ms real time, also in virtual time
  /// @throws std::runtime_error (text without the program's name) if it ended or does not answer
  [[nodiscard]] std::span<const std::uint8_t> exchange(std::span<const std::uint8_t> packet,
                                                       int timeout_ms);

  [[nodiscard]] pid_t pid() const { return child_->pid(); }

 private:
  [[nodiscard]] std::string howItEnded();

  FileDescriptor socket_;
  std::optional<ChildProcess> child_;  ///< killed by its destructor
  std::vector<std::uint8_t> answer_;
};

}  // namespace lab::sim
