#include "robot/language/short_holds.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "robot/dynamics/byte_code.hpp"
#include "robot/dynamics/machine.hpp"
#include "robot/language/number_text.hpp"

namespace lab::language {
namespace {

constexpr double kMsPerSecond = 1000;
constexpr double kTolerance = 1e-6;  // ms

/// The time that the robot needs for a hold, as dynamics::Machine counts it [ms].
double neededMs(unsigned cost) {
  return ((cost >> 8) + 1.0 + dynamics::kHoldOverhead) / dynamics::kComputingPerMs;
}

/// The mean of a hold that is one draw, else its largest value [s].
double typicalHold(const CheckedExpression& hold) {
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

}  // namespace

std::vector<Problem> shortHolds(const CheckedProgram& program,
                                const std::vector<PhaseFacts>& facts) {
  std::vector<Problem> warnings;
  const std::size_t n = program.phases.size();
  constexpr double kNone = -1e9;
  std::vector<double> missing;                                              // [ms] of each hold
  std::vector<std::vector<double>> ways(n, std::vector<double>(n, kNone));  // most missing
  for (std::size_t i = 0; i < n; ++i) {
    const double most_ms = typicalHold(program.phases[i].hold) * kMsPerSecond;
    missing.push_back(neededMs(facts[i].cost) - most_ms);
    const unsigned next = program.phases[i].ways();
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
    if (!(missing[i] > kTolerance && ways[i][i] > kTolerance)) continue;
    const double needed = neededMs(facts[i].cost);
    warnings.push_back(
        {"phases." + facts[i].name + ".hold", 0,
         "is " + numberText(needed - missing[i]) + " ms, but the robot needs up to " +
             numberText(needed) +
             " ms per hold, because it computes for at most half of its time: holds can be "
             "lengthened, which is counted; use " +
             numberText(std::ceil(needed)) + " ms or more, or fewer draws and divisions"});
  }
  return warnings;
}

}  // namespace lab::language
