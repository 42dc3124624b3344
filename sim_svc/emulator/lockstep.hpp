/// The chips' side of sim_svc/bodies/chip_link.hpp: packets in, packets out.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim_svc/emulator/emulated_robot.hpp"

namespace lab::emulator {

/// A packet that breaks the protocol: what was found and what was expected.
class LinkError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// All chips of one arena.
class Lockstep {
 public:
  explicit Lockstep(std::shared_ptr<const FirmwareImage> program) : program_(std::move(program)) {}

  /// Obeys one packet. @return the answer to it.
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

/// The packet that says why there will be no further answer.
[[nodiscard]] std::vector<std::uint8_t> failedPacket(const std::string& why);

/// Answers the packets of `socket` until the other end closes it.
/// @return 0 then; 1 after an error, which the other end and stderr were told.
int serveArena(int socket, const std::filesystem::path& elf);

}  // namespace lab::emulator
