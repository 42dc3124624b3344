#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/math/units.hpp"
#include "common/text/format.hpp"
#include "runner/campaign/campaign_figures.hpp"
#include "runner/campaign/campaign_laws.hpp"
#include "runner/campaign/figure_panels.hpp"

namespace lab::runner::campaign {
namespace {

using report::quotedForGnuplot;
using report::ScriptedFigure;

constexpr std::size_t kMostLabels = 80;  // numbers in the cells of a map
// Viridis, as in the curves.
constexpr const char* kPalette =
    "set palette defined (0 '#440154', 1 '#414487', 2 '#2a788e', 3 '#22a884', 4 '#7ad151', 5 "
    "'#fde725')\n";
constexpr const char* kDiverging =
    "set palette defined (-4 '#0072B2', -2 '#9ccbe6', 0 '#f7f7f7', 2 '#f2c19c', 4 '#D55E00')\n";

/// A map's cells: the value of each point by its place.
struct Cells {
  std::vector<std::string> xs;
  std::vector<std::string> ys;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> points;
};

Cells cellsOf(const CampaignData& data, std::size_t x, std::size_t y, const Fixed& fixed) {
  Cells cells{valuesOf(data, x), valuesOf(data, y), {}};
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    if (!matches(data.points[i], fixed)) continue;
    const auto column = std::ranges::find(cells.xs, data.points[i].values[x]) - cells.xs.begin();
    const auto row = std::ranges::find(cells.ys, data.points[i].values[y]) - cells.ys.begin();
    cells.points[{static_cast<std::size_t>(column), static_cast<std::size_t>(row)}] = i;
  }
  return cells;
}

std::string ticsOf(const char* axis, const std::vector<std::string>& values) {
  std::vector<std::string> tics;
  const std::size_t step = (values.size() + 11) / 12;
  for (std::size_t i = 0; i < values.size(); i += step) {
    tics.push_back(fmt::format("{} {}", quotedForGnuplot(values[i]), i));
  }
  return fmt::format("set {0}tics ({1})\nset {0}range [-0.5:{2}]\n", axis, fmt::join(tics, ", "),
                     static_cast<double>(values.size()) - 0.5);
}

/// Draws maps, one per panel, of a function of the points.
/// @param is_dark whether the colour of a value needs white text
template <class Value, class Text, class Dark>
std::string mapScript(const CampaignData& data, const std::string& name, const Layout& layout,
                      const std::string& palette, const Value& value, const Text& text,
                      const Dark& is_dark) {
  const std::size_t x = layout.x;
  const std::size_t y = layout.series.at(0);
  std::vector<Fixed> panels = combinationsOf(data, layout.panels);
  if (panels.size() > kMostPanels) panels.resize(kMostPanels);
  std::string script = figureHead(name, panels.size()) + palette + "unset key\n";
  script += "set xlabel " + quotedForGnuplot(axisText(data.axes[x])) + "\nset ylabel " +
            quotedForGnuplot(axisText(data.axes[y])) + "\n";
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const Cells cells = cellsOf(data, x, y, panels[p]);
    std::string blocks = fmt::format("$m{} << EOD\n", p);
    std::string labels = fmt::format("$t{} << EOD\n", p);
    for (std::size_t row = 0; row < cells.ys.size(); ++row) {
      for (std::size_t column = 0; column < cells.xs.size(); ++column) {
        const auto found = cells.points.find({column, row});
        const double v = found == cells.points.end() ? units::kNan : value(found->second);
        blocks += fmt::format("{} {} {}\n", column, row, numberText(v));
        if (std::isfinite(v)) {
          labels += fmt::format("{} {} \"{}\" {}\n", column, row, text(found->second),
                                is_dark(v) ? 0xffffff : 0);
        }
      }
      blocks += "\n";
    }
    script += blocks + "EOD\n" + labels + "EOD\n" + ticsOf("x", cells.xs) + ticsOf("y", cells.ys);
    if (!panels[p].empty()) {
      script += "set title " + quotedForGnuplot(fixedText(data, panels[p])) + "\n";
    }
    script += fmt::format("plot $m{} using 1:2:3 with image pixels", p);
    if (cells.points.size() <= kMostLabels && panels.size() <= 2) {
      script += fmt::format(", $t{} using 1:2:3:4 with labels tc rgb variable font small_font", p);
    }
    script += "\n";
  }
  if (panels.size() > 1) script += "unset multiplot\n";
  return script;
}

}  // namespace

bool hasMap(const CampaignData& data) {
  constexpr std::size_t kFewest = 3;
  const Layout layout = layoutOf(data);
  if (layout.scattered || layout.series.empty()) return false;
  const std::size_t columns = valuesOf(data, layout.x).size();
  const std::size_t rows = valuesOf(data, layout.series[0]).size();
  // In a grid each cell has a point. A map of scattered points could have billions of cells.
  return data.axes[layout.series[0]].isNumeric() && columns >= kFewest && rows >= kFewest &&
         columns * rows <= data.points.size();
}

ScriptedFigure mapFigure(const CampaignData& data, const PooledTable& pooled,
                         std::size_t quantity) {
  const std::string name = "map_" + sanitizedFileName(pooled.quantities[quantity].name);
  const QuantityLabel label = labelOf(pooled.quantities[quantity].name);
  std::string palette = kPalette;
  palette += "set cblabel " + quotedForGnuplot(label.text()) + "\n";
  Extent extent;
  for (const PooledPoint& point : pooled.points) extent.add(point.numbers[quantity].mean);
  if (!extent.empty() && extent.isLogarithmic()) palette += "set logscale cb\n";
  const auto number = [&](std::size_t point) -> const PooledNumber& {
    return pooled.points[point].numbers[quantity];
  };
  const std::string script = mapScript(
      data, name, layoutOf(data), palette, [&](std::size_t p) { return number(p).mean; },
      [&](std::size_t p) {
        const double sigma = number(p).sigma;
        return std::isfinite(sigma) ? fmt::format("{}\\n±{}", valueText(number(p).mean, sigma),
                                                  valueText(sigma, sigma))
                                    : shortText(number(p).mean);
      },
      [&](double v) { return extent.shareOf(v) < 0.6; });
  return {name, label.text(), "The same as a map; in the cells mean and standard error.", script};
}

ScriptedFigure deviationFigure(const CampaignData& data, const PooledTable& pooled,
                               std::size_t quantity) {
  const std::string name = "deviation_" + sanitizedFileName(pooled.quantities[quantity].name);
  const QuantityLabel label = labelOf(pooled.quantities[quantity].name);
  const auto deviate = [&](std::size_t point) {
    return deviateFrom(pooled.points[point].numbers[quantity],
                       pooled.points[point].theory[quantity]);
  };
  std::string palette = kDiverging;
  palette += "set cbrange [-4:4]\nset cblabel 'measured − exact law (standard errors)'\n";
  const std::string script = mapScript(
      data, name, layoutOf(data), palette, deviate,
      [&](std::size_t p) { return fmt::format("{:+.1f}", deviate(p)); },
      [](double v) { return std::abs(v) > 3; });
  return {name, "Deviation of " + label.text() + " from the exact law",
          "Measured minus exact law, in standard errors of the measured mean.", script};
}

}  // namespace lab::runner::campaign
