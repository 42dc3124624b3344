#include "runner/campaign/sweep_request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <system_error>
#include <utility>
#include <vector>

#include "common/experiment/experiment_file.hpp"
#include "common/experiment/sweep.hpp"
#include "common/files/file_text.hpp"
#include "common/loop/wall_clock.hpp"
#include "runner/command_line/command_line_parts.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;

namespace {

LivePlan livePlanOf(const SweepOptions& options) {
  LivePlan plan;
  plan.rehearsal = options.rehearse;
  plan.rest_s = options.rest_s;
  if (!options.clear.empty()) {
    static_cast<void>(loadExperiment(options.clear));
    plan.clear = fs::absolute(options.clear).lexically_normal().string();
  }
  plan.tries = options.tries;
  plan.strikes = options.strikes;
  if (!options.until.empty()) plan.until_us = parseUntil(options.until, wallClock());
  for (const std::string& rule : options.known) plan.known.push_back(parseKnownRule(rule));
  return plan;
}

/// Options that stand for a key, and settings of the same key.
void refuseContradictions(const SweepOptions& options) {
  const auto number = [&](const char* option, const char* key, const auto& value) {
    if (!value) return;
    refuseContradiction(options.set, fmt::format("{} {}", option, *value), key,
                        fmt::format("{}", *value));
  };
  number("--seed", "seed", options.seed);
  number("--seeds", "sweep.seeds", options.seeds);
  number("--random", "sweep.random", options.random);
  if (!options.sampling.empty()) {
    refuseContradiction(options.set, "--sampling " + options.sampling, "sweep.sampling",
                        options.sampling);
  }
  if (options.zip) {
    refuseContradiction(options.set, *options.zip ? "--zip" : "--no-zip", "sweep.zip",
                        *options.zip ? "true" : "false");
  }
  for (const std::string& over : options.over) {
    refuseContradiction(options.set, "--over " + over, "sweep.over", over);
  }
}

}  // namespace

Request requestOf(const SweepOptions& options, const std::string& text) {
  refuseContradictions(options);
  const SweepTable table = readSweepTable(text, options.input.string(), options.set);
  Request request;
  request.file = fs::absolute(options.input).lexically_normal().string();
  request.set = options.set;
  request.over = options.over.empty() ? table.over : options.over;
  // --over replaces the axes of the file, and what the file says about them; not what --set says.
  const auto applies = [&options](const char* key) {
    return options.over.empty() || hasSetting(options.set, key);
  };
  request.zip = options.zip.value_or(applies("sweep.zip") && table.zip);
  request.seeds = options.seeds.value_or(table.seeds);
  request.random = options.random.value_or(applies("sweep.random") ? table.random : 0);
  request.sampling = options.sampling == "sobol"   ? Sampling::kSobol
                     : options.sampling == "latin" ? Sampling::kLatin
                                                   : table.sampling;
  request.common_seeds = options.common_seeds;
  request.keep = options.keep == "logs"      ? Keep::kLogs
                 : options.keep == "nothing" ? Keep::kNothing
                                             : Keep::kSummary;
  request.fits = options.fits;
  if (options.adaptive) {
    if (!table.adaptive) {
      throw UserError(fmt::format(
          "{}: found no table [sweep.adaptive], expected one for --adaptive that says what shall "
          "be known, as goal = \"law\", quantity = \"D_r_rad2_s\", robot_time_s = 36000",
          options.input.string()));
    }
    request.adaptive = table.adaptive;
  }
  if (options.live) {
    request.live = livePlanOf(options);
    if (options.keep.empty()) request.keep = Keep::kLogs;
  }
  // The first point's experiment is valid, if any is; its name and seed are those of all.
  std::vector<std::string> settings = request.set;
  const Design design = request.design();
  if (!design.axes.empty()) {
    Design first = design;
    for (Axis& axis : first.axes) {
      if (!axis.values.empty() && first.random == 0) axis.values.resize(1);
    }
    first.random = std::min<std::int64_t>(first.random, 1);
    const PointValues values = pointsOf(first).front();
    for (std::size_t i = 0; i < values.size(); ++i) {
      settings.push_back(design.axes[i].key + "=" + values[i]);
    }
  }
  const Experiment experiment =
      parseExperiment(text, options.input.string(), settings, options.input.parent_path());
  request.name = experiment.name;
  request.seed = options.seed.value_or(experiment.seed);
  return request;
}

bool isSameRequest(const Request& one, const Request& other) {
  Request same = other;
  same.name = one.name;
  same.seed = one.seed;
  if (one.live && other.live && one.live->rehearsal == other.live->rehearsal) same.live = one.live;
  if (one.adaptive && same.adaptive) {
    // More robot time, or a smaller error, continues a campaign.
    same.adaptive->robot_time_s = one.adaptive->robot_time_s;
    same.adaptive->error = one.adaptive->error;
  }
  return one == same;
}

std::optional<fs::path> findCampaign(const fs::path& folder, const Request& request) {
  std::vector<std::pair<std::string, fs::path>> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (!isCampaign(entry->path())) continue;
    try {
      const std::string text =
          readFileText(entry->path() / names::kRequest, file_kinds::kExperiment);
      if (!isSameRequest(readRequest(text, entry->path().string()), request)) continue;
      found.emplace_back(entry->path().filename().string(), entry->path());
    } catch (const std::exception&) {
      continue;  // damaged, or of another version
    }
  }
  if (found.empty()) return {};
  return std::ranges::max(found).second;
}

}  // namespace lab::runner::campaign
