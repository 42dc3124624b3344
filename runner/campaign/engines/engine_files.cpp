#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "common/files/atomic_file.hpp"
#include "common/files/file_text.hpp"
#include "common/text/json_text.hpp"
#include "runner/campaign/campaign_folder.hpp"
#include "runner/campaign/engines/bundles.hpp"
#include "runner/campaign/engines/engine.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/command_line/output_file.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

constexpr FileKind kBundleFile{"results of a host", 4'000'000'000};

/// Snakemake is run in the campaign's folder, which may come from a stranger.
void refuseSnakemakeSettings(const fs::path& folder) {
  refuseLink(folder / ".snakemake");  // its notes
  const fs::path profiles = folder / "profiles";
  std::error_code error;
  if (!fs::exists(fs::symlink_status(profiles, error))) return;
  throw UserError(fmt::format(
      "{}: found settings that Snakemake would apply, also commands, expected none in a campaign; "
      "remove them, or choose another --engine",
      profiles.string()));
}

}  // namespace

void refreshRows(CampaignData& data, const fs::path& folder, const std::vector<std::size_t>& rows) {
  for (const std::size_t row : rows) {
    RowState& state = data.survey.rows[row];
    if (state.kind == RowState::Kind::kDone) continue;
    RowState now = readRow(folder, data.rows[row].identity);
    // A stale result stays until the new one is there.
    if (now.kind == RowState::Kind::kMissing && state.kind == RowState::Kind::kStale) continue;
    state = std::move(now);
  }
}

std::vector<std::size_t> missingRows(const CampaignData& data,
                                     const std::vector<std::size_t>& rows) {
  std::vector<std::size_t> missing;
  for (const std::size_t row : rows) {
    const auto kind = data.survey.rows[row].kind;
    if (kind == RowState::Kind::kDone || kind == RowState::Kind::kFailed) continue;
    missing.push_back(row);
  }
  return missing;
}

std::vector<std::string> writeSnakefile(const fs::path& folder,
                                        const std::vector<std::size_t>& rows,
                                        const EngineOptions& options) {
  const fs::path campaign = fs::absolute(folder).lexically_normal();
  const std::vector<Bundle> bundles = bundlesOf(rows, options.bundle);
  refuseSnakemakeSettings(folder);
  std::error_code ignored;
  fs::remove_all(folder / "snakemake", ignored);  // marks of other bundles
  replaceFile(folder / "Snakefile", snakefileText(options.lab, campaign, bundles));
  return {fmt::format("workflow {} ({} jobs)", (folder / "Snakefile").string(), bundles.size()),
          fmt::format("run it   snakemake --cores all --directory {0} --snakefile {0}/Snakefile",
                      shellWord(campaign.string()))};
}

std::vector<std::string> writeCommands(const fs::path& folder, const std::vector<std::size_t>& rows,
                                       const EngineOptions& options) {
  const fs::path campaign = fs::absolute(folder).lexically_normal();
  const std::vector<Bundle> bundles = bundlesOf(rows, options.bundle);
  const fs::path file = campaign / "commands.txt";
  replaceFile(file, commandsText(options.lab, campaign, bundles));
  return {
      fmt::format("commands {} ({} lines, to be run in any order)",
                  (folder / "commands.txt").string(), bundles.size()),
      fmt::format("run them xargs -P 8 -d '\\n' -I LINE sh -c LINE < {}", shellWord(file.string())),
      fmt::format("then     {} sweep {} --no-run", shellWord(options.lab.string()),
                  shellWord(campaign.string()))};
}

void writeResultBundle(const CampaignData& data, const fs::path& folder,
                       const std::vector<std::size_t>& rows, const fs::path& file) {
  std::string text;
  const auto add = [&](const fs::path& name) {
    if (const auto content = readWholeFile(folder / name, kBundleFile)) {
      text += nlohmann::ordered_json{{"file", name.string()}, {"text", *content}}.dump(
                  -1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) +
              "\n";
    }
  };
  for (const std::size_t row : rows) {
    const RunIdentity& run = data.rows[row].identity;
    add(summaryFile(run));
    add(resultFile(run));
    add(failureFile(run));
  }
  replaceFile(file, text);
}

void takeResultBundle(CampaignData& data, const fs::path& folder, const fs::path& file) {
  const auto text = readWholeFile(file, kBundleFile);
  if (!text) return;
  std::map<std::string, std::size_t> known;  // rows by the names of their files
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const RunIdentity& run = data.rows[i].identity;
    for (const fs::path& name : {resultFile(run), summaryFile(run), failureFile(run)}) {
      known[name.string()] = i;
    }
  }
  for (std::size_t begin = 0; begin < text->size();) {
    const std::size_t end = std::min(text->find('\n', begin), text->size());
    const auto line = parseJsonText(std::string_view(*text).substr(begin, end - begin));
    begin = end + 1;
    if (!line.is_object() || !line.contains("file") || !line.contains("text")) continue;
    const auto row = known.find(line.value("file", ""));
    if (row == known.end() || !line["text"].is_string()) continue;
    const std::string content = line["text"];
    const RunIdentity& run = data.rows[row->second].identity;
    const bool result = row->first == resultFile(run).string();
    if (result && readResult(content, run).get() == nullptr) continue;
    fs::create_directories((folder / row->first).parent_path());
    replaceFile(folder / row->first, content);
    data.survey.rows[row->second] = readRow(folder, run);
  }
}

}  // namespace lab::runner::campaign
