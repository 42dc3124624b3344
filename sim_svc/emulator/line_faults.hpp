/// Faults of a serial line: wrong bits, an unplugged cable, ends with different speeds.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/math/random.hpp"

namespace lab::emulator {

/// A byte as a receiver sees it.
struct LineByte {
  std::uint8_t value = 0;
  bool framing_error = false;  ///< the stop bit is missing
};

/// The cable is unplugged from `from_us` (included) to `to_us` (not included).
struct Outage {
  std::int64_t from_us = 0;
  std::int64_t to_us = 0;
};

struct LineFaultSettings {
  double bit_error_rate = 0;  ///< of each of the ten bits of a byte
  std::uint64_t seed = 1;
  std::vector<Outage> outages{};
};

/// The byte that a receiver reads if its bits are `ratio` times as long as the sender's. It detects
/// the start bit with a delay of 1/16 bit and then samples the middle of each of its own bits. The
/// byte is correct up to a difference of about 5 %; beyond, the error is deterministic.
[[nodiscard]] LineByte sampleAt(LineByte byte, double ratio);

/// One direction of a line. The same seed gives the same errors.
class LineFaults {
 public:
  LineFaults(const LineFaultSettings& settings, std::uint64_t direction)
      : settings_(settings), random_(settings.seed, direction) {}

  /// The byte that arrives for a byte sent at `at_us`; empty if it is lost.
  [[nodiscard]] std::optional<LineByte> pass(std::int64_t at_us, std::uint8_t value, double ratio);

  [[nodiscard]] bool isOut(std::int64_t at_us) const;

  [[nodiscard]] std::uint64_t damaged() const { return damaged_; }

 private:
  LineFaultSettings settings_;
  Random random_;
  std::uint64_t damaged_ = 0;
};

}  // namespace lab::emulator
