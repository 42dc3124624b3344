#include "robot/language/program_code.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "robot/dynamics/byte_code.hpp"
#include "robot/language/code_generator.hpp"
#include "robot/language/number_text.hpp"
#include "robot/language/short_holds.hpp"

namespace lab::language {
namespace {

void storeStates(BlockCode& block, std::size_t count,
                 const std::function<std::uint8_t(std::size_t)>& number) {
  for (std::size_t i = count; i > 0; --i) {
    block.add(dynamics::kStore, number(i - 1), 1, 0);
  }
}

BlockCode evaluationOf(const CheckedPhase& phase) {
  BlockCode block;
  for (const auto& [number, value] : phase.set) {
    block.push(value);
  }
  storeStates(block, phase.set.size(), [&](std::size_t i) { return phase.set[i].first; });
  block.push(phase.first);
  block.push(phase.second);
  block.push(phase.hold);
  block.push(phase.next);
  block.add(phase.wheels ? dynamics::kWheelSpeeds : dynamics::kDrive, 4, 4);
  return block;
}

void append(CompiledProgram& result, const std::string& key, const BlockCode& block) {
  const auto error = [&](const std::string& message) {
    result.errors.push_back({key, 0, message});
  };
  if (block.deepestStack() > dynamics::kLargestStack) {
    error("needs " + std::to_string(block.deepestStack()) +
          " places on the stack, a robot "
          "has " +
          std::to_string(dynamics::kLargestStack) +
          "; compute a part in a phase before, or use brackets less");
  }
  if (block.cost() > dynamics::kLargestCost) {
    error("can take " + numberText(block.cost() / 8000.0) +
          " ms on the robot, at most 5 ms; use fewer draws, divisions and functions");
  }
  const std::size_t size = std::min<std::size_t>(block.bytes().size(), 255);
  result.code.push_back(static_cast<std::uint8_t>(size));
  result.code.insert(result.code.end(), block.bytes().begin(), block.bytes().end());
}

}  // namespace

void writeProgramCode(const CheckedProgram& program, CompiledProgram& result) {
  std::vector<std::uint8_t>& code = result.code;
  code = {dynamics::kByteCodeFormat, static_cast<std::uint8_t>(program.phases.size())};
  BlockCode start;
  for (const CheckedExpression& value : program.starts) {
    start.push(value);
  }
  storeStates(start, program.starts.size(),
              [](std::size_t i) { return static_cast<std::uint8_t>(i); });
  append(result, "state", start);
  for (std::size_t i = 0; i < program.phases.size(); ++i) {
    const std::string key = "phases." + result.phases[i].name;
    const BlockCode evaluation = evaluationOf(program.phases[i]);
    BlockCode interruption;
    if (program.phases[i].until) {
      interruption.push(*program.phases[i].until);
      interruption.push(program.phases[i].then);
    }
    result.phases[i].cost = evaluation.cost();
    result.phases[i].interruption_cost = interruption.cost();
    append(result, key, evaluation);
    append(result, key + ".until", interruption);
  }
  if (result.ok()) {
    std::ranges::copy(shortHolds(program, result.phases), std::back_inserter(result.warnings));
  }
  if (code.size() > dynamics::kLargestProgram) {
    result.errors.push_back(
        {"", 0,
         "found " + std::to_string(code.size()) + " bytes of byte code, expected at most " +
             std::to_string(dynamics::kLargestProgram) +
             ", which a robot stores; share sub-expressions through state variables or use "
             "fewer phases"});
  }
  if (!result.ok()) {
    code.clear();
    return;
  }
  result.hash = dynamics::programHash(code.data(), static_cast<std::uint8_t>(code.size()));
}

}  // namespace lab::language
