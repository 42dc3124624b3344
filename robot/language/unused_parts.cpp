#include "robot/language/unused_parts.hpp"

#include <algorithm>
#include <cstddef>
#include <set>

#include "robot/dynamics/byte_code.hpp"
#include "robot/language/expression.hpp"

namespace lab::language {
namespace {

void addNames(const Expression& expression, std::set<std::string>& names) {
  if (expression.kind == Expression::kName) names.insert(expression.name);
  for (const Expression& operand : expression.operands) addNames(operand, names);
}

void addNames(const std::string& text, std::set<std::string>& names) {
  if (!text.empty()) addNames(parseExpression(text), names);
}

/// Names in the phases, in the initial states, and in the law.
std::set<std::string> namesRead(const ProgramText& text) {
  std::set<std::string> names;
  for (const auto& [name, value] : text.state) addNames(value, names);
  for (const auto& [name, value] : text.law) {
    if (name != "name") addNames(value, names);
  }
  for (const PhaseText& phase : text.phases) {
    for (const auto& [name, value] : phase.set) addNames(value, names);
    for (const std::string& part : {phase.forward, phase.turn, phase.left, phase.right, phase.hold,
                                    phase.next, phase.until, phase.then}) {
      addNames(part, names);
    }
  }
  // A parameter may use those before it.
  for (auto one = text.parameters.rbegin(); one != text.parameters.rend(); ++one) {
    if (names.contains(one->first)) addNames(one->second, names);
  }
  return names;
}

std::vector<bool> reachedPhases(const std::vector<unsigned>& ways) {
  std::vector<bool> reached(ways.size(), false);
  std::vector<std::size_t> open{0};
  while (!open.empty()) {
    const std::size_t phase = open.back();
    open.pop_back();
    if (reached[phase]) continue;
    reached[phase] = true;
    for (std::size_t next = 0; next < ways.size(); ++next) {
      if ((ways[phase] >> next & 1U) != 0) open.push_back(next);
    }
  }
  return reached;
}

}  // namespace

std::vector<Problem> unusedParts(const ProgramText& text, const std::vector<unsigned>& ways) {
  std::vector<Problem> warnings;
  const std::set<std::string> read = namesRead(text);
  for (const auto& [name, value] : text.parameters) {
    if (read.contains(name)) continue;
    warnings.push_back({"parameters." + name, 0,
                        "nothing uses it; remove it, or use it where another name stands"});
  }
  for (const auto& [name, value] : text.state) {
    if (read.contains(name)) continue;
    warnings.push_back({"state." + name, 0, "nothing reads it; remove it"});
  }
  const std::vector<bool> reached = reachedPhases(ways);
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (reached[i]) continue;
    warnings.push_back({"phases." + text.phases[i].name, 0,
                        "no phase leads to it; name it in next or then of another phase"});
  }
  return warnings;
}

Outcomes outcomesOf(const CheckedExpression& condition) {
  const auto part = [&](std::size_t i) { return outcomesOf(condition.children[i]); };
  const auto range = [&](std::size_t i) { return condition.children[i].range; };
  switch (condition.opcode) {
    case dynamics::kNot:
      return {part(0).no, part(0).yes};
    case dynamics::kAnd:
      return {part(0).yes && part(1).yes, part(0).no || part(1).no};
    case dynamics::kOr:
      return {part(0).yes || part(1).yes, part(0).no && part(1).no};
    case dynamics::kLess:
      return {range(0).low < range(1).high, range(0).high >= range(1).low};
    case dynamics::kLessOrEqual:
      return {range(0).low <= range(1).high, range(0).high > range(1).low};
    case dynamics::kGreater:
      return {range(0).high > range(1).low, range(0).low <= range(1).high};
    case dynamics::kGreaterEqual:
      return {range(0).high >= range(1).low, range(0).low < range(1).high};
    case dynamics::kChance:
      return {range(0).high > 0, range(0).low < 1};
    default:
      return {};
  }
}

}  // namespace lab::language
