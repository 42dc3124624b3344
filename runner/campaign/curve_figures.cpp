#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/math/units.hpp"
#include "common/text/format.hpp"
#include "runner/campaign/axis.hpp"
#include "runner/campaign/campaign_figures.hpp"
#include "runner/campaign/campaign_laws.hpp"
#include "runner/campaign/figure_panels.hpp"
#include "runner/campaign/law_curve.hpp"

namespace lab::runner::campaign {
namespace {

using report::quotedForGnuplot;
using report::ScriptedFigure;

constexpr std::size_t kMostSeries = 10;
constexpr const char* kLaw = "#606060";

// Viridis, which is ordered also in grey and with colour blindness.
constexpr std::array<std::array<int, 3>, 6> kViridis{
    {{68, 1, 84}, {65, 68, 135}, {42, 120, 142}, {34, 168, 132}, {122, 209, 81}, {216, 197, 48}}};

std::string viridis(std::size_t index, std::size_t count) {
  const double at = count < 2 ? 0
                              : static_cast<double>(index) / static_cast<double>(count - 1) *
                                    static_cast<double>(kViridis.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(at), kViridis.size() - 2);
  const double share = at - static_cast<double>(low);
  std::array<int, 3> rgb{};
  for (std::size_t i = 0; i < 3; ++i) {
    rgb.at(i) = static_cast<int>(
        std::lround(kViridis.at(low).at(i) * (1 - share) + kViridis.at(low + 1).at(i) * share));
  }
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

/// One measured point of a figure.
struct Drawn {
  double x = 0;
  const PooledNumber* number = nullptr;
  double theory = 0;
};

/// Positions on an axis: the number itself, or the index of a text.
double placeOf(const CampaignData& data, std::size_t axis, const std::string& value,
               const std::vector<std::string>& values) {
  if (data.axes[axis].isNumeric()) return numberIn(value).value_or(0);
  const auto found = std::ranges::find(values, value);
  return static_cast<double>(found - values.begin());
}

Extent extentOf(const PooledTable& pooled, std::size_t quantity) {
  Extent extent;
  for (const PooledPoint& point : pooled.points) {
    const PooledNumber& number = point.numbers[quantity];
    extent.add(number.mean);
    extent.add(number.low95);
    extent.add(number.high95);
    extent.add(point.theory[quantity]);
  }
  return extent;
}

/// Settings of the axis along x.
std::string xAxis(const CampaignData& data, std::size_t axis,
                  const std::vector<std::string>& values) {
  std::string text = "set xlabel " + quotedForGnuplot(axisText(data.axes[axis])) + "\n";
  if (!data.axes[axis].isNumeric()) {
    text += "unset logscale x\nset xtics (";
    for (std::size_t i = 0; i < values.size(); ++i) {
      text += fmt::format("{}{} {}", i == 0 ? "" : ", ", quotedForGnuplot(values[i]), i);
    }
    return text +
           fmt::format(")\nset xrange [-0.5:{}]\n", static_cast<double>(values.size()) - 0.5);
  }
  Extent extent;
  for (const std::string& value : values) extent.add(numberIn(value).value_or(units::kNan));
  if (extent.isLogarithmic()) {
    return text + fmt::format("set logscale x\nset xrange [{:.6g}:{:.6g}]\n", extent.low / 1.25,
                              extent.high * 1.25);
  }
  const double margin = extent.high > extent.low ? 0.06 * (extent.high - extent.low) : 1;
  return text + fmt::format("unset logscale x\nset xtics autofreq\nset xrange [{:.6g}:{:.6g}]\n",
                            extent.low - margin, extent.high + margin);
}

/// Settings of the axis along y, the same in all panels.
std::string yAxis(const PooledTable& pooled, std::size_t quantity) {
  const std::string label = labelOf(pooled.quantities[quantity].name).text();
  std::string text = "set ylabel " + quotedForGnuplot(label) + "\n";
  const Extent extent = extentOf(pooled, quantity);
  if (extent.empty()) return text + "set yrange [0:1]\n";
  if (extent.isLogarithmic()) {
    return text + fmt::format("set logscale y\nset yrange [{:.6g}:{:.6g}]\n", extent.low / 1.3,
                              extent.high * 1.3);
  }
  const double range = extent.high - extent.low;
  const double margin = range > 0 ? 0.08 * range : std::max(1e-9, std::abs(extent.high) * 0.1);
  return text +
         fmt::format("set yrange [{:.6g}:{:.6g}]\n", extent.low - margin, extent.high + margin);
}

std::string dataBlock(const std::string& name, std::vector<Drawn> points) {
  std::ranges::sort(points, {}, &Drawn::x);
  std::string text = fmt::format("${} << EOD\n", name);
  for (const Drawn& point : points) {
    const bool interval = std::isfinite(point.number->low95);
    text += fmt::format("{} {} {} {} {}\n", numberText(point.x), numberText(point.number->mean),
                        numberText(interval ? point.number->low95 : point.number->mean),
                        numberText(interval ? point.number->high95 : point.number->mean),
                        numberText(point.theory));
  }
  return text + "EOD\n";
}

std::string curveBlock(const std::string& name,
                       const std::vector<std::pair<double, double>>& curve) {
  std::string text = fmt::format("${} << EOD\n", name);
  for (const auto& [x, y] : curve) text += fmt::format("{} {}\n", numberText(x), numberText(y));
  return text + "EOD\n";
}

bool hasTheory(const std::vector<Drawn>& points) {
  return std::ranges::any_of(points, [](const Drawn& p) { return std::isfinite(p.theory); });
}

/// One panel: series of points by the values of the series' axis.
struct Series {
  std::string title;
  std::vector<Drawn> points;
  std::vector<std::pair<double, double>> law;  ///< a smooth curve; empty: only its values at points
};

/// How a panel shows the law.
struct LawStyle {
  bool as_points = false;
  bool exact = true;  ///< otherwise fitted
};

/// The data blocks and the plot command of one panel.
std::string panelScript(const std::string& prefix, const std::vector<Series>& series,
                        const LawStyle& style, bool with_key) {
  std::string blocks;
  std::vector<std::string> parts;
  bool law_titled = false;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const std::string name = fmt::format("{}s{}", prefix, i);
    blocks += dataBlock(name, series[i].points);
    const std::string colour = series.size() == 1 ? "#000000" : viridis(i, series.size());
    if (!series[i].law.empty() || hasTheory(series[i].points)) {
      const std::string title = law_titled || !with_key ? "notitle"
                                : style.exact           ? "title 'exact law'"
                                                        : "title 'power law'";
      law_titled = true;
      const std::string line =
          fmt::format("with lines lw 1.2{} lc rgb '{}' {}", style.exact ? "" : " dt 2",
                      series.size() == 1 ? kLaw : colour, title);
      if (style.as_points) {
        parts.insert(
            parts.begin(),
            fmt::format("${} using 1:5 with points pt 6 ps 0.7 lc rgb '{}' {}", name, kLaw, title));
      } else if (!series[i].law.empty()) {
        blocks += curveBlock(name + "law", series[i].law);
        parts.insert(parts.begin(), fmt::format("${}law using 1:2 {}", name, line));
      } else {
        parts.insert(parts.begin(), fmt::format("${} using 1:5 {}", name, line));
      }
    }
    const std::string title =
        !with_key || series.size() == 1 ? "notitle" : "title " + quotedForGnuplot(series[i].title);
    parts.push_back(
        fmt::format("${} using 1:2:3:4 with yerrorbars pt 7 ps 0.7 lw 1.2 lc rgb '{}' {}", name,
                    colour, title));
  }
  if (parts.empty()) return "unset key\nplot NaN notitle\n";
  return blocks + "plot " + fmt::format("{}", fmt::join(parts, ", \\\n  ")) + "\n";
}

/// `most` of the values, evenly spaced.
std::vector<std::string> thinned(std::vector<std::string> values, std::size_t most) {
  if (values.size() <= most) return values;
  std::vector<std::string> few;
  for (std::size_t i = 0; i < most; ++i)
    few.push_back(values[i * (values.size() - 1) / (most - 1)]);
  return few;
}

/// The law of one series, over the range of its points.
/// @return empty if other keys of the law vary along the series (--zip)
std::vector<std::pair<double, double>> curveOf(const DrawnLaw& law, const CampaignData& data,
                                               std::size_t x, const Fixed& fixed,
                                               const std::vector<Drawn>& points) {
  PointValues values(data.axes.size());
  for (const auto& [axis, value] : fixed) values[axis] = value;
  const bool constant = std::ranges::all_of(
      law.axes, [&](std::size_t axis) { return axis == x || !values[axis].empty(); });
  if (!constant) return {};
  Extent drawn;
  for (const Drawn& point : points) drawn.add(point.x);
  Extent axis;
  for (const std::string& value : valuesOf(data, x)) axis.add(numberIn(value).value_or(0));
  return lawCurve(law, x, values, drawn.low, drawn.high, axis.isLogarithmic());
}

std::vector<Series> seriesOf(const CampaignData& data, const PooledTable& pooled,
                             std::size_t quantity, const Layout& layout, const Fixed& fixed,
                             const std::optional<DrawnLaw>& law) {
  const std::vector<std::string> xs = valuesOf(data, layout.x);
  std::vector<Fixed> each{fixed};
  if (!layout.series.empty()) {
    each.clear();
    for (const std::string& value : thinned(valuesOf(data, layout.series[0]), kMostSeries)) {
      each.push_back(fixed);
      each.back().emplace_back(layout.series[0], value);
    }
  }
  std::vector<Series> series;
  for (const Fixed& one : each) {
    Series curve;
    if (!layout.series.empty()) {
      curve.title = valueWithUnit(data.axes[layout.series[0]], one.back().second);
    }
    for (std::size_t i = 0; i < data.points.size(); ++i) {
      if (!matches(data.points[i], one)) continue;
      const PooledNumber& number = pooled.points[i].numbers[quantity];
      if (!std::isfinite(number.mean)) continue;
      curve.points.push_back({placeOf(data, layout.x, data.points[i].values[layout.x], xs), &number,
                              pooled.points[i].theory[quantity]});
    }
    if (curve.points.empty()) continue;
    if (law) curve.law = curveOf(*law, data, layout.x, one, curve.points);
    series.push_back(std::move(curve));
  }
  return series;
}

/// What the lines of a figure are.
std::string lawSentence(const std::vector<Series>& series, bool exact) {
  const auto smooth = [](const Series& one) { return !one.law.empty(); };
  const auto known = [](const Series& one) { return hasTheory(one.points); };
  if (!exact) {
    return std::ranges::any_of(series, smooth) ? " Dashed: the power law that fits the points."
                                               : "";
  }
  if (std::ranges::none_of(series, known)) return "";
  return std::ranges::any_of(series, smooth)
             ? " Lines: the exact law of the programmed parameters."
             : " Lines: the exact law of the programmed parameters at the points, joined by "
               "straight lines.";
}

std::string intervalsSentence(const CampaignData& data) {
  std::string text = data.request.seeds > 1
                         ? "Points: means of the runs of a point; bars: 95 % intervals of the mean."
                         : "Points: one run each; bars: its 95 % interval.";
  if (data.request.common_seeds) {
    text +=
        " All points share their random numbers, so that their errors are correlated: "
        "neighbours deviate together.";
  }
  return text;
}

ScriptedFigure scatteredFigure(const CampaignData& data, const PooledTable& pooled,
                               std::size_t quantity, const std::string& name) {
  const std::size_t panels = std::min(kMostPanels, data.axes.size());
  std::string script = figureHead(name, panels) + yAxis(pooled, quantity);
  bool law = false;
  for (std::size_t axis = 0; axis < panels; ++axis) {
    const std::vector<Series> series =
        seriesOf(data, pooled, quantity, {axis, {}, {}, true}, {}, {});
    for (const Series& one : series) law = law || hasTheory(one.points);
    script += xAxis(data, axis, valuesOf(data, axis)) +
              panelScript(fmt::format("p{}", axis), series, {true, true}, axis == 0);
  }
  if (panels > 1) script += "unset multiplot\n";
  return {name, labelOf(pooled.quantities[quantity].name).text(),
          fmt::format("Each panel has all {} drawn points, over one of the swept keys. {}{}",
                      data.points.size(), intervalsSentence(data),
                      law ? " Circles: the exact law." : ""),
          script};
}

}  // namespace

ScriptedFigure curveFigure(const CampaignData& data, const PooledTable& pooled,
                           std::size_t quantity) {
  const std::string name = "curve_" + sanitizedFileName(pooled.quantities[quantity].name);
  const Layout layout = layoutOf(data);
  if (layout.scattered) return scatteredFigure(data, pooled, quantity, name);
  std::vector<Fixed> panels = combinationsOf(data, layout.panels);
  const std::size_t all = panels.size();
  if (panels.size() > kMostPanels) panels.resize(kMostPanels);
  std::string script =
      figureHead(name, panels.size()) +
      (panels.size() > 1 ? "set key top left\n" : "set key outside right top Left reverse\n") +
      yAxis(pooled, quantity);
  const std::optional<DrawnLaw> law = drawnLaw(data, pooled, quantity);
  const bool exact = !law || law->is_exact;
  std::string lines;
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const std::vector<Series> series = seriesOf(data, pooled, quantity, layout, panels[p], law);
    if (lines.empty()) lines = lawSentence(series, exact);
    if (!panels[p].empty()) {
      script += "set title " + quotedForGnuplot(fixedText(data, panels[p])) + "\n";
    }
    if (p > 0) script += "unset key\n";
    script += xAxis(data, layout.x, valuesOf(data, layout.x)) +
              panelScript(fmt::format("p{}", p), series, {false, exact}, p == 0);
  }
  if (panels.size() > 1) script += "unset multiplot\n";
  std::string caption = intervalsSentence(data) + lines;
  if (all > panels.size()) {
    caption +=
        fmt::format(" The first {} of {} combinations; points.csv has all.", panels.size(), all);
  }
  if (!layout.series.empty()) {
    const std::size_t values = valuesOf(data, layout.series[0]).size();
    if (values > kMostSeries) {
      caption += fmt::format(" {} of {} values of {} are drawn.", kMostSeries, values,
                             data.axes[layout.series[0]].symbol());
    }
  }
  return {name, labelOf(pooled.quantities[quantity].name).text(), caption, script};
}

}  // namespace lab::runner::campaign
