#include "runner/campaign/campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <optional>
#include <utility>

#include "common/experiment/keys/key_visitor.hpp"
#include "common/files/experiment_error.hpp"
#include "common/files/file_values.hpp"
#include "common/files/toml_document.hpp"
#include "common/math/random.hpp"
#include "common/text/nearest_word.hpp"
#include "light/field/image.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {
namespace {

constexpr std::int64_t kFileVersion = 1;
constexpr std::size_t kRecipeDigits = 16;
constexpr std::size_t kCodeDigits = 8;
// TOML has signed integers.
constexpr std::uint64_t kLargestSeed = std::numeric_limits<std::int64_t>::max();
// What the experiment file and the command line accept. A campaign may come from a stranger.
constexpr keys::TextRule kExperimentName{.most = 64, .as_folder = true};
constexpr keys::Range kSeeds{.low = 1, .high = 100'000, .whole = true};
constexpr keys::Range kDrawnPoints{
    .low = 0, .high = static_cast<double>(kMostPoints), .whole = true};
constexpr keys::Range kTries{.low = 1, .high = 100, .whole = true};
constexpr keys::Range kRunsPerRound{.low = 1, .high = 1000, .whole = true};
constexpr keys::Range kPause_s{.low = 0, .high = 86'400};
constexpr keys::Range kRobotTime_s{.low = 0, .high = 1e9};
constexpr keys::Range kGoalError{.low = 0, .high = 1e12};
constexpr keys::Range kGoalLevel{.low = -1e12, .high = 1e12};
constexpr keys::Range kUntil_us{.low = 0, .high = 253'402'300'799e6};  // the end of the year 9999

constexpr std::array<std::pair<Keep, const char*>, 3> kKeeps{
    {{Keep::kLogs, "logs"}, {Keep::kSummary, "summary"}, {Keep::kNothing, "nothing"}}};

const char* nameOf(AdaptiveGoal goal) {
  if (goal == AdaptiveGoal::kLaw) return "law";
  return goal == AdaptiveGoal::kBoundary ? "boundary" : "mean";
}

std::string listText(const std::vector<std::string>& texts) {
  std::string list = "[";
  for (const std::string& text : texts) {
    list += (list.size() > 1 ? ",\n  " : "\n  ") + keys::tomlString(text);
  }
  return list + (texts.empty() ? "]" : ",\n]");
}

/// Reads the keys of campaign.toml. A missing or wrong key is an error, because the file is written
/// by this program.
class RequestReader {
 public:
  RequestReader(const keys::TomlDocument& document, std::string name)
      : root_(document.root()), name_(std::move(name)) {}

  template <class T>
  [[nodiscard]] T get(const char* key) const {
    const toml::node* node = root_.get(key);
    if (node != nullptr) {
      if (const auto value = node->value_exact<T>()) return *value;
    }
    fail(key);
  }

  template <class T>
  [[nodiscard]] T get(const char* key, const keys::Range& range) const {
    const T value = get<T>(key);
    if (!range.contains(static_cast<double>(value))) fail(key, range.text());
    return value;
  }

  [[nodiscard]] std::vector<std::string> texts(const char* key) const {
    const toml::node* node = root_.get(key);
    if (node == nullptr || !node->is_array()) fail(key);
    std::vector<std::string> all;
    for (const toml::node& item : *node->as_array()) {
      const auto text = item.value_exact<std::string>();
      if (!text) fail(key);
      all.push_back(*text);
    }
    return all;
  }

  [[noreturn]] void fail(const char* key,
                         const std::string& expected = "what lab sweep writes") const {
    const toml::node* node = root_.get(key);
    throw ExperimentError({fmt::format(
        "{}: {}: found {}, expected {}; the file was changed or is damaged. lab sweep FILE --out "
        "FOLDER writes it again, results stay",
        name_, key, node == nullptr ? "nothing" : keys::displayText(*node), expected)});
  }

 private:
  const toml::table& root_;
  std::string name_;
};

std::string liveText(const LivePlan& plan) {
  std::vector<std::string> known;
  for (const KnownRule& rule : plan.known) known.push_back(knownRuleText(rule));
  return fmt::format(
      "# Played on a real lab, unless it is a rehearsal.\nrehearsal = {}\nrest_s = {:.6f}\nclear = "
      "{}\ntries = {}\nstrikes = {}\n"
      "until_us = {}\n"
      "known = {}\n",
      plan.rehearsal, plan.rest_s, keys::tomlString(plan.clear), plan.tries, plan.strikes,
      plan.until_us, listText(known));
}

LivePlan readLivePlan(const RequestReader& read) {
  LivePlan plan;
  plan.rehearsal = read.get<bool>("rehearsal");
  plan.rest_s = read.get<double>("rest_s", kPause_s);
  plan.clear = read.get<std::string>("clear");
  // Becomes an argument of lab run, which must not take it for an option.
  if (!plan.clear.empty() && plan.clear.front() != '/') {
    read.fail("clear", "an absolute path, or nothing");
  }
  plan.tries = read.get<std::int64_t>("tries", kTries);
  plan.strikes = read.get<std::int64_t>("strikes", kTries);
  plan.until_us = read.get<std::int64_t>("until_us", kUntil_us);
  for (const std::string& rule : read.texts("known")) plan.known.push_back(parseKnownRule(rule));
  return plan;
}

std::string adaptiveText(const AdaptivePlan& plan) {
  return fmt::format(
      "# Chooses where to measure next.\ngoal = {}\nquantity = {}\nparameter = {}\nrelative = "
      "{}\nlevel = {:.16e}\nrobot_time_s = {:.6f}\nerror = {:.16e}\nruns_per_round = "
      "{}\nbetween_runs_s = {:.6f}\n",
      keys::tomlString(nameOf(plan.goal)), keys::tomlString(plan.quantity),
      keys::tomlString(plan.parameter), plan.relative, plan.level, plan.robot_time_s, plan.error,
      plan.runs_per_round, plan.between_runs_s);
}

AdaptivePlan readAdaptivePlan(const RequestReader& read) {
  AdaptivePlan plan;
  const auto goal = read.get<std::string>("goal");
  for (const AdaptiveGoal known : {AdaptiveGoal::kLaw, AdaptiveGoal::kBoundary}) {
    if (goal == nameOf(known)) plan.goal = known;
  }
  plan.quantity = read.get<std::string>("quantity");
  plan.parameter = read.get<std::string>("parameter");
  plan.relative = read.get<bool>("relative");
  plan.level = read.get<double>("level", kGoalLevel);
  plan.robot_time_s = read.get<double>("robot_time_s", kRobotTime_s);
  plan.error = read.get<double>("error", kGoalError);
  plan.runs_per_round = read.get<std::int64_t>("runs_per_round", kRunsPerRound);
  plan.between_runs_s = read.get<double>("between_runs_s", kPause_s);
  return plan;
}

}  // namespace

const char* nameOf(Keep keep) {
  return std::ranges::find(kKeeps, keep, [](const auto& pair) { return pair.first; })->second;
}

bool isOnRealLab(const Request& request) { return request.live && !request.live->rehearsal; }

Design Request::design() const { return {parseAxes(over), zip, random, sampling, seed}; }

std::string requestText(const Request& request, const std::string& created) {
  std::string text = fmt::format(
      "# What was asked of this campaign. lab sweep FOLDER{} continues it (docs/campaigns.md).\n"
      "fileversion = {}\ncreated = {}\nname = {}\nfile = {}\nset = {}\nover = {}\nzip = {}\n"
      "seeds = {}\nrandom = {}\nsampling = {}\nseed = {}\ncommon_seeds = {}\nkeep = {}\nfits = "
      "{}\n",
      isOnRealLab(request) ? " --live" : "", kFileVersion, keys::tomlString(created),
      keys::tomlString(request.name), keys::tomlString(request.file), listText(request.set),
      listText(request.over), request.zip, request.seeds, request.random,
      request.sampling == Sampling::kSobol ? "\"sobol\"" : "\"latin\"", request.seed,
      request.common_seeds, keys::tomlString(nameOf(request.keep)), request.fits);
  if (request.live) text += liveText(*request.live);
  if (request.adaptive) text += adaptiveText(*request.adaptive);
  return text;
}

Request readRequest(std::string_view text, const std::string& name) {
  const keys::TomlDocument document(text, name, {});
  const RequestReader read(document, name);
  if (read.get<std::int64_t>("fileversion") != kFileVersion) {
    throw ExperimentError({name + ": found another fileversion, expected " +
                           std::to_string(kFileVersion) +
                           ": another version of the lab wrote this campaign"});
  }
  Request request;
  request.name = read.get<std::string>("name");
  // Goes into the scripts of engines.
  if (!kExperimentName.accepts(request.name)) read.fail("name", kExperimentName.text());
  request.file = read.get<std::string>("file");
  request.set = read.texts("set");
  request.over = read.texts("over");
  request.zip = read.get<bool>("zip");
  request.seeds = read.get<std::int64_t>("seeds", kSeeds);
  request.random = read.get<std::int64_t>("random", kDrawnPoints);
  request.sampling =
      read.get<std::string>("sampling") == "sobol" ? Sampling::kSobol : Sampling::kLatin;
  request.seed = static_cast<std::uint64_t>(read.get<std::int64_t>("seed"));
  request.common_seeds = read.get<bool>("common_seeds");
  const auto keep = read.get<std::string>("keep");
  const auto* const known =
      std::ranges::find(kKeeps, keep, [](const auto& pair) { return std::string(pair.second); });
  if (known == kKeeps.end()) read.fail("keep");
  request.keep = known->first;
  request.fits = read.get<bool>("fits");
  if (document.root().contains("rest_s")) request.live = readLivePlan(read);
  if (document.root().contains("runs_per_round")) request.adaptive = readAdaptivePlan(read);
  return request;
}

void requireFewRows(const Request& request, std::size_t points, const std::string& where) {
  const double rows = static_cast<double>(points) * static_cast<double>(request.seeds);
  if (rows <= static_cast<double>(kMostRows)) return;
  throw UserError(
      fmt::format("{}: found {} points with {} seeds each, allowed {} runs; give fewer values or "
                  "seeds",
                  where, points, request.seeds, kMostRows));
}

Point makePoint(PointValues values, std::string experiment, double duration) {
  std::string hash = sha256Of(experiment);
  return {std::move(values), std::move(experiment), std::move(hash), duration};
}

std::uint64_t seedOf(const Request& request, const Point& point, std::int64_t replicate) {
  const std::string purpose = request.common_seeds ? "campaign" : "campaign " + point.hash;
  return deriveSeed(request.seed, replicate, purpose) & kLargestSeed;
}

std::vector<Row> rowsOf(const Request& request, const std::vector<Point>& points,
                        const CodeVersion& code) {
  const std::string version =
      request.live ? "measured" : fmt::format("{} contract {}", code.text, code.contract);
  const std::string code_hash = sha256Of(version).substr(0, kCodeDigits);
  std::vector<Row> rows;
  rows.reserve(points.size() * static_cast<std::size_t>(request.seeds));
  for (std::int64_t replicate = 0; replicate < request.seeds; ++replicate) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      Row row{i, replicate, seedOf(request, points[i], replicate), {}};
      row.identity.recipe = sha256Of(fmt::format("{} seed {} {}", points[i].hash, row.seed,
                                                 request.fits ? "with fits" : "without fits"))
                                .substr(0, kRecipeDigits);
      row.identity.code = code_hash;
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

std::vector<std::size_t> parseRowNumbers(const std::string& text, std::size_t count) {
  const auto refuse = [&](std::string_view part) -> UserError {
    return UserError(
        fmt::format("--rows {}: found {}, expected numbers of rows from 0 to {}, as 0-3,7", text,
                    part.empty() ? "nothing" : part, count == 0 ? 0 : count - 1));
  };
  const auto number = [&](std::string_view part) {
    std::size_t value = 0;
    const auto read = std::from_chars(part.data(), part.data() + part.size(), value);
    if (read.ec != std::errc() || read.ptr != part.data() + part.size() || value >= count) {
      throw refuse(part);
    }
    return value;
  };
  std::vector<std::size_t> numbers;
  std::string_view rest = text;
  while (true) {
    const std::string_view part = rest.substr(0, rest.find(','));
    const std::size_t dash = part.find('-');
    const std::size_t first = number(part.substr(0, dash));
    const std::size_t last = dash == std::string_view::npos ? first : number(part.substr(dash + 1));
    if (last < first) throw refuse(part);
    for (std::size_t i = first; i <= last; ++i) numbers.push_back(i);
    if (part.size() == rest.size()) return numbers;
    rest.remove_prefix(part.size() + 1);
  }
}

std::string rowNumbersText(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t end = i + 1;
    while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
    text += (text.empty() ? "" : ",") + std::to_string(numbers[i]);
    if (end > i + 1) text += "-" + std::to_string(numbers[end - 1]);
    i = end;
  }
  return text;
}

std::string sha256Of(std::string_view text) {
  return light::sha256({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

}  // namespace lab::runner::campaign
