// The costs by which programs of motion are checked, against the cycles of a simulated chip.
#include <gtest/gtest.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iostream>

#include "robot/dynamics/byte_code.hpp"

namespace lab::emulator {
namespace {

constexpr int kPortB = 0x25;  // in the memory of an ATmega328P
constexpr std::uint8_t kBegin = 0x80;
constexpr std::uint8_t kEnd = 0x81;
constexpr std::uint8_t kWorstEvaluation = 0x7F;
constexpr std::uint64_t kMostCycles = 200'000'000;

/// The most cycles of each instruction beyond a block without it; of kDrive and kWheelSpeeds those
/// of a whole evaluation.
std::array<std::uint64_t, 128> measuredCosts() {
  std::array<std::uint64_t, 128> most{};
  elf_firmware_t program{};
  EXPECT_EQ(elf_read_firmware(LAB_INSTRUCTION_COSTS_ELF, &program), 0);
  avr_t* chip = avr_make_mcu_by_name("atmega328p");
  avr_init(chip);
  chip->frequency = 8'000'000;
  chip->run_cycle_limit = 1;
  avr_load_firmware(chip, &program);
  std::uint8_t last = 0;
  std::uint64_t begin = 0;
  std::uint64_t without = 0;
  bool with = false;
  while (chip->cycle < kMostCycles && last != kEnd) {
    const int state = avr_run(chip);
    if (state == cpu_Crashed || state == cpu_Done) break;
    const std::uint8_t port = chip->data[kPortB];
    if (port == last) continue;
    last = port;
    if (port == kBegin) {
      begin = chip->cycle;
    } else if (port < most.size()) {
      const std::uint64_t cycles = chip->cycle - begin;
      if (port >= dynamics::kDrive) {
        most[port] = std::max(most[port], cycles);
      } else if (with) {
        most[port] = std::max(most[port], cycles - without);
      }
      without = cycles;
      with = port < dynamics::kDrive && !with;
    }
  }
  EXPECT_EQ(last, kEnd) << "the program did not come to its end";
  avr_terminate(chip);
  return most;
}

TEST(InstructionCosts, BoundTheCyclesOfTheChip) {
  const std::array<std::uint64_t, 128> measured = measuredCosts();
  int instructions = 0;
  for (std::uint8_t opcode = 1; opcode < measured.size(); ++opcode) {
    const unsigned bound = dynamics::instructionCost(opcode);
    if (bound == 0) continue;
    ++instructions;
    if (opcode >= dynamics::kDrive) {
      // The four numbers that it takes are pushed in the same block.
      EXPECT_LE(measured[opcode], bound + 4U * dynamics::instructionCost(dynamics::kPushLong));
      EXPECT_GT(measured[opcode], 0U);
      continue;
    }
    EXPECT_LE(measured[opcode], bound) << "opcode " << int{opcode};
    // Bounds that are too high refuse programs that a robot could run.
    EXPECT_GE(3 * measured[opcode], bound) << "opcode " << int{opcode};
  }
  EXPECT_EQ(instructions, 40);
  // Whole evaluations near the bound of 5 ms.
  const std::uint64_t worst = measured[kWorstEvaluation];
  std::cout << "worst evaluation: " << worst << " cycles, " << static_cast<double>(worst) / 8000
            << " ms\n";
  EXPECT_LE(worst, dynamics::kLargestCost);
  EXPECT_GE(worst, dynamics::kLargestCost / 2U);
}

}  // namespace
}  // namespace lab::emulator
