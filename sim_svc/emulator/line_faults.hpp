/// What a serial line does to bytes: wrong bits, a cable that is out, two ends at different speeds.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/math/random.hpp"

namespace lab::emulator {

/// A byte as a receiver takes it from the line.
struct LineByte {
  std::uint8_t value = 0;
  bool framing_error = false;  ///< its stop bit was not there
};

/// The cable is out from `from_us` (included) to `to_us` (not included).
struct Outage {
  std::int64_t from_us = 0;
  std::int64_t to_us = 0;
};

struct LineFaultSettings {
  double bit_error_rate = 0;  ///< of each of the ten bits of a byte
  std::uint64_t seed = 1;
  std::vector<Outage> outages{};
};

/// What a receiver reads whose bits are `ratio` times as long as the sender's: it finds the start
/// bit, with 1/16 bit of delay, and then samples the middle of each of its own bits. Right up to
/// about 5 % either way, the same garbage every time beyond.
[[nodiscard]] LineByte sampleAt(LineByte byte, double ratio);

/// One direction of a line. The same seed makes the same errors.
class LineFaults {
 public:
  LineFaults(const LineFaultSettings& settings, std::uint64_t direction)
      : settings_(settings), random_(settings.seed, direction) {}

  /// What becomes of a byte at `at_us`; nothing when it is lost.
  [[nodiscard]] std::optional<LineByte> pass(std::int64_t at_us, std::uint8_t value, double ratio);

  [[nodiscard]] bool isOut(std::int64_t at_us) const;

  [[nodiscard]] std::uint64_t damaged() const { return damaged_; }

 private:
  LineFaultSettings settings_;
  Random random_;
  std::uint64_t damaged_ = 0;
};

}  // namespace lab::emulator
