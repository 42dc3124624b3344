#include "runner/program/program_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <vector>

#include "analyzer/law_knowledge.hpp"
#include "analyzer/laws.hpp"
#include "common/files/file_text.hpp"
#include "common/programs/shipped_programs.hpp"
#include "common/text/nearest_word.hpp"
#include "robot/dynamics/byte_code.hpp"
#include "robot/language/expression.hpp"
#include "robot/language/listing.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/command_line/experiment_lookup.hpp"
#include "runner/command_line/print_line.hpp"
#include "runner/program/program_trace.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr double kCyclesPerMs = 8000;  // the robot's clock has 8 MHz

struct Source {
  std::string file;  ///< for messages
  std::string text;
};

Source sourceOf(const std::string& named) {
  const fs::path file = named;
  std::error_code error;
  if (file.has_parent_path() || file.extension() == ".toml" || fs::exists(file, error)) {
    return {file.string(), readFileText(file, file_kinds::kProgram)};
  }
  if (auto text = shippedProgramToml(named)) return {"programs/" + named + ".toml", *text};
  const std::vector<std::string> names = shippedProgramNames();
  throw UserError(fmt::format(
      "no program {}: looked for the file {} and among the shipped ones: "
      "{}{}",
      named, fs::absolute(file).string(), fmt::join(names, ", "), didYouMean(named, names)));
}

void printLines(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    printLine(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
}

std::string rangeText(const language::Interval& range, const char* unit) {
  if (range.isPoint()) return fmt::format("{:.4g} {}", range.low, unit);
  return fmt::format("{:.4g} to {:.4g} {}", range.low, range.high, unit);
}

std::string holdText(const language::Interval& hold) {
  if (hold.low >= language::kLargestNumber) return "forever";
  if (hold.high < language::kLargestNumber) return rangeText(hold, "s");
  return fmt::format("{:.4g} s or more", hold.low);
}

/// Whether a parameter is computed from others.
bool usesNames(const language::Expression& expression) {
  const bool name = expression.kind == language::Expression::kName && expression.name != "pi" &&
                    !language::unitNamed(expression.name);
  return name || std::ranges::any_of(expression.operands, usesNames);
}

}  // namespace

ProgramFile loadProgram(const std::string& named) {
  const Source source = sourceOf(named);
  const LawCheck check_law = [](const auto& text, const auto& compiled) {
    return analysis::lawKnowledge().problems(text, compiled, LagRange());
  };
  return readProgram(source.text, source.file, fs::path(source.file).stem().string(),
                     dynamics::WheelLimits(), check_law);
}

std::string describeProgram(const ProgramFile& program) {
  const language::CompiledProgram& compiled = program.compiled;
  std::string text =
      fmt::format("{}: {}\n{} of {} bytes, hash {:08x}\n", compiled.name, program.text.description,
                  compiled.code.size(), dynamics::kLargestProgram, compiled.hash);
  const auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < compiled.parameters.size(); ++i) {
    const language::Parameter& parameter = compiled.parameters[i];
    const std::string& written = program.text.parameters[i].second;
    const std::string unit =
        parameter.dimension == language::kPure ? "" : " " + language::unitText(parameter.dimension);
    fmt::format_to(out, "parameter {} = {}{}\n", parameter.name, written,
                   usesNames(language::parseExpression(written))
                       ? fmt::format(" = {:.6g}{}", parameter.value, unit)
                       : "");
  }
  for (const language::PhaseFacts& phase : compiled.phases) {
    fmt::format_to(out, "phase {}: left wheel {}, right wheel {}, hold {}; at most {:.2f} ms\n",
                   phase.name, rangeText(phase.left, "cm/s"), rangeText(phase.right, "cm/s"),
                   holdText(phase.hold), (phase.cost + phase.interruption_cost) / kCyclesPerMs);
  }
  const double wheel_base = dynamics::WheelLimits().wheel_base;
  fmt::format_to(out, "{}\n", analysis::referenceText(toProgram(program), wheel_base));
  for (const language::Problem& warning : compiled.warnings) {
    fmt::format_to(out, "warning: {}: {}\n", warning.key, warning.message);
  }
  return text;
}

std::string traceProgram(const ProgramFile& program, const TraceOptions& options) {
  const language::CompiledProgram& compiled = program.compiled;
  std::string text = describeProgram(program);
  const auto out = std::back_inserter(text);
  language::ListedNames names{compiled.states, {}};
  for (const language::PhaseFacts& phase : compiled.phases) names.phases.push_back(phase.name);
  for (const language::ListedBlock& block : language::listing(compiled.code, names)) {
    fmt::format_to(out, "\n{}\n", block.title);
    for (const language::ListedInstruction& step : block.instructions) {
      fmt::format_to(out, "{:5}  {:34}{:6} cycles\n", step.position, step.text, step.cost);
    }
  }
  TraceInputs inputs;
  for (const std::string& setting : options.set) setInput(inputs, setting);
  text += '\n' + traceTable(compiled, traceHolds(compiled, inputs, options.seed, options.holds));
  return text;
}

int listPrograms() {
  for (const std::string& name : shippedProgramNames()) {
    const ProgramFile program = loadProgram(name);
    printLine(fmt::format("{:20} {:3} bytes  {}", name, program.compiled.code.size(),
                          program.text.description));
  }
  return kDone;
}

int showProgram(const std::string& named) {
  printLines(sourceOf(named).text);
  return kDone;
}

int checkProgram(const std::string& named) {
  printLines(describeProgram(loadProgram(named)));
  return kDone;
}

int traceProgram(const TraceOptions& options) {
  printLines(traceProgram(loadProgram(options.program), options));
  return kDone;
}

}  // namespace lab::runner
