#include "runner/script/crowd_value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/experiment/script_plan.hpp"
#include "common/text/format.hpp"

namespace lab::runner {
namespace {

constexpr std::size_t kMostValues = 5000;  // more than an hour at one per second

}  // namespace

CrowdValue::CrowdValue(const Experiment& experiment, std::string name, const std::string& program)
    : name_(std::move(name)) {
  const auto known = experiment.programs.find(program);
  if (known != experiment.programs.end()) hash_ = known->second.hash;
}

bool CrowdValue::take(const collective_t& message) {
  if (message.program.hash != hash_ || message.utime <= utime_) return false;
  const auto found = std::ranges::find(message.observables, name_, &observable_t::name);
  if (found == message.observables.end()) return false;
  const double factor = displayUnit(found->unit).factor;
  now_ = found->now * factor;
  error_ = found->sigma > 0 ? found->sigma / std::abs(found->mean) : units::kNan;
  utime_ = message.utime;
  return true;
}

CrowdCondition::CrowdCondition(const Experiment& experiment, const EndCondition& until)
    : until_(until), value_(experiment, until.observable, until.program) {}

bool CrowdCondition::take(const collective_t& message) {
  if (!value_.take(message)) return false;
  const std::int64_t utime = value_.utime();
  // Without a value there is nothing to compare, and the time begins again.
  if (!std::isfinite(value_.now())) {
    values_.clear();
    whole_ = false;
    return true;
  }
  values_.emplace_back(utime, value_.now());
  const std::int64_t begin = utime - units::microseconds(until_.over);
  whole_ = whole_ || values_.front().first <= begin;
  while (values_.size() > 1 && (values_.front().first < begin || values_.size() > kMostValues)) {
    values_.pop_front();
  }
  return true;
}

double CrowdCondition::mean() const {
  if (values_.empty()) return units::kNan;
  double sum = 0;
  for (const auto& [utime, value] : values_) sum += value;
  return sum / static_cast<double>(values_.size());
}

bool CrowdCondition::holds() const {
  if (until_.relative_error > 0) return value_.error() <= until_.relative_error;
  if (!whole_) return false;
  const double value = mean();
  return (!until_.above || value > *until_.above) && (!until_.below || value < *until_.below);
}

std::string CrowdCondition::progress() const {
  if (until_.relative_error > 0) {
    if (!std::isfinite(value_.error())) {
      return fmt::format("the average of {} is not known yet", until_.observable);
    }
    return fmt::format("relative error {:.3g}, wanted {:.3g}", value_.error(),
                       until_.relative_error);
  }
  if (values_.empty()) return fmt::format("{} was not measured", until_.observable);
  const std::string reached = whole_ ? "" : ", for less than that time";
  return fmt::format("{:.3g} over {:g} s{}; wanted: {}", mean(), until_.over, reached,
                     conditionText(until_));
}

}  // namespace lab::runner
