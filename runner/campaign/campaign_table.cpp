#include "runner/campaign/campaign_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>
#include <variant>

#include "common/math/units.hpp"
#include "common/text/json_number.hpp"

namespace lab::runner::campaign {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kTableFormat = 1;
constexpr std::array<std::string_view, 5> kParts{".standard_error", ".low95", ".high95", ".theory",
                                                 ".effective_samples"};

bool isPart(std::string_view column) {
  return std::ranges::any_of(kParts, [&](std::string_view part) { return column.ends_with(part); });
}

/// RFC 4180, and the end of a line is a space.
std::string csvText(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string field = "\"";
  for (const char letter : text) {
    if (letter == '"') field += '"';
    field += letter == '\n' || letter == '\r' ? ' ' : letter;
  }
  return field + "\"";
}

std::string csvNumber(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

std::string csvCell(const Cell& cell) {
  if (const auto* number = std::get_if<double>(&cell)) return csvNumber(*number);
  if (const auto* text = std::get_if<std::string>(&cell)) return csvText(*text);
  return {};
}

/// Six significant figures, as in summary.json.
std::string pooledText(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "";
}

const RunResult* resultOf(const CampaignData& data, std::size_t row) {
  const RowState& state = data.survey.rows[row];
  return state.result ? &*state.result : nullptr;
}

/// All columns of all results, in the order in which they first appear, the most complete results
/// first.
std::vector<std::string> columnNames(const CampaignData& data) {
  std::vector<const RunResult*> results;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    if (const RunResult* result = resultOf(data, i)) results.push_back(result);
  }
  std::ranges::stable_sort(results, [](const RunResult* one, const RunResult* other) {
    return one->columns.size() > other->columns.size();
  });
  std::vector<std::string> names;
  std::set<std::string> seen;
  for (const RunResult* result : results) {
    for (const auto& [name, cell] : result->columns) {
      if (seen.insert(name).second) names.push_back(name);
    }
  }
  return names;
}

/// The cells of a result by name. Results have a hundred columns, and tables ten thousand rows.
std::map<std::string_view, const Cell*> byName(const RunResult& result) {
  std::map<std::string_view, const Cell*> cells;
  for (const auto& [name, cell] : result.columns) cells.emplace(name, &cell);
  return cells;
}

double numberAt(const std::map<std::string_view, const Cell*>& cells, const std::string& column) {
  const auto found = cells.find(column);
  if (found == cells.end()) return units::kNan;
  const auto* number = std::get_if<double>(found->second);
  return number == nullptr ? units::kNan : *number;
}

std::vector<Quantity> quantitiesOf(const std::vector<std::string>& columns,
                                   const CampaignData& data) {
  const std::set<std::string> known(columns.begin(), columns.end());
  std::set<std::string> numeric;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const RunResult* result = resultOf(data, i);
    if (result == nullptr) continue;
    for (const auto& [name, cell] : result->columns) {
      if (std::holds_alternative<double>(cell)) numeric.insert(name);
    }
  }
  std::vector<Quantity> quantities;
  for (const std::string& name : columns) {
    if (isPart(name) || !numeric.contains(name)) continue;
    quantities.push_back(
        {name, known.contains(name + ".standard_error"), numeric.contains(name + ".theory")});
  }
  return quantities;
}

Json tableCell(const Cell& cell) {
  if (const auto* number = std::get_if<double>(&cell)) return *number;
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  return nullptr;
}

Json columnJson(const std::vector<double>& values) {
  Json column = Json::array();
  for (const double value : values) column.push_back(number(value));
  return column;
}

Json axesJson(const CampaignData& data) {
  Json axes = Json::array();
  for (const Axis& axis : data.axes) {
    axes.push_back({{"key", axis.key},
                    {"symbol", axis.symbol()},
                    {"unit", axis.unit()},
                    {"numeric", axis.isNumeric()},
                    {"values", axis.values}});
  }
  return axes;
}

Json valueJson(const Axis& axis, const std::string& text) {
  const auto number_in = axis.isNumeric() ? numberIn(text) : std::nullopt;
  return number_in ? Json(*number_in) : Json(text);
}

/// The values of the swept keys, a column each.
Json sweptJson(const CampaignData& data, const std::vector<std::size_t>& points) {
  Json columns = Json::object();
  for (std::size_t i = 0; i < data.axes.size(); ++i) {
    Json column = Json::array();
    for (const std::size_t point : points) {
      column.push_back(valueJson(data.axes[i], data.points[point].values[i]));
    }
    columns[data.axes[i].key] = std::move(column);
  }
  return columns;
}

Json runsJson(const CampaignData& data) {
  std::vector<std::size_t> points;
  Json run = Json::array();
  Json seed = Json::array();
  Json status = Json::array();
  Json note = Json::array();
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    points.push_back(data.rows[i].point);
    run.push_back(data.rows[i].identity.text());
    seed.push_back(data.rows[i].seed);
    status.push_back(statusText(data.survey.rows[i].kind));
    note.push_back(data.survey.rows[i].note);
  }
  Json json;
  json["point"] = points;
  json["run"] = std::move(run);
  json["seed"] = std::move(seed);
  json["status"] = std::move(status);
  json["note"] = std::move(note);
  json.update(sweptJson(data, points));
  std::vector<std::map<std::string_view, const Cell*>> cells;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const RunResult* result = resultOf(data, i);
    cells.push_back(result == nullptr ? std::map<std::string_view, const Cell*>()
                                      : byName(*result));
  }
  for (const std::string& name : columnNames(data)) {
    Json column = Json::array();
    for (const auto& row : cells) {
      const auto found = row.find(name);
      column.push_back(found == row.end() ? Json(nullptr) : tableCell(*found->second));
    }
    json[name] = std::move(column);
  }
  return json;
}

Json pooledJson(const CampaignData& data, const PooledTable& pooled) {
  std::vector<std::size_t> points(data.points.size());
  Json runs = Json::array();
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = i;
    runs.push_back(pooled.points[i].runs);
  }
  Json json = sweptJson(data, points);
  json["runs"] = std::move(runs);
  Json quantities = Json::object();
  for (std::size_t q = 0; q < pooled.quantities.size(); ++q) {
    const auto column = [&](auto value) {
      std::vector<double> values;
      for (const PooledPoint& point : pooled.points) values.push_back(value(point));
      return columnJson(values);
    };
    const auto of = [&](double PooledNumber::*member) {
      return column([&](const PooledPoint& point) { return point.numbers[q].*member; });
    };
    quantities[pooled.quantities[q].name] = {
        {"mean", of(&PooledNumber::mean)},
        {"standard_error", of(&PooledNumber::sigma)},
        {"low95", of(&PooledNumber::low95)},
        {"high95", of(&PooledNumber::high95)},
        {"between_runs", of(&PooledNumber::between)},
        {"theory", column([&](const PooledPoint& point) { return point.theory[q]; })}};
  }
  json["quantities"] = std::move(quantities);
  return json;
}

}  // namespace

const char* statusText(RowState::Kind kind) {
  constexpr std::array kTexts{"missing", "done", "stale", "failed", "damaged"};
  return kTexts.at(static_cast<std::size_t>(kind));
}

double numberOf(const RunResult& result, std::string_view column) {
  const auto found = std::ranges::find(result.columns, column, &Columns::value_type::first);
  if (found == result.columns.end()) return units::kNan;
  const auto* number = std::get_if<double>(&found->second);
  return number == nullptr ? units::kNan : *number;
}

PooledTable poolCampaign(const CampaignData& data) {
  PooledTable table;
  table.quantities = quantitiesOf(columnNames(data), data);
  table.points.resize(data.points.size());
  using Numbers = std::vector<std::vector<RunNumber>>;  // by point
  std::vector<Numbers> numbers(table.quantities.size(), Numbers(data.points.size()));
  for (PooledPoint& point : table.points) {
    point.theory.assign(table.quantities.size(), units::kNan);
  }
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const RunResult* result = resultOf(data, i);
    if (result == nullptr) continue;
    const std::size_t at = data.rows[i].point;
    PooledPoint& point = table.points[at];
    ++point.runs;
    if (data.survey.rows[i].kind == RowState::Kind::kStale) ++point.stale;
    if (!result->faults.empty()) ++point.faults;
    const auto cells = byName(*result);
    for (std::size_t q = 0; q < table.quantities.size(); ++q) {
      const std::string& name = table.quantities[q].name;
      numbers[q][at].push_back({numberAt(cells, name), numberAt(cells, name + ".standard_error"),
                                numberAt(cells, name + ".low95"), numberAt(cells, name + ".high95"),
                                numberAt(cells, name + ".effective_samples")});
      const double theory = numberAt(cells, name + ".theory");
      if (std::isfinite(theory)) point.theory[q] = theory;
    }
    for (const auto& [name, cell] : result->columns) {
      const auto* text = std::get_if<std::string>(&cell);
      if (text != nullptr && name.ends_with("verdict")) ++point.verdicts[name][*text];
    }
  }
  for (const Numbers& one : numbers) {
    const std::vector<PooledNumber> pooled = pool(one);
    for (std::size_t i = 0; i < pooled.size(); ++i) table.points[i].numbers.push_back(pooled[i]);
  }
  return table;
}

std::string runsCsv(const CampaignData& data) {
  const std::vector<std::string> columns = columnNames(data);
  std::string text = "row,point,replicate,run,seed,status,code,faults,closed_early";
  for (const Axis& axis : data.axes) text += "," + csvText(axis.key);
  for (const std::string& column : columns) text += "," + csvText(column);
  text += "\n";
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const Row& row = data.rows[i];
    const RunResult* result = resultOf(data, i);
    text += fmt::format("{},{},{},{},{},{}", i, row.point, row.replicate, row.identity.text(),
                        row.seed, statusText(data.survey.rows[i].kind));
    text += result == nullptr ? ",,,"
                              : fmt::format(",{},{},{}", csvText(result->code),
                                            result->faults.size(), result->closed_early ? 1 : 0);
    for (const std::string& value : data.points[row.point].values) text += "," + csvText(value);
    if (result == nullptr) {
      text += std::string(columns.size(), ',');
    } else {
      const auto cells = byName(*result);
      for (const std::string& column : columns) {
        const auto found = cells.find(column);
        text += "," + (found == cells.end() ? std::string() : csvCell(*found->second));
      }
    }
    text += "\n";
  }
  return text;
}

std::string pointsCsv(const CampaignData& data, const PooledTable& pooled) {
  std::map<std::string, std::set<std::string>> verdicts;
  for (const PooledPoint& point : pooled.points) {
    for (const auto& [name, counts] : point.verdicts) {
      for (const auto& [verdict, count] : counts) verdicts[name].insert(verdict);
    }
  }
  std::string text = "point";
  for (const Axis& axis : data.axes) text += "," + csvText(axis.key);
  text += ",runs,stale,with_faults";
  for (const auto& [name, words] : verdicts) {
    for (const std::string& word : words) text += "," + csvText(name + "." + word);
  }
  for (const Quantity& quantity : pooled.quantities) {
    for (const char* part : {"", ".standard_error", ".low95", ".high95"}) {
      text += "," + csvText(quantity.name + part);
    }
    if (quantity.has_errors) text += "," + csvText(quantity.name + ".between_runs");
    if (quantity.has_theory) text += "," + csvText(quantity.name + ".theory");
  }
  text += "\n";
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const PooledPoint& point = pooled.points[i];
    text += std::to_string(i);
    for (const std::string& value : data.points[i].values) text += "," + csvText(value);
    text += fmt::format(",{},{},{}", point.runs, point.stale, point.faults);
    for (const auto& [name, words] : verdicts) {
      const auto counts = point.verdicts.find(name);
      for (const std::string& word : words) {
        const bool any = counts != point.verdicts.end() && counts->second.contains(word);
        text += fmt::format(",{}", any ? counts->second.at(word) : 0);
      }
    }
    for (std::size_t q = 0; q < pooled.quantities.size(); ++q) {
      const PooledNumber& number = point.numbers[q];
      for (const double value : {number.mean, number.sigma, number.low95, number.high95}) {
        text += "," + pooledText(value);
      }
      if (pooled.quantities[q].has_errors) text += "," + pooledText(number.between);
      if (pooled.quantities[q].has_theory) text += "," + pooledText(point.theory[q]);
    }
    text += "\n";
  }
  return text;
}

std::string campaignJson(const CampaignData& data, const PooledTable& pooled) {
  Json json;
  json["format"] = kTableFormat;
  json["name"] = data.request.name;
  json["created"] = data.created;
  json["code"] = data.code.text;
  json["common_seeds"] = data.request.common_seeds;
  json["axes"] = axesJson(data);
  Json counts;
  for (const auto kind : {RowState::Kind::kDone, RowState::Kind::kStale, RowState::Kind::kFailed,
                          RowState::Kind::kDamaged, RowState::Kind::kMissing}) {
    counts[statusText(kind)] = data.survey.count(kind);
  }
  json["counts"] = std::move(counts);
  json["points"] = pooledJson(data, pooled);
  json["runs"] = runsJson(data);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace lab::runner::campaign
