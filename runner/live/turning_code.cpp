#include "runner/live/turning_code.hpp"

#include <bit>

namespace lab::runner {
namespace {

constexpr std::uint32_t kAlternating = 0x55555555;
constexpr int kFewestDataBits = 4;  // shorter words have too few reversals

/// Bit p of a word is the position p of Hamming's code: the parities are at powers of two, the
/// parity of the whole word is at 0, data are at the other positions.
std::uint32_t extendedHammingWord(std::uint32_t data) {
  std::uint32_t word = 0;
  std::uint32_t syndrome = 0;
  for (std::uint32_t position = 3; data != 0; ++position) {
    if (std::has_single_bit(position)) continue;
    if ((data & 1) != 0) {
      word |= 1U << position;
      syndrome ^= position;
    }
    data >>= 1;
  }
  for (std::uint32_t parity = 1; parity <= syndrome; parity <<= 1) {
    if ((syndrome & parity) != 0) word |= 1U << parity;
  }
  return word | (static_cast<std::uint32_t>(std::popcount(word)) & 1);
}

int lengthOf(int data_bits) {
  int position = 2;
  while (data_bits > 0) {
    if (!std::has_single_bit(static_cast<unsigned>(++position))) --data_bits;
  }
  return position + 1;
}

int reversals(std::uint32_t word, int rounds) {
  const std::uint32_t changes = (word ^ (word >> 1)) & ((1U << (rounds - 1)) - 1);
  return std::popcount(changes);
}

}  // namespace

TurningCode turningCode(std::size_t robots) {
  for (int data_bits = kFewestDataBits;; ++data_bits) {
    TurningCode code{lengthOf(data_bits), {}};
    const std::uint32_t inverted = kAlternating & ((1U << code.rounds) - 1);
    for (std::uint32_t data = 0; data < 1U << data_bits && code.words.size() < robots; ++data) {
      const std::uint32_t word = extendedHammingWord(data) ^ inverted;
      if (reversals(word, code.rounds) >= kFewestReversals) code.words.push_back(word);
    }
    if (code.words.size() == robots) return code;
  }
}

}  // namespace lab::runner
