/// The timing of a chip's serial line, in both directions.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "sim_svc/emulator/line_faults.hpp"

namespace lab::emulator {

/// A byte from the chip's transmitter and the cycle at which its stop bit ends.
struct SentByte {
  std::uint64_t cycle = 0;
  std::uint8_t value = 0;
};

/// Bytes on their way to and from the chip. A byte takes ten bits (start, eight data, stop). Times
/// are in cycles, see Chip.
class ChipUart {
 public:
  // ---- to the chip

  /// Duration of one bit from the other end, which may differ from the chip's.
  void setLineBitCycles(double cycles) { line_bit_cycles_ = cycles; }
  /// The other end sends a byte now, or as soon as the line is free.
  void receive(LineByte byte, std::uint64_t now);
  /// When the next byte has arrived completely; empty if none is on its way.
  [[nodiscard]] std::optional<std::uint64_t> nextArrival() const;
  /// Takes the next byte that has arrived by `now`.
  [[nodiscard]] std::optional<LineByte> takeArrived(std::uint64_t now);
  [[nodiscard]] std::size_t arriving() const { return arriving_.size(); }
  /// When the line to the chip will be free.
  [[nodiscard]] std::uint64_t receivingUntil() const;

  // ---- from the chip

  /// Duration of one bit from the chip's transmitter; 0: not set up.
  void setBitCycles(std::uint64_t cycles) { bit_cycles_ = cycles; }
  [[nodiscard]] std::uint64_t bitCycles() const { return bit_cycles_; }
  /// The chip writes a byte to its transmitter.
  void send(std::uint8_t value, std::uint64_t now);
  /// The transmitter stops: bytes that are not complete by `now` are lost.
  void cutOff(std::uint64_t now);
  /// The bytes whose stop bits ended by `until`.
  [[nodiscard]] std::vector<SentByte> takeSent(std::uint64_t until);

 private:
  struct Arriving {
    double end = 0;  // cycle at which its stop bit ends
    LineByte byte;
  };

  std::deque<Arriving> arriving_;
  double line_bit_cycles_ = 0;
  double line_free_ = 0;  // cycle

  std::deque<SentByte> sent_;
  std::uint64_t bit_cycles_ = 0;
  std::uint64_t transmitter_free_ = 0;  // cycle
};

}  // namespace lab::emulator
