#include "common/programs/shipped_programs.hpp"

#include <algorithm>
#include <string_view>

#include "common/files/experiment_error.hpp"
#include "common/programs/shipped_texts.hpp"

namespace lab {

std::vector<std::string> shippedProgramNames() {
  std::vector<std::string> names;
  for (const ShippedText& program : shippedTexts()) names.emplace_back(program.name);
  std::ranges::sort(names);
  return names;
}

std::optional<std::string> shippedProgramToml(const std::string& name) {
  for (const ShippedText& program : shippedTexts()) {
    if (program.name == name) return std::string(program.toml);
  }
  return std::nullopt;
}

std::optional<language::ProgramText> shippedProgramText(const std::string& name) {
  const std::optional<std::string> toml = shippedProgramToml(name);
  if (!toml) return std::nullopt;
  return readProgram(*toml, "programs/" + name + ".toml", name, kWidestWheels).text;
}

Program shippedProgram(const std::string& name, const std::vector<language::NamedText>& changes,
                       const dynamics::WheelLimits& limits) {
  ProgramFile file;
  std::optional<language::ProgramText> text = shippedProgramText(name);
  if (!text) throw ExperimentError({"no shipped program has the name " + name});
  file.text = std::move(*text);
  for (const auto& [parameter, value] : changes) {
    const auto found =
        std::ranges::find(file.text.parameters, parameter, &language::NamedText::first);
    if (found == file.text.parameters.end()) {
      throw ExperimentError({name + ": found an unknown parameter " + parameter});
    }
    found->second = value;
  }
  file.compiled = language::compile(file.text, limits);
  std::vector<std::string> problems;
  for (const language::Problem& problem : file.compiled.errors) {
    problems.push_back(name + ": " + problem.key + ": " + problem.message);
  }
  if (!problems.empty()) throw ExperimentError(problems);
  return toProgram(file);
}

}  // namespace lab
