#include "sim_svc/emulator/line_faults.hpp"

#include <algorithm>

namespace lab::emulator {
namespace {

constexpr int kFrameBits = 10;  // start, eight data bits (lowest first), stop

/// A byte as levels on the line; the first bit sent is the lowest.
unsigned levels(LineByte byte) {
  return (static_cast<unsigned>(byte.value) << 1U) | (byte.framing_error ? 0U : 1U << 9U);
}

LineByte fromLevels(unsigned bits) {
  return {static_cast<std::uint8_t>((bits >> 1U) & 0xFFU), (bits & (1U << 9U)) == 0};
}

}  // namespace

LineByte sampleAt(LineByte byte, double ratio) {
  const unsigned sent = levels(byte);
  unsigned read = 0;
  for (int bit = 0; bit < kFrameBits; ++bit) {
    const int at = static_cast<int>((bit + 0.5) * ratio + 1.0 / 16);
    // After the frame the line is idle, which is high.
    const bool high = at >= kFrameBits || ((sent >> static_cast<unsigned>(at)) & 1U) != 0;
    if (high) {
      read |= 1U << static_cast<unsigned>(bit);
    }
  }
  return fromLevels(read);
}

bool LineFaults::isOut(std::int64_t at_us) const {
  return std::any_of(settings_.outages.begin(), settings_.outages.end(), [&](const Outage& outage) {
    return at_us >= outage.from_us && at_us < outage.to_us;
  });
}

std::optional<LineByte> LineFaults::pass(std::int64_t at_us, std::uint8_t value, double ratio) {
  if (isOut(at_us)) {
    return std::nullopt;
  }
  LineByte byte{value, false};
  if (settings_.bit_error_rate > 0) {
    unsigned bits = levels(byte);
    for (unsigned bit = 0; bit < kFrameBits; ++bit) {
      if (random_.uniform() < settings_.bit_error_rate) {
        bits ^= 1U << bit;
      }
    }
    if (bits != levels(byte)) {
      ++damaged_;
    }
    if ((bits & 1U) != 0) {
      return std::nullopt;  // no start bit: the receiver does not see the byte
    }
    byte = fromLevels(bits);
  }
  return sampleAt(byte, ratio);
}

}  // namespace lab::emulator
