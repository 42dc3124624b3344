#include "dashboard/views/curves_view.hpp"

#include <cmath>

#include "common/experiment/program_messages.hpp"
#include "common/math/units.hpp"
#include "common/text/format.hpp"

namespace lab::dashboard {
namespace {

const char* verdictName(std::int8_t verdict) {
  switch (verdict) {
    case analysis_t::AGREES:
      return "agrees";
    case analysis_t::DISAGREES:
      return "disagrees";
    default:
      return "undecided";
  }
}

Json curveJson(const curve_t& curve) {
  const lab::DisplayUnit unit = lab::displayUnit(curve.unit);
  return {{"name", curve.name},
          {"unit", unit.text},
          {"lag", numbers(curve.lag, 1)},
          {"value", numbers(curve.value, unit.factor)},
          {"sigma", numbers(curve.sigma, unit.factor)},
          {"exact", numbers(curve.exact, unit.factor)},
          {"paper", numbers(curve.paper, unit.factor)},
          {"windows", curve.windows},
          {"biased", curve.biased}};
}

Json estimateJson(const estimate_t& estimate) {
  const lab::DisplayUnit unit = lab::displayUnit(estimate.unit);
  return {{"name", estimate.name},
          {"unit", unit.text},
          {"value", number(estimate.value * unit.factor)},
          {"sigma", number(estimate.sigma * unit.factor)},
          {"low", number(estimate.low * unit.factor)},
          {"high", number(estimate.high * unit.factor)},
          {"theory", number(estimate.theory * unit.factor)},
          {"note", estimate.note}};
}

}  // namespace

Json curveJson(const LengthCurve& curve) {
  return {{"name", "C_l"},
          {"unit", ""},
          {"lag_cm", numbers(curve.length, 1 / units::kCentimetre)},
          {"value", numbers(curve.value, 1)},
          {"sigma", numbers(curve.sigma, 1)},
          {"exact", numbers(curve.exact, 1)},
          {"windows", numbers(curve.windows, 1)}};
}

Json analysisJson(const analysis_t& analysis) {
  Json curves = Json::array();
  for (const curve_t& curve : analysis.curves) curves.push_back(curveJson(curve));
  Json estimates = Json::array();
  for (const estimate_t& estimate : analysis.estimates) {
    estimates.push_back(estimateJson(estimate));
  }
  return {{"program", analysis.program.name},
          {"observed_s", number(analysis.observed)},
          {"segments", analysis.segments},
          {"reversals", analysis.reversals},
          {"contact_share", number(analysis.contact_share)},
          {"verdict", verdictName(analysis.verdict)},
          {"max_z", number(analysis.max_z)},
          {"curves", std::move(curves)},
          {"estimates", std::move(estimates)}};
}

void CurvesView::take(const analysis_t& analysis) {
  if (analysis.robot_id == analysis_t::POOL) {
    if (pools_.size() >= kMaxPools && !pools_.contains(analysis.program.name)) {
      ++left_out_;
      return;
    }
    pools_[analysis.program.name] = {analysis, true};
    return;
  }
  const std::pair key{analysis.robot_id, analysis.program.name};
  if (robots_.size() >= kMaxOfRobots && !robots_.contains(key)) {
    ++left_out_;
    return;
  }
  robots_[key] = analysis;
}

void CurvesView::clear() {
  pools_.clear();
  robots_.clear();
  left_out_ = 0;
}

std::vector<std::string> CurvesView::takeChanged() {
  std::vector<std::string> names;
  for (auto& [name, pool] : pools_) {
    if (pool.changed) names.push_back(name);
    pool.changed = false;
  }
  return names;
}

const analysis_t* CurvesView::pool(const std::string& program) const {
  const auto found = pools_.find(program);
  return found == pools_.end() ? nullptr : &found->second.analysis;
}

std::string CurvesView::robotJson(std::int32_t robot) const {
  Json all = Json::array();
  for (auto it = robots_.lower_bound({robot, ""}); it != robots_.end() && it->first.first == robot;
       ++it) {
    all.push_back(analysisJson(it->second));
  }
  return toText(all);
}

}  // namespace lab::dashboard
