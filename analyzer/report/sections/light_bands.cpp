#include "analyzer/report/sections/light_bands.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "analyzer/report/html/html_sections.hpp"
#include "common/calibration/light_margins.hpp"
#include "common/math/units.hpp"
#include "common/text/format.hpp"

namespace lab::report {
namespace {

using Json = nlohmann::ordered_json;

double centimetres(double metres) { return metres / units::kCentimetre; }

/// The readings by position, with y upwards.
std::string placeTable(const calibration::BandMargin& band, const LightBand& limits) {
  std::vector<std::string> columns{">y (cm) \\ x (cm)"};
  for (int column = 0; column < calibration::kMarginColumns; ++column) {
    const auto& place = band.places[static_cast<std::size_t>(column)].place;
    columns.push_back(fmt::format(">{:.0f}", centimetres(place.x)));
  }
  html::Table table(columns);
  for (int row = calibration::kMarginRows; row-- > 0;) {
    const auto first = static_cast<std::size_t>(row * calibration::kMarginColumns);
    std::vector<std::string> cells{fmt::format("{:.0f}", centimetres(band.places[first].place.y))};
    for (int column = 0; column < calibration::kMarginColumns; ++column) {
      const auto& place = band.places[first + static_cast<std::size_t>(column)];
      const bool inside = place.reading > limits.low && place.reading < limits.high;
      cells.push_back(fmt::format("{:.3f} {}", place.reading, inside ? "" : "✗"));
    }
    table.row(cells);
  }
  return table.text();
}

}  // namespace

std::string html::lightBands(const RunRecord& record) {
  if (!record.light_calibration || !record.experiment) return {};
  const auto margins = lightMargins(*record.light_calibration, *record.experiment);
  if (margins.empty()) return {};
  std::string html = fmt::format(
      "<h2>Light bands</h2>\n<p>With the light calibration {}, equal light gives equal readings "
      "everywhere, so the margins below hold at every position. A margin is the distance from the "
      "light in the middle of a band to the edge of the band, for the least sensitive sensor of {} "
      "robots. Readings follow the calibration within {:.2g} % of full scale (rms).</p>\n",
      record.light_calibration->id, record.light_calibration->gains.size(),
      100 * record.light_calibration->residual);
  Table table({"program", ">light", ">margin to the edge", ">in standard deviations of a reading",
               ">probability of a wrong reading"});
  for (const auto& band : margins) {
    table.row({escapeHtml(band.program), fmt::format("{:.3f}", band.light),
               fmt::format("{:.3f}", band.margin), fmt::format("{:.1f}", band.sigmas),
               fmt::format("{:.1e}", band.chance)});
  }
  html += table.text() +
          "<details><summary>Without the calibration, by position</summary>\n<p>The table has the "
          "readings of the same light by the sensor that is closest to leaving the band. ✗ marks "
          "readings outside the band.</p>\n";
  const auto& bands = record.experiment->light_table.bands;
  for (std::size_t i = 0; i < margins.size(); ++i) {
    html +=
        fmt::format("<h3>{}: light {:.3f}, band {:g} to {:g}</h3>\n",
                    escapeHtml(margins[i].program), margins[i].light, bands[i].low, bands[i].high) +
        placeTable(margins[i], bands[i]);
  }
  return html + "</details>\n";
}

nlohmann::ordered_json lightBandsJson(const RunRecord& record) {
  if (!record.light_calibration || !record.experiment) return nullptr;
  Json bands = Json::array();
  for (const auto& band : lightMargins(*record.light_calibration, *record.experiment)) {
    Json places = Json::array();
    for (const auto& place : band.places) {
      places.push_back({{"x_cm", centimetres(place.place.x)},
                        {"y_cm", centimetres(place.place.y)},
                        {"reading", place.reading},
                        {"chance_wrong", place.chance}});
    }
    bands.push_back({{"program", band.program},
                     {"light", band.light},
                     {"margin", band.margin},
                     {"margin_in_sigmas", band.sigmas},
                     {"chance_wrong", band.chance},
                     {"without_calibration", places}});
  }
  return {{"calibration", record.light_calibration->id},
          {"residual", record.light_calibration->residual},
          {"bands", bands}};
}

}  // namespace lab::report
