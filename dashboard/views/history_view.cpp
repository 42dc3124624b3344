#include "dashboard/views/history_view.hpp"

#include <limits>
#include <utility>

#include "common/math/units.hpp"
#include "common/text/format.hpp"
#include "dashboard/web/json.hpp"

namespace lab::dashboard {
namespace {

using units::kNan;

constexpr std::size_t kMaxLines = 40;

template <class Value>
void halve(std::vector<Value>& values) {
  for (std::size_t i = 0; 2 * i < values.size(); ++i) values[i] = values[2 * i];
  values.resize((values.size() + 1) / 2);
}

}  // namespace

bool HistoryView::take(const analysis_t& analysis, std::int64_t start) {
  if (pools_.size() >= kMaxPools && !pools_.contains(analysis.program.name)) return false;
  Pool& pool = pools_[analysis.program.name];
  if (pool.times.empty()) pool.begin_utime = start != 0 ? start : analysis.utime;
  if (analysis.utime < pool.next_utime) return false;
  pool.next_utime = analysis.utime + pool.step_us;
  if (pool.times.size() >= kMaxPoints) thin(pool);
  const std::size_t before = pool.times.size();
  pool.times.push_back(units::seconds(analysis.utime - pool.begin_utime));
  for (const estimate_t& estimate : analysis.estimates) {
    if (pool.lines.size() >= kMaxLines && !pool.lines.contains(estimate.name)) continue;
    Line& line = pool.lines[estimate.name];
    line.unit = estimate.unit;
    line.theory = estimate.theory;
    line.points.resize(before, {kNan, kNan, kNan});
    line.points.push_back({estimate.value, estimate.low, estimate.high});
  }
  for (auto& [name, line] : pool.lines) line.points.resize(before + 1, {kNan, kNan, kNan});
  return true;
}

void HistoryView::thin(Pool& pool) {
  halve(pool.times);
  for (auto& [name, line] : pool.lines) halve(line.points);
  pool.step_us *= 2;
}

std::size_t HistoryView::points(const std::string& program) const {
  const auto found = pools_.find(program);
  return found == pools_.end() ? 0 : found->second.times.size();
}

std::string HistoryView::json(const std::string& program) const {
  const auto found = pools_.find(program);
  if (found == pools_.end()) return {};
  Json times = Json::array();
  for (const double time : found->second.times) times.push_back(number(time));
  Json estimates = Json::array();
  for (const auto& [name, line] : found->second.lines) {
    const lab::DisplayUnit unit = lab::displayUnit(line.unit);
    Json values = Json::array();
    Json lows = Json::array();
    Json highs = Json::array();
    for (const Point& point : line.points) {
      values.push_back(number(point.value * unit.factor));
      lows.push_back(number(point.low * unit.factor));
      highs.push_back(number(point.high * unit.factor));
    }
    estimates.push_back({{"name", name},
                         {"unit", unit.text},
                         {"value", std::move(values)},
                         {"low", std::move(lows)},
                         {"high", std::move(highs)},
                         {"theory", number(line.theory * unit.factor)}});
  }
  return toText(
      {{"program", program}, {"t_s", std::move(times)}, {"estimates", std::move(estimates)}});
}

}  // namespace lab::dashboard
