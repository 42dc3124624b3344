#include "robot/language/program_checker.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "robot/language/expression.hpp"
#include "robot/language/formula.hpp"

namespace lab::language {
namespace {

/// The ranges of state variables are extended so often. What still grows then is unlimited.
constexpr int kRangeRounds = 12;

}  // namespace

void ProgramChecker::assume(const std::string& parameter, const Dimension& dimension) {
  assumed_parameter_ = parameter;
  assumed_dimension_ = dimension;
}

bool ProgramChecker::check() {
  checkParameters();
  checkStates();
  if (errors().empty()) {
    checkPhases();
  }
  program_.notes = reader_.notes();
  return errors().empty();
}

void ProgramChecker::checkParameters() {
  // A parameter may use those before it. Phases and states come later.
  std::map<std::string, std::uint8_t, std::less<>> phases;
  std::swap(phases, reader_.scope.phases);
  for (const auto& [name, text] : text_.parameters) {
    const std::string key = "parameters." + name;
    const std::optional<CheckedExpression> value = reader_.read(key, text);
    if (!value) {
      continue;
    }
    if (value->type != Type::kNumber || !value->constant || value->endless) {
      reader_.error(key, 0,
                    "expected a number with its unit, such as \"5 cm/s\"; sensors, draws and "
                    "state variables belong in the phases");
      continue;
    }
    CheckedExpression& parameter = reader_.scope.parameters[name];
    parameter = *value;
    parameter.any_dimension = false;
    if (name == assumed_parameter_) {
      parameter.dimension = assumed_dimension_;
    }
    program_.parameters.push_back({name, value->range.low, parameter.dimension});
  }
  checkLaw();
  std::swap(phases, reader_.scope.phases);
}

/// The parameters of the closed form. Without any, they are the program's own.
void ProgramChecker::checkLaw() {
  const auto given = [&](const char* key) {
    return std::ranges::any_of(text_.law, [&](const NamedText& one) { return one.first == key; });
  };
  const bool closed_form = given("name");
  if (text_.law.empty()) {
    return;
  }
  if (!closed_form && !given("msd") && !given("angular_msd")) {
    reader_.error(
        "law", 0,
        "has no formula that can be judged, expected msd or angular_msd (D and D_r are only "
        "shown), or the name of a closed form");
  }
  bool mapped = false;
  for (const auto& [name, text] : text_.law) {
    if (name == "name") {
      continue;
    }
    if (isFormula(name)) {
      checkFormula(name, text);
      continue;
    }
    mapped = true;
    const std::string key = "law." + name;
    if (!closed_form) {
      reader_.error(
          key, 0,
          "found an unknown key, allowed: msd, angular_msd, D, D_r; or name, and then the "
          "parameters of the closed form");
      continue;
    }
    const std::optional<CheckedExpression> value = reader_.read(key, text);
    if (!value) {
      continue;
    }
    if (value->type != Type::kNumber || !value->constant || value->endless) {
      reader_.error(key, 0, "expected a number, or an expression of the program's parameters");
      continue;
    }
    program_.law.push_back({name, value->range.low, value->dimension});
  }
  if (!mapped) {
    program_.law = program_.parameters;
  }
}

/// A formula is evaluated on the host: it only has to be right.
void ProgramChecker::checkFormula(const std::string& name, const std::string& text) {
  const bool shadowed = std::ranges::any_of(
      program_.parameters, [](const Parameter& parameter) { return parameter.name == "tau"; });
  if (isCurve(name) && shadowed) {
    reader_.error("parameters.tau", 0,
                  "'tau' is the lag in the formulas of law; rename the parameter");
  }
  try {
    const Formula checked(text, program_.parameters, formulaDimension(name), isCurve(name),
                          reader_.scope.suggest);
  } catch (const SyntaxError& problem) {
    reader_.error("law." + name, problem.offset(), problem.what());
  }
}

void ProgramChecker::checkStates() {
  for (const auto& [name, text] : text_.state) {
    const std::optional<CheckedExpression> value = reader_.read("state." + name, text);
    if (!value) {
      continue;
    }
    if (value->type != Type::kNumber || value->endless) {
      reader_.error("state." + name, 0, "expected the number that the state variable starts with");
      continue;
    }
    program_.starts.push_back(*value);
    program_.states.push_back(name);
  }
  for (std::size_t i = 0; i < program_.starts.size() && errors().empty(); ++i) {
    const Interval range = {program_.starts[i].range.low, program_.starts[i].range.high, false};
    reader_.scope.states[program_.states[i]] = {static_cast<std::uint8_t>(i),
                                                program_.starts[i].dimension, range};
  }
}

void ProgramChecker::checkPhases() {
  program_.phases.clear();
  for (const PhaseText& phase : text_.phases) {
    program_.phases.push_back(checkPhase(phase));
  }
}

CheckedPhase ProgramChecker::checkPhase(const PhaseText& phase) {
  CheckedPhase checked;
  const std::string key = "phases." + phase.name;
  for (const auto& [name, text] : phase.set) {
    checkAssignment(key + ".set." + name, name, text, checked);
  }
  checkSpeeds(key, phase, checked);
  if (phase.hold.empty()) {
    reader_.error(key, 0,
                  "has no hold: expected how long the speeds are kept, such as hold = \"0.1 s\" "
                  "or \"forever\"");
  } else if (const auto hold = reader_.readNumber(key + ".hold", phase.hold, kTime, true)) {
    checked.hold = *hold;
  }
  if (const auto next =
          reader_.readPhase(key + ".next", phase.next.empty() ? phase.name : phase.next)) {
    checked.next = *next;
    checked.then = *next;
  }
  if (phase.until.empty() && !phase.then.empty()) {
    reader_.error(key + ".then", 0, "needs `until`, the condition after which this phase follows");
  }
  if (!phase.until.empty()) {
    checkInterruption(key, phase, checked);
  }
  return checked;
}

void ProgramChecker::checkAssignment(const std::string& key, const std::string& name,
                                     const std::string& text, CheckedPhase& checked) {
  const auto state = reader_.scope.states.find(name);
  if (state == reader_.scope.states.end()) {
    reader_.error(key, 0,
                  "'" + name + "' is not a state variable of this program; declare it as state." +
                      name + " = \"...\" with the value that it starts with" +
                      suggestion(reader_.scope.suggest, name, program_.states));
    return;
  }
  if (const auto value = reader_.readNumber(key, text, state->second.dimension, false)) {
    checked.set.emplace_back(state->second.number, *value);
  }
}

void ProgramChecker::checkSpeeds(const std::string& key, const PhaseText& phase,
                                 CheckedPhase& checked) {
  checked.wheels = !phase.left.empty() || !phase.right.empty();
  const bool drive = !phase.forward.empty() || !phase.turn.empty();
  if (checked.wheels && drive) {
    reader_.error(key, 0, "has both wheel speeds (left, right) and forward or turn; use one pair");
    return;
  }
  const auto speed = [&](const char* name, const std::string& text, const Dimension& dimension,
                         CheckedExpression& expression) {
    // What is not given is 0.
    if (const auto value =
            reader_.readNumber(key + '.' + name, text.empty() ? "0" : text, dimension, false)) {
      expression = *value;
    }
  };
  if (checked.wheels) {
    speed("left", phase.left, kSpeed, checked.first);
    speed("right", phase.right, kSpeed, checked.second);
  } else {
    speed("forward", phase.forward, kSpeed, checked.first);
    speed("turn", phase.turn, kRate, checked.second);
  }
}

void ProgramChecker::checkInterruption(const std::string& key, const PhaseText& phase,
                                       CheckedPhase& checked) {
  const auto until = reader_.read(key + ".until", phase.until);
  if (until && until->type != Type::kTruth) {
    reader_.error(key + ".until", 0, "found a value, expected a condition such as \"ir(0) > 0.3\"");
  }
  if (!phase.then.empty()) {
    if (const auto then = reader_.readPhase(key + ".then", phase.then)) {
      checked.then = *then;
    }
  }
  if (until) {
    checked.until = *until;
  }
}

void ProgramChecker::findRanges() {
  // Ends, because each end of a range goes to 0 and becomes unlimited only once.
  for (int round = 1; extendRanges(round >= kRangeRounds); ++round) {
    checkPhases();
  }
  program_.notes = reader_.notes();
}

bool ProgramChecker::extendRanges(bool to_the_limits) {
  bool extended = false;
  for (const CheckedPhase& phase : program_.phases) {
    for (const auto& [number, value] : phase.set) {
      Interval& range = reader_.scope.states[program_.states[number]].range;
      Interval joined = join(range, value.range);
      if (joined.low == range.low && joined.high == range.high) {
        continue;
      }
      if (to_the_limits) {
        // An end that grows goes to 0 before it is unlimited: halving never changes the sign.
        if (joined.low < range.low) {
          joined.low = joined.low >= 0 ? 0 : -kLargestNumber;
        }
        if (joined.high > range.high) {
          joined.high = joined.high <= 0 ? 0 : kLargestNumber;
        }
      }
      range = {joined.low, joined.high, false};
      extended = true;
    }
  }
  return extended;
}

}  // namespace lab::language
