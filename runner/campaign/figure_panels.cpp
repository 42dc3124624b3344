#include "runner/campaign/figure_panels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "common/text/format.hpp"
#include "runner/campaign/axis.hpp"
#include "runner/campaign/campaign_laws.hpp"

namespace lab::runner::campaign {
namespace {

constexpr int kWidth = 760;
constexpr int kHeight = 520;
constexpr int kPanelWidth = 430;
constexpr int kPanelHeight = 360;

std::pair<int, int> gridOf(std::size_t panels) {
  const int columns = panels <= 1 ? 1 : panels <= 4 ? 2 : panels <= 9 ? 3 : 4;
  return {columns, (static_cast<int>(panels) + columns - 1) / columns};
}

}  // namespace

std::vector<std::string> valuesOf(const CampaignData& data, std::size_t axis) {
  std::set<std::string> seen;
  std::vector<std::string> values;
  for (const Point& point : data.points) {
    if (seen.insert(point.values[axis]).second) values.push_back(point.values[axis]);
  }
  if (data.axes[axis].isNumeric()) {
    std::ranges::stable_sort(values, [](const std::string& one, const std::string& other) {
      return numberIn(one).value_or(0) < numberIn(other).value_or(0);
    });
  }
  return values;
}

std::string axisText(const Axis& axis) {
  const std::string unit = axis.unit();
  return letterOf(axis.symbol()) + (unit.empty() ? "" : " (" + unit + ")");
}

std::string valueWithUnit(const Axis& axis, const std::string& value) {
  const std::string unit = axis.unit();
  return letterOf(axis.symbol()) + " = " + value + (unit.empty() ? "" : " " + unit);
}

std::string numberText(double value) {
  return std::isfinite(value) ? fmt::format("{:.7g}", value) : "NaN";
}

bool matches(const Point& point, const Fixed& fixed) {
  return std::ranges::all_of(
      fixed, [&](const auto& one) { return point.values[one.first] == one.second; });
}

std::vector<Fixed> combinationsOf(const CampaignData& data, const std::vector<std::size_t>& axes) {
  std::vector<std::map<std::string, std::size_t>> places;  // of each value in its order
  for (const std::size_t axis : axes) {
    std::map<std::string, std::size_t>& place = places.emplace_back();
    for (const std::string& value : valuesOf(data, axis)) place.emplace(value, place.size());
  }
  // From the points: if few combinations occur, all others would fill the memory.
  std::map<std::vector<std::size_t>, Fixed> found;
  for (const Point& point : data.points) {
    std::vector<std::size_t> at;
    Fixed fixed;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const std::string& value = point.values[axes[i]];
      at.push_back(places[i].at(value));
      fixed.emplace_back(axes[i], value);
    }
    found.emplace(std::move(at), std::move(fixed));
  }
  std::vector<Fixed> all;
  for (auto& [at, fixed] : found) all.push_back(std::move(fixed));
  return all;
}

std::string fixedText(const CampaignData& data, const Fixed& fixed) {
  std::string text;
  for (const auto& [axis, value] : fixed) {
    text += (text.empty() ? "" : ", ") + valueWithUnit(data.axes[axis], value);
  }
  return text;
}

std::string figureHead(const std::string& name, std::size_t panels) {
  if (panels <= 1) return report::figurePreamble(name, kWidth, kHeight);
  const auto [columns, rows] = gridOf(panels);
  return report::figurePreamble(name, columns * kPanelWidth, rows * kPanelHeight, true) +
         fmt::format("set multiplot layout {},{}\n", rows, columns);
}

Layout layoutOf(const CampaignData& data) {
  Layout layout;
  layout.scattered = data.request.random > 0;
  std::vector<std::pair<std::size_t, std::size_t>> counts;  // values, axis
  for (std::size_t axis = 0; axis < data.axes.size(); ++axis) {
    // Numbers rather than texts along x.
    const std::size_t numeric = data.axes[axis].isNumeric() ? kMostPoints : 0;
    counts.emplace_back(valuesOf(data, axis).size() + numeric, axis);
  }
  std::ranges::stable_sort(
      counts, [](const auto& one, const auto& other) { return one.first > other.first; });
  if (counts.empty()) return layout;
  layout.x = counts[0].second;
  if (data.request.zip) return layout;  // the keys vary together
  if (counts.size() > 1) layout.series.push_back(counts[1].second);
  for (std::size_t i = 2; i < counts.size(); ++i) layout.panels.push_back(counts[i].second);
  return layout;
}

}  // namespace lab::runner::campaign
