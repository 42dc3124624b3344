#include "dashboard/library/campaign_list.hpp"

#include <signal.h>

#include <algorithm>
#include <cerrno>
#include <nlohmann/json.hpp>
#include <system_error>
#include <tuple>

#include "common/files/file_text.hpp"
#include "common/files/output_links.hpp"
#include "common/text/json_text.hpp"
#include "dashboard/library/served_file.hpp"
#include "dashboard/web/json.hpp"

namespace lab::dashboard {
namespace fs = std::filesystem;
namespace {

constexpr FileKind kProgressFile{"the progress of a campaign", 100'000};

bool isCampaignFolder(const fs::path& folder) {
  std::error_code error;
  return fs::is_regular_file(folder / "campaign.toml", error);
}

bool isAlive(std::int64_t pid) {
  return pid > 0 && pid <= 1 << 22 && (kill(static_cast<pid_t>(pid), 0) == 0 || errno == EPERM);
}

template <class T>
T valueOf(const nlohmann::json& json, const char* key, T otherwise) {
  const auto found = json.find(key);
  if (found == json.end()) return otherwise;
  const bool fits = std::is_same_v<T, std::string> ? found->is_string()
                    : std::is_same_v<T, bool>      ? found->is_boolean()
                                                   : found->is_number();
  return fits ? found->get<T>() : otherwise;
}

/// Reads the folder of one campaign. Does not throw because of its content.
CampaignFacts factsOf(const fs::path& folder) {
  CampaignFacts facts;
  facts.name = folder.filename().string();
  std::error_code error;
  facts.page = fs::is_regular_file(folder / "index.html", error);
  facts.live = fs::is_regular_file(folder / "journal.jsonl", error);
  const std::optional<std::string> text = readWholeFile(folder / "progress.json", kProgressFile);
  const auto json = parseJsonText(text.value_or(""));
  if (!json.is_object()) return facts;
  facts.updated_utc = valueOf(json, "updated", std::string());
  facts.total = valueOf<std::int64_t>(json, "total", 0);
  facts.done = valueOf<std::int64_t>(json, "done", 0);
  facts.failed = valueOf<std::int64_t>(json, "failed", 0);
  facts.running = valueOf(json, "running", false) && isAlive(valueOf<std::int64_t>(json, "pid", 0));
  const auto left = json.find("seconds_left");
  if (left != json.end() && left->is_number()) facts.seconds_left = left->get<double>();
  return facts;
}

}  // namespace

std::vector<CampaignFacts> CampaignList::campaigns() const {
  std::vector<CampaignFacts> all;
  std::error_code error;
  for (fs::directory_iterator entry(folder_, error), end; !error && entry != end;
       entry.increment(error)) {
    const bool hidden = entry->path().filename().string().starts_with('.');
    if (!hidden && isCampaignFolder(entry->path())) all.push_back(factsOf(entry->path()));
  }
  std::ranges::sort(all, [](const CampaignFacts& one, const CampaignFacts& other) {
    return std::tie(one.running, one.updated_utc, one.name) >
           std::tie(other.running, other.updated_utc, other.name);
  });
  return all;
}

std::string CampaignList::json() const {
  auto all = nlohmann::ordered_json::array();
  for (const CampaignFacts& one : campaigns()) {
    all.push_back(
        {{"name", one.name},
         {"updated_utc", one.updated_utc.empty() ? nlohmann::ordered_json()
                                                 : nlohmann::ordered_json(one.updated_utc)},
         {"total", one.total},
         {"done", one.done},
         {"failed", one.failed},
         {"running", one.running},
         {"live", one.live},
         {"seconds_left",
          one.seconds_left ? nlohmann::ordered_json(*one.seconds_left) : nlohmann::ordered_json()},
         {"page", one.page}});
  }
  return toText(all);
}

std::optional<fs::path> CampaignList::file(std::string_view campaign, std::string_view name) const {
  constexpr std::string_view kRuns = "runs/";
  if (!isPlainName(campaign)) return std::nullopt;
  fs::path folder = folder_ / campaign;
  if (!isCampaignFolder(folder)) return std::nullopt;
  if (name.starts_with(kRuns)) {
    name.remove_prefix(kRuns.size());
    const std::string_view run = name.substr(0, name.find('/'));
    if (!isPlainName(run) || run.size() == name.size()) return std::nullopt;
    folder /= "runs";
    if (isLink(folder) || isLink(folder / run)) return std::nullopt;
    folder /= run;
    name.remove_prefix(run.size() + 1);
  }
  return servedFile(folder, name);
}

}  // namespace lab::dashboard
