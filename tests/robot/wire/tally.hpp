/// Counts how a decoder handles damaged frames, and computes how many it may accept by chance.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include "robot/wire/schema.hpp"
#include "tests/robot/wire/frames.hpp"

namespace lab::wire {

/// A 16-bit CRC accepts one random content in this number.
constexpr double kCrcValues = 65536;

/// The smallest k such that a Poisson count with this mean exceeds k with a probability below 1e-9.
inline std::uint64_t poissonLimit(double mean) {
  double term = std::exp(-mean);
  if (term == 0) return static_cast<std::uint64_t>(mean + 6.5 * std::sqrt(mean));
  double above = 1 - term;
  std::uint64_t k = 0;
  while (above > 1e-9) {
    ++k;
    term *= mean / static_cast<double>(k);
    above -= term;
  }
  return k;
}

/// Results for damaged frames.
struct Tally {
  std::uint64_t tried = 0;    ///< patterns, sequences or frames
  std::uint64_t checked = 0;  ///< CRC checks of contents that were never sent
  std::uint64_t wrong = 0;    ///< checks that accepted a frame

  /// Largest plausible number of wrong frames if each check passes with a probability of 2^-bits.
  std::uint64_t limit(double bits = 16) const {
    return poissonLimit(static_cast<double>(checked) / std::exp2(bits));
  }

  void print(const std::string& what) const {
    std::cout << std::setw(36) << std::left << what << std::right << std::setw(11) << tried
              << " tried " << std::setw(10) << checked << " CRCs checked " << std::setw(5) << wrong
              << " wrong (2^-16 of the checks: " << std::fixed << std::setprecision(1)
              << static_cast<double>(checked) / kCrcValues << ", limit " << limit() << ")\n";
  }
};

/// Number of CRC checks of the decoder, modulo 65536. Lengths and versions are checked after the
/// CRC; the few frames that fail there are not counted.
inline std::uint16_t crcChecks(const Decoder& decoder) {
  return static_cast<std::uint16_t>(decoder.counts().crc + decoder.counts().frames);
}

/// Passes the damaged bytes of a frame to the decoder, and the 0 that begins the next frame.
inline void spoil(Decoder& decoder, const Frame& sent, const Bytes& bytes, Tally& tally) {
  const std::uint16_t before = crcChecks(decoder);
  std::uint16_t right = 0;
  const auto look = [&](std::uint8_t byte) {
    if (!decoder.push(byte)) return;
    if (decoder.frame() == sent) {
      ++right;
    } else {
      ++tally.wrong;
    }
  };
  for (const std::uint8_t byte : bytes) look(byte);
  look(0);
  ++tally.tried;
  tally.checked += static_cast<std::uint16_t>(crcChecks(decoder) - before - right);
}

/// Sets the fields to realistic values: small counts with many zeros, and arbitrary bytes.
struct SetDrawn {
  Draws& draws;
  template <class Integer>
  void operator()(Integer& value) const {
    const std::uint64_t bits = draws.bits();
    value = static_cast<Integer>((bits & 3U) == 0 ? bits >> 8 : (bits >> 8) & 0xFFFFU);
  }
  template <std::uint8_t N>
  void counts10(std::uint16_t (&values)[N]) const {
    for (auto& value : values) value = static_cast<std::uint16_t>(draws.bits() & 1023U);
  }
};

/// A frame of every type, with random values.
inline std::vector<Frame> drawnFrames(Draws& draws) {
  std::vector<Frame> frames;
  forEachMessage([&](const char*, auto message) {
    const SetDrawn set{draws};
    decltype(message)::fields(message, set);
    frames.emplace_back();
    pack(message, draws.byte(), frames.back());
  });
  return frames;
}

/// Number of tries, from the environment; the long tests use more.
inline std::uint64_t triesOr(std::uint64_t otherwise) {
  const char* text = std::getenv("LAB_WIRE_TRIES");
  return text == nullptr ? otherwise : std::stoull(text);
}

}  // namespace lab::wire
