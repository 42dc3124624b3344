#include "dashboard/views/crowd_view.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "common/math/units.hpp"
#include "common/text/format.hpp"
#include "dashboard/web/json.hpp"

namespace lab::dashboard {
namespace {

constexpr std::array<std::string_view, 2> kOverTime{"polar_order", "largest_cluster"};

void halveTimes(std::vector<double>& values) {
  for (std::size_t i = 0; 2 * i < values.size(); ++i) values[i] = values[2 * i];
  values.resize((values.size() + 1) / 2);
}

Json observableJson(const observable_t& one) {
  const lab::DisplayUnit unit = lab::displayUnit(one.unit);
  return {{"name", one.name},
          {"unit", unit.text},
          {"now", number(one.now * unit.factor)},
          {"mean", number(one.mean * unit.factor)},
          {"sigma", number(one.sigma * unit.factor)},
          {"low", number(one.low * unit.factor)},
          {"high", number(one.high * unit.factor)}};
}

Json observableCurveJson(const observable_curve_t& curve) {
  const lab::DisplayUnit x = lab::displayUnit(curve.x_unit);
  const lab::DisplayUnit unit = lab::displayUnit(curve.unit);
  return {{"name", curve.name},
          {"x_unit", x.text},
          {"unit", unit.text},
          {"x", numbers(curve.x, x.factor)},
          {"value", numbers(curve.value, unit.factor)},
          {"low", numbers(curve.low, unit.factor)},
          {"high", numbers(curve.high, unit.factor)}};
}

}  // namespace

void CrowdView::take(const collective_t& message, std::int64_t start) {
  const std::string name = message.program.hash == 0 ? std::string() : message.program.name;
  if (groups_.size() >= kMaxPrograms && !groups_.contains(name)) return;
  Group& group = groups_[name];
  if (group.times.empty()) group.begin_utime = start != 0 ? start : message.utime;
  group.message = message;
  group.changed = true;
  if (message.utime < group.next_utime) return;
  group.next_utime = message.utime + group.step_us;
  addPoint(group);
}

void CrowdView::addPoint(Group& group) {
  if (group.times.size() >= kMaxPoints) {
    halveTimes(group.times);
    for (auto& [name, line] : group.lines) {
      for (auto* values : {&line.now, &line.low, &line.high}) halveTimes(*values);
    }
    group.step_us *= 2;
  }
  const std::size_t before = group.times.size();
  group.times.push_back(units::seconds(group.message.utime - group.begin_utime));
  for (const std::string_view name : kOverTime) {
    Line& line = group.lines[std::string(name)];
    const auto& all = group.message.observables;
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const observable_t& one) { return one.name == name; });
    const bool has = found != all.end();
    const auto add = [&](std::vector<double>& values, double value) {
      values.resize(before, units::kNan);
      values.push_back(has ? value : units::kNan);
    };
    add(line.now, has ? found->now : units::kNan);
    add(line.low, has ? found->low : units::kNan);
    add(line.high, has ? found->high : units::kNan);
  }
}

std::vector<std::string> CrowdView::takeChanged() {
  std::vector<std::string> names;
  for (auto& [name, group] : groups_) {
    if (std::exchange(group.changed, false)) names.push_back(name);
  }
  return names;
}

std::string CrowdView::json(const std::string& program) const {
  const auto found = groups_.find(program);
  if (found == groups_.end()) return {};
  const Group& group = found->second;
  Json observables = Json::array();
  for (const observable_t& one : group.message.observables) {
    observables.push_back(observableJson(one));
  }
  Json curves = Json::array();
  for (const observable_curve_t& curve : group.message.curves)
    curves.push_back(observableCurveJson(curve));
  Json members = Json::array();
  for (const crowd_member_t& member : group.message.members) {
    members.push_back({member.robot_id, member.cluster, number(static_cast<double>(member.density)),
                       number(static_cast<double>(member.hexatic))});
  }
  Json history = {{"t_s", numbers(group.times, 1)}};
  for (const auto& [name, line] : group.lines) {
    history[name] = {{"now", numbers(line.now, 1)},
                     {"low", numbers(line.low, 1)},
                     {"high", numbers(line.high, 1)}};
  }
  return toText({{"program", program},
                 {"observed_s", number(group.message.observed)},
                 {"robots", number(group.message.robots)},
                 {"observables", std::move(observables)},
                 {"curves", std::move(curves)},
                 {"history", std::move(history)},
                 {"members", std::move(members)}});
}

}  // namespace lab::dashboard
