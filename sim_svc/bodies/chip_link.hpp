/// The protocol between sim_svc (the arena) and robot_emulator (the simulated chips).
///
/// The socket is a SOCK_SEQPACKET pair on one machine: one packet per message, without losses or
/// reordering. The arena sends SETUP once, then STEP repeatedly; each is answered by one packet.
/// Nothing runs between an answer and the next STEP, so arena and chips are in lockstep, in real
/// time and in virtual time.
///
/// Packets consist of the plain structs below, in the machine's byte order.
#pragma once

#include <cstdint>

namespace lab::chip {

/// The file descriptor that robot_emulator --arena-socket inherits.
inline constexpr int kArenaSocket = 3;

inline constexpr std::uint32_t kLinkVersion = 1;
inline constexpr std::size_t kLargestPacket = 128 * 1024;

enum class Packet : std::uint32_t {
  kSetup = 1,
  kStep = 2,
  kReady = 11,
  kStepped = 12,
  kFailed = 13
};

/// The start of every packet. After kFailed the rest of the packet is a text with the reason.
struct Header {
  std::uint32_t version = kLinkVersion;
  Packet packet = Packet::kStep;
  std::int64_t until_us = 0;  ///< SETUP: the arena's time now; STEP: run the chips until then
  std::uint32_t robots = 0;   ///< number of entries that follow: all robots in the order of SETUP
  std::uint32_t reserved = 0;
};

/// Entry of SETUP for each robot, followed by eeprom_size bytes of its EEPROM from address 0 (the
/// rest is blank).
struct ChipSetup {
  std::int32_t id = 0;
  std::uint32_t eeprom_size = 0;
  std::int64_t boot_us = 0;  ///< when it is switched on, on the arena's clock
  double clock_rate = 1;     ///< of its oscillator relative to the arena's clock
};

/// Entry of STEP for each robot, followed by rx_size bytes that the host has sent. They reach the
/// chip at the line's speed.
struct ChipInput {
  std::uint16_t ir[6] = {};       ///< counts 0..1023 with the emitters on
  std::uint16_t light_front = 0;  ///< counts
  std::uint16_t light_back = 0;   ///< counts
  std::uint32_t rx_size = 0;
};

enum class ChipState : std::uint8_t {
  kOff = 0,  ///< not yet switched on
  kRunning = 1,
  kCrashed = 2,  ///< it sleeps with interrupts off, or left the program memory
};

/// Entry of STEPPED for each robot, followed by `changes` WheelChange and by tx_size bytes that the
/// robot has sent.
struct ChipOutput {
  ChipState state = ChipState::kOff;
  std::uint8_t reserved[3] = {};
  std::uint32_t resets = 0;  ///< since SETUP
  std::uint32_t changes = 0;
  std::uint32_t tx_size = 0;
};

/// The motor duties from this time on, decoded from pins and timers: signed duty -255..255; 0 with
/// the driver in standby.
struct WheelChange {
  std::int64_t at_us = 0;  ///< on the arena's clock, within the step
  std::int16_t left = 0;
  std::int16_t right = 0;
  std::uint32_t reserved = 0;
};

}  // namespace lab::chip
