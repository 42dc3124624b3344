/// Random programs of motion: valid byte code that uses every instruction and every input.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "robot/dynamics/byte_code.hpp"

namespace lab {

struct RandomProgramOptions {
  bool draws_in_conditions = true;
  bool conditions = true;
  int shortest_hold_256ths = 8;   ///< [s / 256]
  int longest_hold_256ths = 256;  ///< [s / 256]
};

class RandomPrograms {
 public:
  explicit RandomPrograms(std::uint64_t seed, const RandomProgramOptions& options = {})
      : random_(seed), options_(options) {}

  /// A program that checkByteCode() accepts.
  std::vector<std::uint8_t> next() {
    for (;;) {
      std::vector<std::uint8_t> code = drawn();
      if (dynamics::checkByteCode(code.data(), static_cast<std::uint16_t>(code.size())).fault ==
          dynamics::kValidByteCode) {
        return code;
      }
      ++rejected_;  // too long or too slow
    }
  }

  [[nodiscard]] int rejected() const { return rejected_; }

 private:
  using Bytes = std::vector<std::uint8_t>;

  unsigned below(unsigned count) { return static_cast<unsigned>(random_() % count); }
  bool chance(double p) { return std::uniform_real_distribution<>(0, 1)(random_) < p; }
  std::uint8_t byte() { return static_cast<std::uint8_t>(random_()); }

  template <class... Values>
  static void add(Bytes& block, Values... values) {
    (block.push_back(static_cast<std::uint8_t>(values)), ...);
  }
  static void addShort(Bytes& block, int value_256ths) {
    add(block, dynamics::kPushShort, value_256ths & 0xFF, (value_256ths >> 8) & 0xFF);
  }

  void leaf(Bytes& block) {
    using namespace dynamics;
    switch (below(8)) {
      case 0:
        add(block, kPushByte, byte());
        break;
      case 1:
      case 2:
        add(block, kPushShort, byte(), chance(0.5) ? 0 : byte());
        break;
      case 3:
        add(block, kPushLong, byte(), byte(), chance(0.7) ? 0 : byte(), chance(0.8) ? 0 : byte());
        break;
      case 4:
        add(block, kLoad, below(kStates));
        break;
      case 5:
      case 6: {
        std::uint8_t input = 0;
        do {
          input = static_cast<std::uint8_t>(below(kSense + kSenses));
        } while (!isInput(input));
        add(block, kRead, input);
        break;
      }
      default:
        add(block, kPushByte, below(10));
        break;
    }
  }

  /// Leaves one number.
  void number(Bytes& block, int levels, bool draws) {
    using namespace dynamics;
    if (levels == 0 || chance(0.25)) return leaf(block);
    static constexpr std::uint8_t kOne[] = {kNegate, kAbs, kSign, kSqrt, kSin, kCos};
    static constexpr std::uint8_t kTwo[] = {kAdd, kSubtract, kMultiply, kDivide,
                                            kMin, kMax,      kAtan2,    kAdd};
    static constexpr std::uint8_t kDraw[] = {kUniform,     kUniform, kNormal,
                                             kExponential, kPareto,  kChoose};
    switch (below(draws ? 6 : 4)) {
      case 0:
        number(block, levels - 1, draws);
        add(block, kOne[below(sizeof kOne)]);
        break;
      case 1:
      case 2:
        number(block, levels - 1, draws);
        number(block, levels - 1, draws);
        add(block, kTwo[below(sizeof kTwo)]);
        break;
      case 3:
        truth(block, levels - 1, draws);
        number(block, levels - 1, draws);
        number(block, levels - 1, draws);
        add(block, kSelect);
        break;
      default: {
        const std::uint8_t draw = kDraw[below(sizeof kDraw)];
        number(block, levels - 1, draws);
        if (draw != kExponential && draw != kChoose) number(block, levels - 1, draws);
        add(block, draw);
        break;
      }
    }
  }

  /// Leaves one truth value.
  void truth(Bytes& block, int levels, bool draws) {
    using namespace dynamics;
    static constexpr std::uint8_t kCompare[] = {kLess,         kLessOrEqual, kGreater,
                                                kGreaterEqual, kEqual,       kNotEqual};
    const unsigned kind = levels <= 0 ? 6 : below(draws ? 6 : 4);
    switch (kind) {
      case 0:
        truth(block, levels - 1, draws);
        add(block, kNot);
        break;
      case 1:
        truth(block, levels - 1, draws);
        truth(block, levels - 1, draws);
        add(block, chance(0.5) ? kAnd : kOr);
        break;
      case 2:
      case 3:
        number(block, levels - 1, draws);
        number(block, levels - 1, draws);
        add(block, kCompare[below(sizeof kCompare)]);
        break;
      case 4:
        add(block, kChanceOf, byte(), byte(), byte(), byte());
        break;
      case 5:
        number(block, levels - 1, draws);
        add(block, kChance);
        break;
      default:
        add(block, kPushPlain, below(2));
        break;
    }
  }

  void speed(Bytes& block, int limit) {
    number(block, 1 + static_cast<int>(below(3)), true);
    if (chance(0.15)) return;  // often beyond what the wheels reach
    add(block, dynamics::kPushByte, -limit, dynamics::kMax, dynamics::kPushByte, limit,
        dynamics::kMin);
  }

  void phase(Bytes& block, unsigned phases) {
    if (chance(0.5)) {
      truth(block, 2, true);
      add(block, dynamics::kPushPlain, below(phases), dynamics::kPushPlain, below(phases),
          dynamics::kSelect);
    } else if (chance(0.05)) {
      number(block, 1, true);  // no phase has such a number
    } else {
      add(block, dynamics::kPushPlain, below(phases));
    }
  }

  void hold(Bytes& block, bool interruptible) {
    if (interruptible && chance(0.1)) return add(block, dynamics::kPushForever);
    // Now and then no time at all; for ever, it would only be the limit of the machine.
    const bool sometimes_zero = chance(0.1);
    if (sometimes_zero) add(block, dynamics::kChanceOf, 0, 0, 0, 0x20, dynamics::kPushByte, 0);
    number(block, 1 + static_cast<int>(below(2)), true);
    addShort(block, options_.shortest_hold_256ths);
    add(block, dynamics::kMax);
    addShort(block, options_.longest_hold_256ths);
    add(block, dynamics::kMin);
    if (sometimes_zero) add(block, dynamics::kSelect);
  }

  static void append(Bytes& code, const Bytes& block) {
    // A longer block makes the program too long as well.
    code.push_back(static_cast<std::uint8_t>(block.size()));
    code.insert(code.end(), block.begin(), block.end());
  }

  Bytes drawn() {
    using namespace dynamics;
    const unsigned phases = 1 + below(4);
    Bytes code{kByteCodeFormat, static_cast<std::uint8_t>(phases)};
    Bytes start;
    for (unsigned i = below(3); i > 0; --i) {
      number(start, 1, true);
      add(start, kStore, below(kStates));
    }
    append(code, start);
    for (unsigned i = 0; i < phases; ++i) {
      const bool interruptible = options_.conditions && chance(0.4);
      Bytes evaluation;
      for (unsigned stores = below(3); stores > 0; --stores) {
        number(evaluation, 2, true);
        add(evaluation, kStore, below(kStates));
      }
      const bool drives = chance(0.6);
      speed(evaluation, 25);
      speed(evaluation, drives ? 6 : 25);
      hold(evaluation, interruptible);
      phase(evaluation, phases);
      add(evaluation, drives ? kDrive : kWheelSpeeds);
      append(code, evaluation);
      Bytes interruption;
      if (interruptible) {
        if (chance(0.5)) {  // after a while, so that every hold ends
          add(interruption, kRead, kPhaseTime);
          addShort(interruption, 5 + static_cast<int>(below(200)));
          add(interruption, kGreater);
        } else {
          truth(interruption, 2, options_.draws_in_conditions);
        }
        add(interruption, kPushPlain, below(phases));
      }
      append(code, interruption);
    }
    return code;
  }

  std::mt19937_64 random_;
  RandomProgramOptions options_;
  int rejected_ = 0;
};

}  // namespace lab
