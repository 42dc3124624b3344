#include "analyzer/report/sections/crowd_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>

#include "analyzer/report/html/html_sections.hpp"
#include "analyzer/report/record/crowd_records.hpp"
#include "common/math/units.hpp"
#include "common/text/format.hpp"
#include "common/text/json_number.hpp"

namespace lab::report {
namespace {

using collective::Average;
using collective::CurveSample;
using collective::Observable;
using collective::ObservableCurve;
using collective::PlaceResult;
using Json = nlohmann::ordered_json;

void addAverage(Json& json, const Average& average, double factor) {
  json["value"] = number(average.value * factor);
  json["standard_error"] = number(average.sigma * factor);
  json["low95"] = number(average.low * factor);
  json["high95"] = number(average.high * factor);
  json["independent_blocks"] = number(average.independent);
  if (std::isfinite(average.too_short_by)) json["too_short_by"] = number(average.too_short_by);
}

/// The unit as in other blocks of the file; "1" of a pure number.
Json averageJson(const Average& average, const std::string& si_unit) {
  const DisplayUnit unit = displayUnit(si_unit);
  Json json;
  json["unit"] = unit.text.empty() ? "1" : unit.text;
  addAverage(json, average, unit.factor);
  return json;
}

Json curveJson(const ObservableCurve& curve) {
  const DisplayUnit x_unit = displayUnit(curve.x_unit);
  const DisplayUnit unit = displayUnit(curve.unit);
  const auto column = [&](auto value) {
    Json values = Json::array();
    for (const CurveSample& point : curve.points) values.push_back(number(value(point)));
    return values;
  };
  const auto keyOf = [](const std::string& name, const DisplayUnit& one) {
    return one.key.empty() ? name : name + "_" + one.key;
  };
  const double f = unit.factor;
  Json json;
  json[keyOf(curve.x_name, x_unit)] = column([&](auto& p) { return p.x * x_unit.factor; });
  json[keyOf("value", unit)] = column([&](auto& p) { return p.average.value * f; });
  json[keyOf("standard_error", unit)] = column([&](auto& p) { return p.average.sigma * f; });
  json[keyOf("low95", unit)] = column([&](auto& p) { return p.average.low * f; });
  json[keyOf("high95", unit)] = column([&](auto& p) { return p.average.high * f; });
  json["weight"] = column([](auto& p) { return p.weight; });
  return json;
}

Json placesJson(const PlaceResult& places) {
  Json json;
  for (std::size_t i = 0; i < places.names.size(); ++i) {
    Json place;
    place["name"] = places.names[i];
    place["share_of_time"] = averageJson(places.shares[i], "1");
    place["mean_stay"] = averageJson(places.stays[i], "s");
    Json flux;
    for (std::size_t j = 0; j < places.names.size(); ++j) {
      if (j != i) flux[places.names[j]] = averageJson(places.flux[i][j], "1/s");
    }
    place["changes_to"] = std::move(flux);
    json.push_back(std::move(place));
  }
  return json;
}

}  // namespace

Json crowdsJson(const RunRecord& record) {
  Json all = Json::array();
  for (const CrowdRecord& crowd : record.crowds) {
    const collective::CrowdResult& result = crowd.result;
    Json json;
    json["robots"] = crowdName(record, crowd);
    json["mean_number"] = number(result.robots);
    if (isCrowdCut(record)) json["first_of_robots"] = record.crowd_most;
    json["observed_s"] = number(result.observed);
    json["frames"] = result.frames;
    Json numbers;
    for (const Observable& one : result.numbers) {
      numbers[one.name] = averageJson(one.average, one.unit);
      numbers[one.name]["scatter"] = number(one.scatter * displayUnit(one.unit).factor);
    }
    json["numbers"] = std::move(numbers);
    json["density_modes"] = {{"count", result.modes.count},
                             {"dilute", number(result.modes.dilute)},
                             {"dense", number(result.modes.dense)},
                             {"valley", number(result.modes.valley)},
                             {"depth", number(result.modes.depth)},
                             {"depth_in_sigmas", number(result.modes.depth_sigmas)}};
    for (const ObservableCurve& curve : result.curves) {
      if (!curve.points.empty()) json["curves"][curve.name] = curveJson(curve);
    }
    if (!result.regions.names.empty()) json["regions"] = placesJson(result.regions);
    if (!result.bands.names.empty()) json["light_bands"] = placesJson(result.bands);
    all.push_back(std::move(json));
  }
  return all;
}

std::vector<std::string> crowdFigureNames() {
  return {"crowd_arena",        "crowd_order", "crowd_pairs",    "crowd_density",
          "crowd_fluctuations", "crowd_map",   "crowd_clusters", "crowd_motion"};
}

namespace html {
namespace {

struct Title {
  const char* name;
  const char* text;
};

// In the order of the table.
constexpr std::array kTitles{
    Title{"polar_order", "polar order |⟨e<sup>iθ</sup>⟩|"},
    Title{"nematic_order", "nematic order |⟨e<sup>2iθ</sup>⟩|"},
    Title{"hexatic_order", "hexatic order ⟨|ψ<sub>6</sub>|⟩"},
    Title{"hexatic_order_global", "global hexatic order |⟨ψ<sub>6</sub>⟩|"},
    Title{"largest_cluster", "largest cluster (robots)"},
    Title{"mean_cluster", "mean cluster of a robot (robots)"},
    Title{"clusters", "clusters"},
    Title{"clustered_share", "share of robots in clusters"},
    Title{"local_density", "local packing fraction"},
    Title{"local_density_scatter", "its standard deviation"},
    Title{"bimodality", "bimodality coefficient of it"},
    Title{"number_fluctuation_exponent", "exponent of number fluctuations"},
    Title{"speed", "mean speed, with contacts (cm/s)"},
    Title{"touching_share", "share of time touching a robot"},
    Title{"wall_share", "share of time at a wall"},
    Title{"contact_time", "mean duration of a contact (s)"},
    Title{"wall_time", "mean stay at a wall (s)"}};

std::string averageText(const Average& average, double factor) {
  if (!std::isfinite(average.value)) return "–";
  if (!std::isfinite(average.low)) {
    std::string text = shortText(average.value * factor);
    if (std::isfinite(average.too_short_by)) {
      text += fmt::format(" <span class=\"soft\">(run too short by a factor of {:.0f})</span>",
                          std::ceil(average.too_short_by));
    }
    return text;
  }
  const double sigma = average.sigma * factor;
  return fmt::format(
      "{} <span class=\"soft\">({} to {})</span>", valueText(average.value * factor, sigma),
      valueText(average.low * factor, sigma), valueText(average.high * factor, sigma));
}

std::string numberTable(const RunRecord& record) {
  const std::vector<const CrowdRecord*> shown = shownCrowds(record);
  std::vector<std::string> columns{"time average (95 % interval)"};
  for (const CrowdRecord* crowd : shown) {
    columns.push_back(">" + escapeHtml(crowdName(record, *crowd)));
  }
  Table table(columns);
  std::vector<std::string> robots{"mean number of robots"};
  for (const CrowdRecord* crowd : shown) robots.push_back(shortText(crowd->result.robots));
  table.row(robots);
  for (const Title& title : kTitles) {
    std::vector<std::string> cells{title.text};
    for (const CrowdRecord* crowd : shown) {
      const auto& numbers = crowd->result.numbers;
      const auto found = std::find_if(numbers.begin(), numbers.end(), [&](const Observable& one) {
        return one.name == title.name;
      });
      cells.push_back(found == numbers.end()
                          ? "–"
                          : averageText(found->average, displayUnit(found->unit).factor));
    }
    table.row(cells);
  }
  return table.text();
}

std::string placesTable(const PlaceResult& places, const char* what) {
  if (places.names.empty()) return {};
  std::vector<std::string> columns{what, ">share of time", ">mean stay (s)"};
  for (const std::string& name : places.names) {
    columns.push_back(">changes per minute to " + escapeHtml(name));
  }
  Table table(columns);
  for (std::size_t i = 0; i < places.names.size(); ++i) {
    std::vector<std::string> cells{escapeHtml(places.names[i]), averageText(places.shares[i], 1),
                                   averageText(places.stays[i], 1)};
    for (std::size_t j = 0; j < places.names.size(); ++j) {
      cells.push_back(i == j ? "" : averageText(places.flux[i][j], 60));
    }
    table.row(cells);
  }
  return table.text();
}

std::string modeText(const collective::Modes& modes) {
  if (modes.count < 2) return {};
  return fmt::format(
      "<p>The distribution of the local packing fraction has two modes, near {:.2f} and {:.2f}; "
      "the valley between them is {:.0f} % below the lower one ({:.0f} standard errors).</p>\n",
      modes.dilute, modes.dense, modes.depth * units::kPercents, modes.depth_sigmas);
}

std::string cutText(const RunRecord& record) {
  if (!isCrowdCut(record)) return {};
  return fmt::format(
      "<p><b>These are the numbers of the first {} of {} robots</b> (of the fullest frame).</p>\n",
      collective::CrowdAnalysis::kMostRobots, groupedText(record.crowd_most));
}

}  // namespace

std::string crowds(const RunRecord& record, const std::vector<Figure>& figures) {
  if (!isCrowd(record)) return {};
  const collective::CrowdResult& all = record.crowds.front().result;
  // The wide picture first, in a row of its own.
  std::vector<std::string> others = crowdFigureNames();
  others.erase(others.begin());
  return fmt::format(
             "<h2>Collective states</h2>\n<p>Averages over {} of {} frames ({}), with 95 % "
             "intervals that take the correlation of successive frames into account. A value "
             "without an interval changes too slowly or too rarely for the length of the run. "
             "Robots in random directions "
             "have a polar and nematic order of 0.89/√N = {:.2f}. Robots of other programs do not "
             "count for those of a program.</p>\n",
             groupedText(static_cast<std::int64_t>(all.frames)), groupedText(record.log.frames),
             durationText(all.observed), 0.8862 / std::sqrt(all.robots)) +
         cutText(record) + numberTable(record) + modeText(all.modes) +
         figureGrid(figures, {crowdFigureNames().front()}) + figureGrid(figures, others) +
         placesTable(all.regions, "region") + placesTable(all.bands, "light band");
}

}  // namespace html
}  // namespace lab::report
