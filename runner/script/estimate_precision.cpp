#include "runner/script/estimate_precision.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "common/experiment/program_messages.hpp"

namespace lab::runner {

EstimatePrecision::EstimatePrecision(const Experiment& experiment, const EndCondition& until)
    : until_(until) {
  const auto program = experiment.programs.find(until.program);
  if (program != experiment.programs.end()) program_ = toId(program->second);
}

bool EstimatePrecision::take(const analysis_t& analysis) {
  const std::int32_t robot = until_.robot == 0 ? analysis_t::POOL : until_.robot;
  if (analysis.robot_id != robot || analysis.program.hash != program_.hash) return false;
  const auto estimate = std::ranges::find(analysis.estimates, until_.estimate, &estimate_t::name);
  if (estimate == analysis.estimates.end()) return false;
  // NaN or a standard error of 0 means that the estimate is not determined.
  if (!std::isfinite(estimate->value) || !(estimate->sigma > 0)) {
    error_ = std::numeric_limits<double>::quiet_NaN();
    return false;
  }
  error_ = estimate->sigma / std::abs(estimate->value);
  return true;
}

double EstimatePrecision::moreData() const {
  const double ratio = error_ / until_.relative_error;
  return std::isnan(ratio) ? ratio : std::max(0.0, ratio * ratio - 1);
}

std::string EstimatePrecision::progress() const {
  if (!std::isfinite(error_)) {
    return fmt::format("{} was not determined, wanted with a relative error of {:.3g}",
                       until_.estimate, until_.relative_error);
  }
  return fmt::format("relative error {:.3g}, wanted {:.3g}", error_, until_.relative_error);
}

}  // namespace lab::runner
