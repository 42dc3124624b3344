#include "robot/language/compiler.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>

#include "robot/dynamics/byte_code.hpp"
#include "robot/dynamics/machine.hpp"
#include "robot/language/builtins.hpp"
#include "robot/language/checked_expression.hpp"
#include "robot/language/code_generator.hpp"
#include "robot/language/expression.hpp"
#include "robot/language/expression_checker.hpp"
#include "robot/language/formula.hpp"
#include "robot/language/scope.hpp"
#include "robot/language/spelled_name.hpp"
#include "robot/language/unused_parts.hpp"

namespace lab::language {
namespace {

constexpr double kCmPerMetre = 100;
constexpr double kMsPerSecond = 1000;
constexpr double kWholeMs = 1e-6;         // [ms] tolerance of whole milliseconds
constexpr double kShortestHold = 0.0005;  // rounds to 1 ms
constexpr double kLongestHold = dynamics::kLongestHoldMs * 1e-3;  // s
constexpr double kRoundingSlack = 1e-9;  // so that a limit met exactly is not refused
/// The ranges of state variables are extended so often. What still grows then is unlimited.
constexpr int kRangeRounds = 12;

/// What a parameter may have been meant to be.
constexpr std::array<Dimension, 10> kUsualDimensions{{kPure,
                                                      kLength,
                                                      kTime,
                                                      kSpeed,
                                                      kRate,
                                                      kVoltage,
                                                      {-1, 0, 0},
                                                      {2, -1, 0},
                                                      {2, 0, 0},
                                                      {1, -2, 0}}};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

bool isWholeMs(double seconds) {
  const double ms = seconds * kMsPerSecond;
  return std::abs(ms - std::round(ms)) <= kWholeMs;
}

bool isName(std::string_view text) {
  const auto letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  return !text.empty() && letter(text[0]) && std::all_of(text.begin(), text.end(), [&](char c) {
    return letter(c) || (c >= '0' && c <= '9');
  });
}

/// The checked expressions of a phase.
struct CheckedPhase {
  std::vector<std::pair<std::uint8_t, CheckedExpression>> set;  ///< State variable, new value.
  bool wheels = false;  ///< The speeds are those of the left and the right wheel.
  CheckedExpression first;
  CheckedExpression second;
  CheckedExpression hold;
  CheckedExpression next;
  std::optional<CheckedExpression> until;
  CheckedExpression then;
};

class Compiler {
 public:
  Compiler(const ProgramText& text, const dynamics::WheelLimits& limits, Suggest suggest)
      : text_(text),
        limits_(limits),
        wheel_limit_(limits.v_max * kCmPerMetre),
        half_base_(limits.wheel_base * kCmPerMetre / 2) {
    result_.name = text.name;
    scope_.suggest = suggest;
  }

  CompiledProgram compile() {
    declareNames();
    if (result_.ok()) {
      checkAll();
      if (!result_.ok()) {
        blameParameter();
      }
    }
    if (result_.ok()) {
      findRanges();
      checkRanges();
    }
    if (result_.ok()) {
      generate();
    }
    return std::move(result_);
  }

 private:
  void error(const std::string& key, std::size_t offset, const std::string& message) {
    result_.errors.push_back({key, offset, message});
  }

  // --- names ---

  void declareNames() {
    std::map<std::string, std::string> taken;
    const auto declare = [&](const std::string& name, const std::string& key, const char* what) {
      if (!isName(name)) {
        error(key, 0,
              std::string(what) + " '" + name +
                  "' is not a name: expected letters (a to z), digits and _, not a digit first" +
                  spelledAdvice(name));
      } else if (isReserved(name)) {
        error(key, 0,
              std::string(what) + " '" + name +
                  "' has a meaning in the language (docs/programs.md); choose another name, such "
                  "as " +
                  name + "_1");
      } else if (const auto [first, is_new] = taken.try_emplace(name, what); !is_new) {
        error(key, 0,
              "the name '" + name + "' is used twice in this program: a " + first->second +
                  " has it already; rename one");
      }
    };
    for (const auto& [name, value] : text_.parameters) {
      declare(name, "parameters." + name, "parameter");
    }
    for (const auto& [name, value] : text_.state) {
      declare(name, "state." + name, "state variable");
    }
    if (text_.state.size() > dynamics::kStates) {
      error("state", 0,
            "found " + std::to_string(text_.state.size()) + " state variables, a robot has " +
                std::to_string(dynamics::kStates));
    }
    if (text_.phases.empty()) {
      error("phases", 0,
            "found no phase, expected at least one, such as phases.run = {forward = \"5 cm/s\", "
            "hold = \"1 s\"}");
    }
    if (text_.phases.size() > dynamics::kLargestPhases) {
      error("phases", 0,
            "found " + std::to_string(text_.phases.size()) + " phases, a robot has " +
                std::to_string(dynamics::kLargestPhases));
    }
    for (std::size_t i = 0; i < text_.phases.size(); ++i) {
      declare(text_.phases[i].name, "phases." + text_.phases[i].name, "phase");
      scope_.phases[text_.phases[i].name] = static_cast<std::uint8_t>(i);
    }
  }

  // --- types and dimensions ---

  /// The checked expression of a key; nothing after an error, which is then noted.
  std::optional<CheckedExpression> read(const std::string& key, const std::string& text,
                                        Type wanted = Type::kNumber) {
    const auto known = syntax_.find(key);
    try {
      if (known == syntax_.end()) {
        syntax_[key] = parseExpression(text);
      }
      std::vector<RangeNote> notes;
      CheckedExpression checked = checkExpression(text, syntax_[key], scope_, notes, wanted);
      notes_[key] = std::move(notes);
      return checked;
    } catch (const SyntaxError& problem) {
      error(key, problem.offset(), problem.what());
      return std::nullopt;
    }
  }

  std::optional<CheckedExpression> readNumber(const std::string& key, const std::string& text,
                                              const Dimension& dimension, bool may_be_endless) {
    std::optional<CheckedExpression> checked = read(key, text);
    if (!checked) {
      return std::nullopt;
    }
    if (checked->type != Type::kNumber) {
      error(key, 0, "found a condition or a phase, expected a number in " + unitText(dimension));
      return std::nullopt;
    }
    if (checked->endless && !may_be_endless) {
      error(key, 0, "'forever' can only be a hold");
      return std::nullopt;
    }
    try {
      requireDimension(*checked, dimension, "the value", 0);
    } catch (const SyntaxError& problem) {
      const bool no_unit = checked->dimension == kPure;
      const std::string mean = meanAdvice(*checked, dimension, text);
      advised_ = advised_ || !mean.empty();
      error(key, problem.offset(),
            problem.what() + (no_unit ? "; give it one, as in 3 " + unitText(dimension) : mean));
      return std::nullopt;
    }
    return checked;
  }

  /// A draw of a time from a rate.
  static std::string meanAdvice(const CheckedExpression& found, const Dimension& wanted,
                                const std::string& text) {
    if (found.opcode != dynamics::kExponential || !(found.dimension == quotient(kPure, wanted))) {
      return "";
    }
    const std::size_t open = text.find('(');
    const std::string mean = text.substr(open + 1, text.rfind(')') - open - 1);
    const bool name = isName(mean);
    return "; an exponential draw takes its mean: write exponential(1/" +
           (name ? mean : '(' + mean + ')') + ")";
  }

  std::optional<CheckedExpression> readPhase(const std::string& key, const std::string& text) {
    std::optional<CheckedExpression> checked = read(key, text, Type::kPhase);
    if (checked && checked->type != Type::kPhase) {
      error(key, 0,
            "found " + std::string(checked->type == Type::kTruth ? "a condition" : "a number") +
                ", expected a phase: " + phaseNames());
      return std::nullopt;
    }
    return checked;
  }

  [[nodiscard]] std::string phaseNames() const {
    std::string names;
    for (const PhaseText& phase : text_.phases) {
      names += (names.empty() ? "" : ", ") + phase.name;
    }
    return names;
  }

  void checkAll() {
    checkParameters();
    checkStates();
    if (result_.ok()) {
      checkPhases();
    }
  }

  void checkParameters() {
    // A parameter may use those before it. Phases and states come later.
    std::swap(waiting_phases_, scope_.phases);
    for (const auto& [name, text] : text_.parameters) {
      const std::string key = "parameters." + name;
      const std::optional<CheckedExpression> value = read(key, text);
      if (!value) {
        continue;
      }
      if (value->type != Type::kNumber || !value->constant || value->endless) {
        error(key, 0,
              "expected a number with its unit, such as \"5 cm/s\"; sensors, draws and "
              "state variables belong in the phases");
        continue;
      }
      CheckedExpression& parameter = scope_.parameters[name];
      parameter = *value;
      parameter.any_dimension = false;
      if (name == assumed_parameter_) {
        parameter.dimension = assumed_dimension_;
      }
      result_.parameters.push_back({name, value->range.low, parameter.dimension});
    }
    checkLaw();
    std::swap(waiting_phases_, scope_.phases);
  }

  /// The parameters of the closed form. Without any, they are the program's own.
  void checkLaw() {
    const auto given = [&](const char* key) {
      return std::ranges::any_of(text_.law, [&](const NamedText& one) { return one.first == key; });
    };
    const bool closed_form = given("name");
    if (text_.law.empty()) {
      return;
    }
    if (!closed_form && !given("msd") && !given("angular_msd")) {
      error("law", 0,
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
        error(key, 0,
              "found an unknown key, allowed: msd, angular_msd, D, D_r; or name, and then the "
              "parameters of the closed form");
        continue;
      }
      const std::optional<CheckedExpression> value = read(key, text);
      if (!value) {
        continue;
      }
      if (value->type != Type::kNumber || !value->constant || value->endless) {
        error(key, 0, "expected a number, or an expression of the program's parameters");
        continue;
      }
      result_.law.push_back({name, value->range.low, value->dimension});
    }
    if (!mapped) {
      result_.law = result_.parameters;
    }
  }

  /// A formula is evaluated on the host: it only has to be right.
  void checkFormula(const std::string& name, const std::string& text) {
    const bool shadowed = std::ranges::any_of(
        result_.parameters, [](const Parameter& parameter) { return parameter.name == "tau"; });
    if (isCurve(name) && shadowed) {
      error("parameters.tau", 0, "'tau' is the lag in the formulas of law; rename the parameter");
    }
    try {
      const Formula checked(text, result_.parameters, formulaDimension(name), isCurve(name),
                            scope_.suggest);
    } catch (const SyntaxError& problem) {
      error("law." + name, problem.offset(), problem.what());
    }
  }

  void checkStates() {
    for (const auto& [name, text] : text_.state) {
      const std::optional<CheckedExpression> value = read("state." + name, text);
      if (!value) {
        continue;
      }
      if (value->type != Type::kNumber || value->endless) {
        error("state." + name, 0, "expected the number that the state variable starts with");
        continue;
      }
      starts_.push_back(*value);
      result_.states.push_back(name);
    }
    for (std::size_t i = 0; i < starts_.size() && result_.ok(); ++i) {
      const Interval range = {starts_[i].range.low, starts_[i].range.high, false};
      scope_.states[result_.states[i]] = {static_cast<std::uint8_t>(i), starts_[i].dimension,
                                          range};
    }
  }

  void checkPhases() {
    phases_.clear();
    for (const PhaseText& phase : text_.phases) {
      phases_.push_back(checkPhase(phase));
    }
  }

  CheckedPhase checkPhase(const PhaseText& phase) {
    CheckedPhase checked;
    const std::string key = "phases." + phase.name;
    for (const auto& [name, text] : phase.set) {
      checkAssignment(key + ".set." + name, name, text, checked);
    }
    checkSpeeds(key, phase, checked);
    if (phase.hold.empty()) {
      error(key, 0,
            "has no hold: expected how long the speeds are kept, such as hold = \"0.1 s\" "
            "or \"forever\"");
    } else if (const auto hold = readNumber(key + ".hold", phase.hold, kTime, true)) {
      checked.hold = *hold;
    }
    if (const auto next = readPhase(key + ".next", phase.next.empty() ? phase.name : phase.next)) {
      checked.next = *next;
      checked.then = *next;
    }
    if (phase.until.empty() && !phase.then.empty()) {
      error(key + ".then", 0, "needs `until`, the condition after which this phase follows");
    }
    if (!phase.until.empty()) {
      checkInterruption(key, phase, checked);
    }
    return checked;
  }

  void checkAssignment(const std::string& key, const std::string& name, const std::string& text,
                       CheckedPhase& checked) {
    const auto state = scope_.states.find(name);
    if (state == scope_.states.end()) {
      error(key, 0,
            "'" + name + "' is not a state variable of this program; declare it as state." + name +
                " = \"...\" with the value that it starts with" +
                suggestion(scope_.suggest, name, result_.states));
      return;
    }
    if (const auto value = readNumber(key, text, state->second.dimension, false)) {
      checked.set.emplace_back(state->second.number, *value);
    }
  }

  void checkSpeeds(const std::string& key, const PhaseText& phase, CheckedPhase& checked) {
    checked.wheels = !phase.left.empty() || !phase.right.empty();
    const bool drive = !phase.forward.empty() || !phase.turn.empty();
    if (checked.wheels && drive) {
      error(key, 0, "has both wheel speeds (left, right) and forward or turn; use one pair");
      return;
    }
    const auto speed = [&](const char* name, const std::string& text, const Dimension& dimension,
                           CheckedExpression& expression) {
      // What is not given is 0.
      if (const auto value =
              readNumber(key + '.' + name, text.empty() ? "0" : text, dimension, false)) {
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

  void checkInterruption(const std::string& key, const PhaseText& phase, CheckedPhase& checked) {
    const auto until = read(key + ".until", phase.until);
    if (until && until->type != Type::kTruth) {
      error(key + ".until", 0, "found a value, expected a condition such as \"ir(0) > 0.3\"");
    }
    if (!phase.then.empty()) {
      if (const auto then = readPhase(key + ".then", phase.then)) {
        checked.then = *then;
      }
    }
    if (until) {
      checked.until = *until;
    }
  }

  /// If all that is wrong are units, and another unit of one parameter makes all right, the mistake
  /// is that parameter's: it is reported there, with the first of its uses.
  void blameParameter() {
    constexpr std::size_t kMostParameters = 30;  // a bound of the time
    if (advised_ || result_.parameters.size() > kMostParameters) {
      return;
    }
    std::optional<Parameter> blamed;
    for (const Parameter& parameter : result_.parameters) {
      for (const Dimension& dimension : kUsualDimensions) {
        if (dimension == parameter.dimension) {
          continue;
        }
        Compiler other(text_, limits_, nullptr);
        other.assumed_parameter_ = parameter.name;
        other.assumed_dimension_ = dimension;
        other.declareNames();
        other.checkAll();
        if (!other.result_.ok()) {
          continue;
        }
        if (blamed) {
          return;  // cannot be told
        }
        blamed = {parameter.name, 0, dimension};
      }
    }
    if (!blamed) {
      return;
    }
    const auto found = std::ranges::find(result_.parameters, blamed->name, &Parameter::name);
    const auto unit = [](const Dimension& dimension) {
      return dimension == kPure ? "without unit" : "in " + unitText(dimension);
    };
    result_.errors = {{"parameters." + blamed->name, 0,
                       "found a number " + unit(found->dimension) + ", but " +
                           result_.errors.front().key + " needs '" + blamed->name +
                           "' to be a number " + unit(blamed->dimension) +
                           ": change the unit here, or the expression there"}};
  }

  // --- ranges ---

  /// Extends the ranges of the state variables until no phase leaves them.
  void findRanges() {
    // Ends, because each end of a range goes to 0 and becomes unlimited only once.
    for (int round = 1; extendRanges(round >= kRangeRounds); ++round) {
      checkPhases();
    }
  }

  bool extendRanges(bool to_the_limits) {
    bool extended = false;
    for (const CheckedPhase& phase : phases_) {
      for (const auto& [number, value] : phase.set) {
        Interval& range = scope_.states[result_.states[number]].range;
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

  void checkRanges() {
    for (const auto& [key, notes] : notes_) {
      for (const RangeNote& note : notes) {
        result_.warnings.push_back({key, note.offset, note.message});
      }
    }
    for (std::size_t i = 0; i < phases_.size(); ++i) {
      const std::string key = "phases." + text_.phases[i].name;
      PhaseFacts facts;
      facts.name = text_.phases[i].name;
      facts.hold = phases_[i].hold.range;
      wheelRanges(phases_[i], facts);
      checkWheels(key, facts);
      checkHold(key + ".hold", phases_[i].hold);
      checkCondition(key + ".until", phases_[i].until);
      result_.phases.push_back(facts);
    }
    std::vector<unsigned> ways;
    for (std::size_t i = 0; i < phases_.size(); ++i) ways.push_back(waysFrom(i));
    std::ranges::copy(unusedParts(text_, ways), std::back_inserter(result_.unused));
  }

  /// Bit p: phase p can follow.
  [[nodiscard]] unsigned waysFrom(std::size_t phase) const {
    return phases_[phase].next.phases | (phases_[phase].until ? phases_[phase].then.phases : 0U);
  }

  void checkCondition(const std::string& key, const std::optional<CheckedExpression>& until) {
    if (!until) {
      return;
    }
    const Outcomes outcomes = outcomesOf(*until);
    if (!outcomes.yes) {
      result_.unused.push_back({key, 0, "is never true, so the hold never ends early"});
    } else if (!outcomes.no) {
      result_.unused.push_back({key, 0, "is always true, so the hold ends at the first scan"});
    }
  }

  void wheelRanges(const CheckedPhase& phase, PhaseFacts& facts) const {
    if (phase.wheels) {
      facts.left = phase.first.range;
      facts.right = phase.second.range;
      return;
    }
    const Interval half_turn = product(phase.second.range, Interval{half_base_, half_base_, true});
    facts.left = sum(phase.first.range, negative(half_turn));
    facts.right = sum(phase.first.range, half_turn);
  }

  void checkWheels(const std::string& key, const PhaseFacts& facts) {
    const double fastest = std::max(facts.left.magnitude(), facts.right.magnitude());
    if (fastest <= wheel_limit_ * (1 + kRoundingSlack)) {
      return;
    }
    const double sure = std::max(
        {facts.left.sure_high, facts.right.sure_high, -facts.left.sure_low, -facts.right.sure_low});
    const std::string reach = number(wheel_limit_) + " cm/s";
    if (sure > wheel_limit_ * (1 + kRoundingSlack)) {
      error(key, 0,
            "found a wheel speed of " + number(sure) + " cm/s, expected at most " + reach +
                ", which the wheels reach; reduce the speed or the turn (a turn of 1 rad/s takes " +
                number(half_base_) + " cm/s of each wheel)");
    } else {
      result_.warnings.push_back({key, 0,
                                  "can ask for a wheel speed of " + number(fastest) +
                                      " cm/s, the wheels reach " + reach +
                                      "; it is then limited and counted; bound it with clamp"});
    }
  }

  void checkHold(const std::string& key, const CheckedExpression& hold) {
    if (hold.endless) {
      return;
    }
    const Interval& range = hold.range;
    if (hold.constant && (range.low < kShortestHold || range.high > kLongestHold)) {
      error(key, 0, "holds for " + number(range.low) + " s, expected 1 ms to 3600 s, or forever");
    } else if (hold.constant && !isWholeMs(range.low)) {
      const double ms = range.low * kMsPerSecond;
      error(key, 0,
            "holds for " + number(ms) + " ms, expected whole milliseconds such as " +
                number(std::max(1.0, std::round(ms))) + " ms: robots count milliseconds");
    } else if (range.high < kShortestHold) {
      error(key, 0,
            "is never longer than " + number(range.high * 1000) + " ms, expected at least 1 ms");
    } else if (range.sure_high > kLongestHold) {
      error(key, 0,
            "can be " + number(range.sure_high) + " s, expected at most 3600 s, or forever");
    } else if (range.sure_low < 0) {
      error(key, 0,
            "can be " + number(range.sure_low) +
                " s, expected 0 or more; use max(0, ...) if "
                "short holds may be cut");
    } else if (range.low < 0 || range.high > kLongestHold) {
      result_.warnings.push_back({key, 0,
                                  "can be " + number(range.low < 0 ? range.low : range.high) +
                                      " s; it is then limited to 0 s to 3600 s and "
                                      "counted; bound it with clamp"});
    }
  }

  // --- byte code ---

  void generate() {
    std::vector<std::uint8_t>& code = result_.code;
    code = {dynamics::kByteCodeFormat, static_cast<std::uint8_t>(phases_.size())};
    BlockCode start;
    for (const CheckedExpression& value : starts_) {
      start.push(value);
    }
    storeStates(start, starts_.size(), [](std::size_t i) { return static_cast<std::uint8_t>(i); });
    append("state", start);
    for (std::size_t i = 0; i < phases_.size(); ++i) {
      const std::string key = "phases." + text_.phases[i].name;
      const BlockCode evaluation = evaluationOf(phases_[i]);
      BlockCode interruption;
      if (phases_[i].until) {
        interruption.push(*phases_[i].until);
        interruption.push(phases_[i].then);
      }
      result_.phases[i].cost = evaluation.cost();
      result_.phases[i].interruption_cost = interruption.cost();
      append(key, evaluation);
      append(key + ".until", interruption);
    }
    if (result_.ok()) {
      warnOfShortHolds();
    }
    if (code.size() > dynamics::kLargestProgram) {
      error("", 0,
            "found " + std::to_string(code.size()) + " bytes of byte code, expected at most " +
                std::to_string(dynamics::kLargestProgram) +
                ", which a robot stores; share sub-expressions through state variables or use "
                "fewer phases");
    }
    if (!result_.ok()) {
      code.clear();
      return;
    }
    result_.hash = dynamics::programHash(code.data(), static_cast<std::uint8_t>(code.size()));
  }

  /// Warns of holds that are too short on average for what the robot computes, which it lengthens
  /// (dynamics::Machine). A short one among long ones is none of them, so ways from phase to phase
  /// count that lead back to where they began.
  void warnOfShortHolds() {
    const std::size_t n = phases_.size();
    constexpr double kNone = -1e9;
    std::vector<double> missing;                                              // [ms] of each hold
    std::vector<std::vector<double>> ways(n, std::vector<double>(n, kNone));  // most missing
    for (std::size_t i = 0; i < n; ++i) {
      const double most_ms = typicalHold(phases_[i].hold) * kMsPerSecond;
      missing.push_back(neededMs(result_.phases[i].cost) - most_ms);
      const unsigned next = waysFrom(i);
      for (std::size_t j = 0; j < n; ++j) {
        if ((next >> j & 1U) != 0) ways[i][j] = missing[i];
      }
    }
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
          ways[i][j] = std::clamp(ways[i][k] + ways[k][j], ways[i][j], -kNone);
        }
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (!(missing[i] > kWholeMs && ways[i][i] > kWholeMs)) continue;
      const double needed = neededMs(result_.phases[i].cost);
      result_.warnings.push_back(
          {"phases." + text_.phases[i].name + ".hold", 0,
           "is " + number(needed - missing[i]) + " ms, but the robot needs up to " +
               number(needed) +
               " ms per hold, because it computes for at most half of its time: holds can be "
               "lengthened, which is counted; use " +
               number(std::ceil(needed)) + " ms or more, or fewer draws and divisions"});
    }
  }

  /// The time that the robot needs for a hold, as dynamics::Machine counts it [ms].
  static double neededMs(unsigned cost) {
    return ((cost >> 8) + 1.0 + dynamics::kHoldOverhead) / dynamics::kComputingPerMs;
  }

  /// The mean of a hold that is one draw, else its largest value [s].
  static double typicalHold(const CheckedExpression& hold) {
    const auto known = [&](std::size_t count) {
      return hold.children.size() == count &&
             std::ranges::all_of(hold.children, &CheckedExpression::constant);
    };
    if (hold.opcode == dynamics::kExponential && known(1)) return hold.children[0].range.low;
    if (hold.opcode == dynamics::kNormal && known(2)) return hold.children[0].range.low;
    if (hold.opcode == dynamics::kUniform && known(2)) {
      return (hold.children[0].range.low + hold.children[1].range.high) / 2;
    }
    return hold.range.high;
  }

  static void storeStates(BlockCode& block, std::size_t count,
                          const std::function<std::uint8_t(std::size_t)>& number) {
    for (std::size_t i = count; i > 0; --i) {
      block.add(dynamics::kStore, number(i - 1), 1, 0);
    }
  }

  static BlockCode evaluationOf(const CheckedPhase& phase) {
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

  void append(const std::string& key, const BlockCode& block) {
    if (block.deepestStack() > dynamics::kLargestStack) {
      error(key, 0,
            "needs " + std::to_string(block.deepestStack()) +
                " places on the stack, a robot "
                "has " +
                std::to_string(dynamics::kLargestStack) +
                "; compute a part in a phase before, or use brackets less");
    }
    if (block.cost() > dynamics::kLargestCost) {
      error(key, 0,
            "can take " + number(block.cost() / 8000.0) +
                " ms on the robot, at most 5 ms; use fewer draws, divisions and functions");
    }
    const std::size_t size = std::min<std::size_t>(block.bytes().size(), 255);
    result_.code.push_back(static_cast<std::uint8_t>(size));
    result_.code.insert(result_.code.end(), block.bytes().begin(), block.bytes().end());
  }

  const ProgramText& text_;
  const dynamics::WheelLimits limits_;
  const double wheel_limit_;  ///< [cm/s]
  const double half_base_;    ///< [cm]
  Scope scope_;
  std::string assumed_parameter_;  ///< Has another dimension than its text says; empty: none.
  Dimension assumed_dimension_;
  bool advised_ = false;  ///< An error says what to write where the unit is wrong.
  std::map<std::string, std::uint8_t, std::less<>> waiting_phases_;
  std::map<std::string, Expression> syntax_;             ///< By key, parsed once.
  std::map<std::string, std::vector<RangeNote>> notes_;  ///< By key, of the last check.
  std::vector<CheckedExpression> starts_;                ///< Of the state variables.
  std::vector<CheckedPhase> phases_;
  CompiledProgram result_;
};

}  // namespace

bool isFormula(const std::string& law_key) {
  return law_key == "msd" || law_key == "angular_msd" || law_key == "D" || law_key == "D_r";
}

CompiledProgram compile(const ProgramText& text, const dynamics::WheelLimits& limits,
                        Suggest suggest) {
  return Compiler(text, limits, suggest).compile();
}

}  // namespace lab::language
