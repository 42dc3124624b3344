#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lab::language {

/// What a program calls its state variables and phases, by number.
struct ListedNames {
  std::vector<std::string> states;
  std::vector<std::string> phases;
};

/// One instruction of a program as people read it.
struct ListedInstruction {
  unsigned position = 0;  ///< In the program [bytes].
  std::string text;       ///< "push 5", "load sign", "read light", "uniform"
  unsigned cost = 0;      ///< At most [cycles on the robot].
};

/// One block of a program.
struct ListedBlock {
  std::string title;  ///< "start", "phase run", "phase run, until"
  std::vector<ListedInstruction> instructions;
};

/// The byte code of a program that compile() wrote, as text.
[[nodiscard]] std::vector<ListedBlock> listing(std::span<const std::uint8_t> code,
                                               const ListedNames& names);

/// "uniform", "push", "drive: forward, turn, hold, next".
[[nodiscard]] std::string instructionName(std::uint8_t opcode);

}  // namespace lab::language
