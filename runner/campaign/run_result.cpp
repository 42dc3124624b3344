#include "runner/campaign/run_result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "common/bus/count_limits.hpp"
#include "common/math/saturated.hpp"
#include "common/text/json_text.hpp"

namespace lab::runner::campaign {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kResultFormat = 1;
constexpr auto kReplace = Json::error_handler_t::replace;

// Sections of summary.json that describe the recording or the instrument, not the motion.
constexpr std::array<std::string_view, 12> kNotOfMotion{
    "format",  "seed",  "contract_version", "poses",  "stitching",    "robots",
    "latency", "steps", "virtual_senses",   "losses", "serial_lines", "links"};
// Parts of a path that name no quantity.
constexpr std::array<std::string_view, 5> kSilent{"pool", "estimates", "parameters", "derived",
                                                  "value"};
// Lists and tables, which are null where there is nothing to list.
constexpr std::array<std::string_view, 3> kLists{"joins", "light_bands", "marks"};
// Texts of a program that are results.
constexpr std::array<std::string_view, 1> kTexts{"verdict"};

template <class List>
bool contains(const List& list, std::string_view word) {
  return std::ranges::find(list, word) != list.end();
}

/// "_cm2_s2" of "cm²/s²"; empty of "1".
std::string unitSuffix(const std::string& unit) {
  if (unit.empty() || unit == "1") return {};
  std::string suffix = "_" + unit;
  for (std::size_t at = 0; (at = suffix.find("²", at)) != std::string::npos;) {
    suffix.replace(at, std::string_view("²").size(), "2");
  }
  std::ranges::replace(suffix, '/', '_');
  if (suffix.starts_with("_1_")) suffix = "_per_" + suffix.substr(3);
  return suffix;
}

/// Collects the leaves of a summary.
class Collector {
 public:
  void object(const Json& json, const std::string& path) {
    for (const auto& [key, value] : json.items()) {
      if (path.empty() && contains(kNotOfMotion, key)) continue;
      if (path.empty() && key == "programs") {
        programs(value);
        continue;
      }
      if (path.empty() && key == "collective" && value.is_array()) {
        for (const Json& group : value) crowd(group);
        continue;
      }
      const bool silent = contains(kSilent, key);
      leaf(key, value, silent ? path : path + (path.empty() ? "" : ".") + key);
    }
  }

  Columns take() { return std::move(columns_); }

 private:
  void programs(const Json& all) {
    if (!all.is_array()) return;
    for (const Json& program : all) {
      if (!program.is_object() || !program.contains("pool")) continue;
      const std::string name = program.value("name", "program");
      if (program["pool"].is_object()) object(program["pool"], name);
      for (const auto& [key, value] : program.items()) {
        // What later versions know of a program, beside the pool.
        if (key != "pool" && value.is_object()) object(value, name + "." + key);
      }
    }
  }

  /// What all robots, or those of a program, did together.
  void crowd(const Json& group) {
    if (!group.is_object()) return;
    const std::string robots = group.value("robots", "");
    const std::string path = robots == "all robots" ? "collective" : "collective." + robots;
    averages(group.value("numbers", Json::object()), path);
    for (const char* places : {"regions", "light_bands"}) {
      for (const Json& place : group.value(places, Json::array())) {
        if (!place.is_object()) continue;
        averages(place, path + "." + places + "." + place.value("name", ""));
      }
    }
  }

  void averages(const Json& all, const std::string& path) {
    for (const auto& [name, average] : all.items()) {
      if (!average.is_object() || !average.contains("value")) continue;
      const std::string column = path + "." + name + unitSuffix(average.value("unit", ""));
      for (const auto& [key, value] : average.items()) {
        // The same name as in the pooled estimates of a program.
        const std::string part = key == "independent_blocks" ? "effective_samples" : key;
        leaf(part, value, key == "value" ? column : column + "." + part);
      }
    }
  }

  void leaf(const std::string& key, const Json& value, const std::string& path) {
    if (value.is_object()) {
      object(value, path);
    } else if (value.is_number()) {
      add(path, value.get<double>());
    } else if (value.is_boolean()) {
      add(path, value.get<bool>() ? 1.0 : 0.0);
    } else if (value.is_string() && contains(kTexts, key)) {
      add(path, value.get<std::string>());
    } else if (value.is_null() && !contains(kLists, key)) {
      add(path, {});
    }
  }

  void add(const std::string& path, Cell cell) {
    if (path.empty() || !names_.insert(path).second) return;
    columns_.emplace_back(path, std::move(cell));
  }

  Columns columns_;
  std::set<std::string> names_;
};

std::int64_t lostMessages(const Json& summary) {
  std::int64_t lost = 0;
  if (!summary.contains("losses") || !summary["losses"].contains("log")) return 0;
  for (const Json& stream : summary["losses"]["log"]) {
    const auto of_stream = std::max(std::int64_t{0}, stream.value("lost", std::int64_t{0}));
    lost = limitedSum(lost, of_stream, kMostCounted);
  }
  return lost;
}

Json cellJson(const Cell& cell) {
  if (const auto* number = std::get_if<double>(&cell)) return *number;
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  return nullptr;
}

Json withoutChecksum(const RunResult& result) {
  Json columns = Json::object();
  for (const auto& [name, cell] : result.columns) columns[name] = cellJson(cell);
  return {{"format", kResultFormat},
          {"recipe", result.identity.recipe},
          {"code_hash", result.identity.code},
          {"code", result.code},
          {"seed", result.seed},
          {"closed_early", result.closed_early},
          {"faults", result.faults},
          {"columns", std::move(columns)}};
}

std::string checksumOf(const Json& json) { return sha256Of(json.dump(-1, ' ', false, kReplace)); }

RunResult fromJson(const Json& json) {
  RunResult result;
  result.identity = {json.at("recipe"), json.at("code_hash")};
  result.code = json.at("code");
  result.seed =
      wholeNumber<std::uint64_t>(json.at("seed"), 0, std::numeric_limits<std::uint64_t>::max());
  result.closed_early = json.at("closed_early");
  result.faults = json.at("faults").get<std::vector<std::string>>();
  for (const auto& [name, value] : json.at("columns").items()) {
    Cell cell;
    if (value.is_number()) cell = value.get<double>();
    if (value.is_string()) cell = value.get<std::string>();
    result.columns.emplace_back(name, std::move(cell));
  }
  return result;
}

}  // namespace

std::string resultText(const RunResult& result) {
  Json json = withoutChecksum(result);
  json["sha256"] = checksumOf(json);
  return json.dump(1, ' ', false, kReplace) + "\n";
}

ReadResult readResult(std::string_view text, const RunIdentity& expected) {
  Json json = parseJsonText<Json>(text);
  if (!json.is_object()) return {"is cut off or is no JSON"};
  const auto checksum = json.find("sha256");
  if (checksum == json.end() || !checksum->is_string()) return {"has no checksum"};
  const std::string stated = checksum->get<std::string>();
  json.erase("sha256");
  if (checksumOf(json) != stated) return {"does not have its checksum"};
  try {
    if (json.at("format") != kResultFormat) return {"is of another version of the lab"};
    RunResult result = fromJson(json);
    if (!(result.identity == expected)) return {"is the result of another run"};
    return {std::move(result)};
  } catch (const Json::exception&) {
    return {"lacks a key"};
  } catch (const std::out_of_range& error) {
    return {error.what()};
  }
}

Columns columnsOf(std::string_view summary_json) {
  const Json summary = parseJsonText<Json>(summary_json);
  if (!summary.is_object()) throw std::runtime_error("the run has no readable summary");
  Collector collector;
  collector.object(summary, "");
  Columns columns = collector.take();
  columns.emplace_back("lost_messages", static_cast<double>(lostMessages(summary)));
  if (summary.contains("losses")) {
    columns.emplace_back("camera_frames_missing",
                         summary["losses"].value("camera_frames_missing", 0.0));
  }
  return columns;
}

}  // namespace lab::runner::campaign
