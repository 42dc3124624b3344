#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lab::language {

/// One instruction of a program as people read it.
struct ListedInstruction {
  unsigned position = 0;  ///< In the program [bytes].
  std::string text;       ///< "push 5", "uniform"
  unsigned cost = 0;      ///< At most [cycles on the robot].
};

/// One block of a program.
struct ListedBlock {
  std::string title;  ///< "start", "phase 0", "phase 0, until"
  std::vector<ListedInstruction> instructions;
};

/// The byte code of a program that dynamics::checkByteCode() accepts, as text.
[[nodiscard]] std::vector<ListedBlock> listing(std::span<const std::uint8_t> code);

}  // namespace lab::language
