#include "robot/language/range_check.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "robot/dynamics/machine.hpp"
#include "robot/language/number_text.hpp"
#include "robot/language/unused_parts.hpp"

namespace lab::language {
namespace {

constexpr double kCmPerMetre = 100;
constexpr double kMsPerSecond = 1000;
constexpr double kWholeMs = 1e-6;         // [ms] tolerance of whole milliseconds
constexpr double kShortestHold = 0.0005;  // rounds to 1 ms
constexpr double kLongestHold = dynamics::kLongestHoldMs * 1e-3;  // s
constexpr double kRoundingSlack = 1e-9;  // so that a limit met exactly is not refused

bool isWholeMs(double seconds) {
  const double ms = seconds * kMsPerSecond;
  return std::abs(ms - std::round(ms)) <= kWholeMs;
}

/// A hold beside the limits of holds.
std::string secondsText(double seconds) {
  return numberText(seconds, digitsBeside({0, 1 / kMsPerSecond, kLongestHold}, seconds));
}

class RangeCheck {
 public:
  RangeCheck(const dynamics::WheelLimits& limits, CompiledProgram& result)
      : wheel_limit_(limits.v_max * kCmPerMetre),
        half_base_(limits.wheel_base * kCmPerMetre / 2),
        result_(result) {}

  void check(const std::string& key, const CheckedPhase& phase, PhaseFacts facts) {
    facts.hold = phase.hold.range;
    wheelRanges(phase, facts);
    checkWheels(key, facts);
    checkHold(key + ".hold", phase.hold);
    checkCondition(key + ".until", phase.until);
    result_.phases.push_back(facts);
  }

 private:
  void error(const std::string& key, const std::string& message) {
    result_.errors.push_back({key, 0, message});
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
    const bool is_sure = sure > wheel_limit_ * (1 + kRoundingSlack);
    const double found = is_sure ? sure : fastest;
    const int digits = digitsBeside({wheel_limit_}, found);
    const std::string speed = numberText(found, digits);
    const std::string reach = numberText(wheel_limit_, digits) + " cm/s";
    if (is_sure) {
      error(key,
            "found a wheel speed of " + speed + " cm/s, expected at most " + reach +
                ", which the wheels reach; reduce the speed or the turn (a turn of 1 rad/s takes " +
                numberText(half_base_) + " cm/s of each wheel)");
    } else {
      result_.warnings.push_back({key, 0,
                                  "can ask for a wheel speed of " + speed +
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
      error(key, "holds for " + secondsText(range.low) + " s, expected 1 ms to 3600 s, or forever");
    } else if (hold.constant && !isWholeMs(range.low)) {
      const double ms = range.low * kMsPerSecond;
      error(key, "holds for " + numberText(ms, digitsBeside({std::round(ms)}, ms)) +
                     " ms, expected whole milliseconds such as " +
                     numberText(std::max(1.0, std::round(ms))) + " ms: robots count milliseconds");
    } else if (range.high < kShortestHold) {
      error(key, "is never longer than " + numberText(range.high * 1000) +
                     " ms, expected at least 1 ms");
    } else if (range.sure_high > kLongestHold) {
      error(key,
            "can be " + secondsText(range.sure_high) + " s, expected at most 3600 s, or forever");
    } else if (range.sure_low < 0) {
      error(key, "can be " + numberText(range.sure_low) +
                     " s, expected 0 or more; use max(0, ...) if "
                     "short holds may be cut");
    } else if (range.low < 0 || range.high > kLongestHold) {
      result_.warnings.push_back({key, 0,
                                  "can be " + secondsText(range.low < 0 ? range.low : range.high) +
                                      " s; it is then limited to 0 s to 3600 s and "
                                      "counted; bound it with clamp"});
    }
  }

  const double wheel_limit_;  ///< [cm/s]
  const double half_base_;    ///< [cm]
  CompiledProgram& result_;
};

}  // namespace

void checkRanges(const ProgramText& text, const CheckedProgram& program,
                 const dynamics::WheelLimits& limits, CompiledProgram& result) {
  for (const auto& [key, notes] : program.notes) {
    for (const RangeNote& note : notes) result.warnings.push_back({key, note.offset, note.message});
  }
  RangeCheck check(limits, result);
  std::vector<unsigned> ways;
  for (std::size_t i = 0; i < program.phases.size(); ++i) {
    PhaseFacts facts;
    facts.name = text.phases[i].name;
    check.check("phases." + facts.name, program.phases[i], facts);
    ways.push_back(program.phases[i].ways());
  }
  std::ranges::copy(unusedParts(text, ways), std::back_inserter(result.unused));
}

}  // namespace lab::language
