#include "dashboard/library/run_compare.hpp"

#include <array>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/text/format.hpp"
#include "common/text/json_text.hpp"

namespace lab::dashboard {
namespace {

using Json = nlohmann::ordered_json;
using lab::DisplayUnit;

/// A key of summary.json split into name and unit: "D_r_rad2_s" is D_r in rad²/s. If several units
/// fit, it is the longest one.
struct NamedUnit {
  std::string name;
  std::string unit;
};

NamedUnit splitKey(const std::string& key) {
  NamedUnit found{key, ""};
  for (const char* si :
       {"m", "m^2", "m/s", "m^2/s", "rad", "rad^2", "rad/s", "rad^2/s", "1/s", "s"}) {
    const DisplayUnit unit = lab::displayUnit(si);
    const std::string ending = "_" + unit.key;
    const std::size_t length = key.size() - ending.size();
    if (key.ends_with(ending) && length < found.name.size()) {
      found = {key.substr(0, length), unit.text};
    }
  }
  return found;
}

Json valueOr(const Json& object, const std::string& key, Json otherwise) {
  const auto found = object.find(key);
  return found == object.end() ? std::move(otherwise) : *found;
}

Json curve(const char* name, const char* si_unit, const Json& columns) {
  const DisplayUnit unit = lab::displayUnit(si_unit);
  const auto column = [&columns](const std::string& key) {
    return valueOr(columns, key, Json::array());
  };
  return {{"name", name},
          {"unit", unit.text},
          {"lag", column("lag_s")},
          {"value", column("value_" + unit.key)},
          {"sigma", column("standard_error_" + unit.key)},
          {"exact", column("exact_" + unit.key)},
          {"paper", column("paper_" + unit.key)},
          {"windows", column("windows")},
          {"biased", column("selection_biased")}};
}

Json estimates(const Json& pool) {
  Json all = Json::array();
  const auto found = pool.find("estimates");
  if (found == pool.end() || !found->is_object()) return all;
  for (const auto& [key, estimate] : found->items()) {
    if (!estimate.is_object()) continue;
    const NamedUnit named = splitKey(key);
    all.push_back({{"name", named.name},
                   {"unit", named.unit},
                   {"value", valueOr(estimate, "value", {})},
                   {"sigma", valueOr(estimate, "standard_error", {})},
                   {"low", valueOr(estimate, "low95", {})},
                   {"high", valueOr(estimate, "high95", {})},
                   {"theory", valueOr(estimate, "theory", {})},
                   {"note", valueOr(estimate, "note", "")}});
  }
  return all;
}

}  // namespace

Json curvesOf(const std::string& run, const std::string& summary) {
  const Json json = parseJsonText<Json>(summary);
  if (!json.is_object() || !json.contains("programs") || !json["programs"].is_array()) {
    throw std::runtime_error(run +
                             ": its summary.json cannot be read; lab analyze creates it again");
  }
  Json all = Json::array();
  for (const Json& program : json["programs"]) {
    if (!program.is_object() || !program.contains("pool") || !program["pool"].is_object()) continue;
    const Json& pool = program["pool"];
    Json curves = Json::array();
    if (pool.contains("msd")) curves.push_back(curve("msd", "m^2", pool["msd"]));
    if (pool.contains("angular_msd")) {
      curves.push_back(curve("angular_msd", "rad^2", pool["angular_msd"]));
    }
    all.push_back({{"run", run},
                   {"program", valueOr(program, "name", "")},
                   {"model", valueOr(program, "model", "")},
                   {"verdict", valueOr(pool, "verdict", {})},
                   {"max_z", valueOr(pool, "max_z", {})},
                   {"curves", std::move(curves)},
                   {"estimates", estimates(pool)}});
  }
  return all;
}

}  // namespace lab::dashboard
