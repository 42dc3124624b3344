#include "common/programs/program_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "common/files/experiment_error.hpp"
#include "common/files/file_text.hpp"
#include "common/files/file_values.hpp"
#include "common/files/toml_document.hpp"
#include "common/programs/program_reader.hpp"
#include "robot/dynamics/byte_code.hpp"

namespace lab {
namespace {

constexpr std::size_t kMostProblems = 20;
constexpr double kCmPerMetre = 100;

double toSi(double value, const language::Dimension& dimension) {
  return value * std::pow(kCmPerMetre, -dimension.length);
}

/// "m/s"; "rad/s" where the program's text says so, because angles have no dimension.
std::string siUnit(const language::Dimension& dimension, const std::string& text) {
  const bool angle = text.find("rad") != std::string::npos || text.find("deg") != std::string::npos;
  if (angle && dimension == language::kRate) return "rad/s";
  if (angle && dimension == language::kPure) return "rad";
  std::string unit = language::unitText(dimension);
  for (std::size_t at = unit.find("cm"); at != std::string::npos; at = unit.find("cm", at + 1)) {
    unit.erase(at, 1);
  }
  return unit;
}

/// Calls `take` with every input that the program reads.
template <typename Take>
void forEachInput(const std::vector<std::uint8_t>& code, const Take& take) {
  for (std::size_t block = 2; block < code.size(); block += 1U + code[block]) {
    const std::size_t end = block + 1 + code[block];
    for (std::size_t at = block + 1; at < end; at += dynamics::instructionSize(code[at])) {
      if (code[at] == dynamics::kRead) take(code[at + 1]);
    }
  }
}

void findInputs(Program& program) {
  forEachInput(program.code, [&](std::uint8_t input) {
    const bool sense = input >= dynamics::kSense;
    const bool light = input <= dynamics::kLightBack;
    const bool infrared = input >= dynamics::kIr && input < dynamics::kTime;
    if (sense) {
      program.senses = static_cast<std::uint8_t>(program.senses | 1U << (input - dynamics::kSense));
    }
    program.reads_surroundings = program.reads_surroundings || sense || light || infrared;
  });
}

std::string inLine(const std::vector<language::NamedText>& texts) {
  std::string line;
  for (const auto& [name, text] : texts) {
    line += (line.empty() ? "{" : ", ") + name + " = " + keys::tomlString(text);
  }
  return line + "}\n";
}

}  // namespace

ProgramFile readProgram(std::string_view text, const std::string& file, const std::string& name,
                        const dynamics::WheelLimits& limits, const LawCheck& check_law) {
  // The check of the program's own text comes after the reading, whose time grows with the text.
  if (text.size() > file_kinds::kProgram.most_bytes) {
    throw ExperimentError({file + ": found a text of " + std::to_string(text.size()) +
                           " bytes, allowed at most " +
                           std::to_string(file_kinds::kProgram.most_bytes)});
  }
  const keys::TomlDocument document(text, file, {});
  keys::Problems problems([&](const std::string& path) { return document.place(path); });
  ProgramFile program =
      readProgramTable(document, document.root(), "", name, {limits, {}, check_law}, problems);
  if (!problems.empty()) throw ExperimentError(problems.lines(kMostProblems));
  return program;
}

Program toProgram(const ProgramFile& file) {
  const language::CompiledProgram& compiled = file.compiled;
  Program program;
  program.name = file.text.name;
  program.description = file.text.description;
  program.text = programToml(file.text);
  program.code = compiled.code;
  program.hash = compiled.hash;
  for (std::size_t i = 0; i < compiled.parameters.size(); ++i) {
    const language::Parameter& parameter = compiled.parameters[i];
    program.parameters.push_back({parameter.name, toSi(parameter.value, parameter.dimension),
                                  siUnit(parameter.dimension, file.text.parameters[i].second)});
  }
  for (const language::PhaseFacts& phase : compiled.phases) {
    program.phases.push_back(phase.name);
    program.fastest_wheel = std::max({program.fastest_wheel, phase.left.magnitude() / kCmPerMetre,
                                      phase.right.magnitude() / kCmPerMetre});
  }
  for (const auto& [key, text] : file.text.law) {
    if (key == "name") program.law.name = text;
    if (key == "msd") program.law.msd = text;
    if (key == "angular_msd") program.law.angular_msd = text;
    if (key == "D") program.law.diffusivity = text;
    if (key == "D_r") program.law.rotational_diffusivity = text;
  }
  if (!program.law.name.empty()) {
    for (const language::Parameter& parameter : compiled.law) {
      program.law.parameters.emplace_back(parameter.name,
                                          toSi(parameter.value, parameter.dimension));
    }
  }
  for (const auto* problems : {&compiled.warnings, &compiled.unused}) {
    for (const language::Problem& warning : *problems) {
      program.warnings.push_back(warning.key + ": " + warning.message);
    }
  }
  findInputs(program);
  return program;
}

std::string programToml(const language::ProgramText& program, const std::string& path) {
  using keys::tomlString;
  std::string text;
  if (!program.description.empty()) {
    text += "description = " + tomlString(program.description) + "\n";
  }
  if (program.law.size() == 1 && program.law.front().first == "name") {
    text += "law = " + tomlString(program.law.front().second) + "\n";
  } else if (!program.law.empty()) {
    text += "law = " + inLine(program.law);
  }
  if (!program.parameters.empty()) text += "parameters = " + inLine(program.parameters);
  if (!program.state.empty()) text += "state = " + inLine(program.state);
  for (const language::PhaseText& phase : program.phases) {
    text += "\n[" + path + "phases." + phase.name + "]\n";
    if (!phase.set.empty()) text += "set = " + inLine(phase.set);
    const auto line = [&](const char* key, const std::string& value) {
      if (!value.empty()) text += std::string(key) + " = " + tomlString(value) + "\n";
    };
    line("forward", phase.forward);
    line("turn", phase.turn);
    line("left", phase.left);
    line("right", phase.right);
    line("hold", phase.hold);
    line("next", phase.next);
    line("until", phase.until);
    line("then", phase.then);
  }
  return text;
}

}  // namespace lab
