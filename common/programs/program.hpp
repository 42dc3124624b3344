/// A program of motion as the parts of the lab pass it on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/programs/law_text.hpp"

namespace lab {

/// Of a program's text: ROBOT_COMMAND, which has four of them, must fit into one datagram [bytes].
inline constexpr std::size_t kLongestProgramText = 4000;

/// Of a program's name, which each report of a robot repeats [bytes].
inline constexpr std::size_t kLongestProgramName = 32;

struct ProgramParameter {
  std::string name;
  double value = 0;  ///< in SI units
  std::string unit;  ///< of the value: "m/s", "rad/s"; "1": none

  bool operator==(const ProgramParameter&) const = default;
};

/// A compiled program of motion (docs/programs.md) with all that its file says. The default one
/// stands.
struct Program {
  std::string name;
  std::string description;
  std::string text;                ///< TOML, as programToml() writes it
  std::vector<std::uint8_t> code;  ///< empty: the robot stands
  std::uint32_t hash = 0;          ///< of the code; 0: the robot stands
  std::vector<ProgramParameter> parameters;
  std::vector<std::string> phases;    ///< names, by number
  std::vector<std::string> warnings;  ///< "phases.run: ...": what is limited, or unused
  LawText law;
  double fastest_wheel = 0;         ///< [m/s] the largest wheel speed that it can ask for
  std::uint8_t senses = 0;          ///< bit i: it reads sense(i)
  bool reads_surroundings = false;  ///< light, infrared sensors or senses: no law in free space

  bool operator==(const Program&) const = default;
};

}  // namespace lab
