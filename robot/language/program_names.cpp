#include "robot/language/program_names.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>

#include "robot/dynamics/byte_code.hpp"
#include "robot/dynamics/machine.hpp"
#include "robot/language/builtins.hpp"
#include "robot/language/spelled_name.hpp"

namespace lab::language {

bool isName(std::string_view text) {
  const auto letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  return !text.empty() && letter(text[0]) && std::all_of(text.begin(), text.end(), [&](char c) {
    return letter(c) || (c >= '0' && c <= '9');
  });
}

std::vector<Problem> problemsOfNames(const ProgramText& text) {
  std::vector<Problem> problems;
  const auto add = [&](const std::string& key, std::size_t offset, const std::string& message) {
    problems.push_back({key, offset, message});
  };
  std::map<std::string, std::string> taken;
  const auto declare = [&](const std::string& name, const std::string& key, const char* what) {
    if (!isName(name)) {
      add(key, 0,
          std::string(what) + " '" + name +
              "' is not a name: expected letters (a to z), digits and _, not a digit first" +
              spelledAdvice(name));
    } else if (isReserved(name)) {
      add(key, 0,
          std::string(what) + " '" + name +
              "' has a meaning in the language (docs/programs.md); choose another name, such "
              "as " +
              name + "_1");
    } else if (const auto [first, is_new] = taken.try_emplace(name, what); !is_new) {
      add(key, 0,
          "the name '" + name + "' is used twice in this program: a " + first->second +
              " has it already; rename one");
    }
  };
  for (const auto& [name, value] : text.parameters) {
    declare(name, "parameters." + name, "parameter");
  }
  for (const auto& [name, value] : text.state) {
    declare(name, "state." + name, "state variable");
  }
  if (text.state.size() > dynamics::kStates) {
    add("state", 0,
        "found " + std::to_string(text.state.size()) + " state variables, a robot has " +
            std::to_string(dynamics::kStates));
  }
  if (text.phases.empty()) {
    add("phases", 0,
        "found no phase, expected at least one, such as phases.run = {forward = \"5 cm/s\", "
        "hold = \"1 s\"}");
  }
  if (text.phases.size() > dynamics::kLargestPhases) {
    add("phases", 0,
        "found " + std::to_string(text.phases.size()) + " phases, a robot has " +
            std::to_string(dynamics::kLargestPhases));
  }
  for (const PhaseText& phase : text.phases) declare(phase.name, "phases." + phase.name, "phase");
  return problems;
}

}  // namespace lab::language
