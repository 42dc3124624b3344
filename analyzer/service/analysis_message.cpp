#include "analyzer/service/analysis_message.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

constexpr std::size_t kLongestNote = 160;
constexpr std::size_t kFewestLags = 8;
// Space for what Node::publish() adds to the empty header: the name of the sender.
constexpr std::size_t kHeaderReserve = 64;

// Messages and code number the verdicts alike.
static_assert(analysis_t::UNDECIDED == static_cast<int>(VerdictKind::kUndecided));
static_assert(analysis_t::AGREES == static_cast<int>(VerdictKind::kAgrees));
static_assert(analysis_t::DISAGREES == static_cast<int>(VerdictKind::kDisagrees));
static_assert(analysis_t::POOL == kPool);

/// Receivers refuse infinite errors and curves (common/bus/message_values.hpp).
double withoutInfinity(double number) { return std::isinf(number) ? units::kNan : number; }

float inCurve(double number) { return static_cast<float>(withoutInfinity(number)); }

/// Indices of the lags to keep: at most `most` of `count`, evenly distributed, with the first and
/// the last.
std::vector<std::size_t> evenly(std::size_t count, std::size_t most) {
  std::vector<std::size_t> kept;
  kept.reserve(std::min(count, most));
  if (count <= most) {
    for (std::size_t i = 0; i < count; ++i) kept.push_back(i);
    return kept;
  }
  for (std::size_t i = 0; i < most; ++i) kept.push_back(i * (count - 1) / (most - 1));
  return kept;
}

curve_t toMessage(const std::vector<CurvePoint>& curve, const std::string& name,
                  const std::string& unit, std::size_t most) {
  std::vector<const CurvePoint*> seen;
  for (const CurvePoint& point : curve) {
    if (std::isfinite(point.value) && point.windows > 0) seen.push_back(&point);
  }
  curve_t message{};
  message.name = name;
  message.unit = unit;
  const std::vector<std::size_t> kept = evenly(seen.size(), most);
  for (auto* column :
       {&message.lag, &message.value, &message.sigma, &message.exact, &message.paper}) {
    column->reserve(kept.size());
  }
  message.windows.reserve(kept.size());
  message.biased.reserve(kept.size());
  for (const std::size_t i : kept) {
    const CurvePoint& point = *seen[i];
    message.lag.push_back(static_cast<float>(point.tau));
    message.value.push_back(static_cast<float>(point.value));
    message.sigma.push_back(inCurve(point.sigma));
    message.exact.push_back(inCurve(point.exact + point.noise));
    message.paper.push_back(inCurve(point.paper));
    constexpr double kMost = std::numeric_limits<std::int32_t>::max();
    message.windows.push_back(static_cast<std::int32_t>(std::min(point.windows, kMost)));
    message.biased.push_back(point.selection_biased ? 1 : 0);
  }
  message.num_lags = static_cast<std::int32_t>(message.lag.size());
  return message;
}

estimate_t toMessage(const Estimate& estimate) {
  estimate_t message{};
  message.name = estimate.name;
  message.unit = estimate.unit;
  message.value = estimate.value;
  message.sigma = withoutInfinity(estimate.sigma);
  message.low = estimate.low95;
  message.high = estimate.high95;
  message.theory = estimate.theory;
  message.note = estimate.note;
  return message;
}

bool fits(const analysis_t& message) {
  return static_cast<std::size_t>(message.getEncodedSize()) + kHeaderReserve <= kLargestAnalysis;
}

void setCurves(analysis_t& message, const ProgramResult& result, std::size_t most) {
  message.curves = {toMessage(result.curves.msd, "msd", "m^2", most),
                    toMessage(result.curves.angular_msd, "angular_msd", "rad^2", most)};
  message.num_curves = static_cast<std::int32_t>(message.curves.size());
}

}  // namespace

analysis_t toMessage(const FeedResult& feed_result, const std::string& program_name) {
  const ProgramResult& result = feed_result.result;
  analysis_t message{};
  message.robot_id = result.robot;
  message.program = feed_result.program;
  message.program.name = program_name;
  message.observed = result.observed;
  message.segments = static_cast<std::int32_t>(result.segments);
  message.reversals = static_cast<std::int32_t>(result.reversals);
  message.contact_share = result.contact_share;
  message.verdict = static_cast<std::int8_t>(result.verdict.kind);
  message.max_z = result.verdict.max_z;
  for (const Estimate& estimate : result.estimates) {
    message.estimates.push_back(toMessage(estimate));
  }
  message.num_estimates = static_cast<std::int32_t>(message.estimates.size());
  std::size_t most =
      std::max({kFewestLags, result.curves.msd.size(), result.curves.angular_msd.size()});
  setCurves(message, result, most);
  if (!fits(message)) {
    for (estimate_t& estimate : message.estimates) {
      if (estimate.note.size() > kLongestNote) estimate.note.resize(kLongestNote);
    }
  }
  while (!fits(message) && most > kFewestLags) setCurves(message, result, --most);
  return message;
}

}  // namespace lab::analysis
