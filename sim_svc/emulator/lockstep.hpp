/// The emulator's side of the protocol in sim_svc/bodies/chip_link.hpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim_svc/emulator/emulated_robot.hpp"

namespace lab::emulator {

/// A packet that violates the protocol; the text says what was found and expected.
class LinkError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// All chips of one arena.
class Lockstep {
 public:
  explicit Lockstep(std::shared_ptr<const FirmwareImage> program) : program_(std::move(program)) {}

  /// Executes one packet. @return the answer
  /// @throws LinkError
  [[nodiscard]] std::vector<std::uint8_t> answer(std::span<const std::uint8_t> packet);

 private:
  class Reader;

  void setUp(Reader& reader, std::uint32_t robots, std::int64_t now_us);
  void step(Reader& reader, std::int64_t until_us);
  [[nodiscard]] std::vector<std::uint8_t> outputs(std::int64_t until_us);

  std::shared_ptr<const FirmwareImage> program_;
  std::vector<std::unique_ptr<EmulatedRobot>> robots_;
  bool set_up_ = false;
};

/// The packet with the reason why there will be no further answers.
[[nodiscard]] std::vector<std::uint8_t> failedPacket(const std::string& why);

/// Answers the packets from `socket` until the other end closes it.
/// @return exit code: 0, or 1 after an error, which is sent to the other end and to stderr
int serveArena(int socket, const std::filesystem::path& elf);

}  // namespace lab::emulator
