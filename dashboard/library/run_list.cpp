#include "dashboard/library/run_list.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>

#include "common/files/file_text.hpp"
#include "common/text/json_text.hpp"
#include "dashboard/library/served_file.hpp"
#include "dashboard/library/summary_scan.hpp"
#include "dashboard/web/json.hpp"

namespace lab::dashboard {
namespace fs = std::filesystem;
namespace {

constexpr const char* kSummary = "summary.json";
constexpr const char* kProvenance = "provenance.json";
constexpr const char* kThumbnail = "trajectory_program.svg";
// A summary of 250 robots on four programs has 10 MB, and the analysis has a limit of four times as
// many.
constexpr FileKind kSummaryFile{"a summary", 64U << 20U};
// Read as a tree, which takes thirty times the memory of the text.
constexpr FileKind kProvenanceFile{"the provenance of a run", 1U << 20U};

/// [ns]; 0 if there is no such file.
std::int64_t changeTime(const fs::path& path) {
  struct stat facts {};
  if (stat(path.c_str(), &facts) != 0) return 0;
  return facts.st_mtim.tv_sec * 1'000'000'000 + facts.st_mtim.tv_nsec;
}

bool isRun(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / "experiment.toml", error) || fs::exists(folder / kSummary, error) ||
         fs::exists(folder / "log.lcmlog", error);
}

/// The start time from the folder's name as the runner creates it: NAME-20260131T120000Z.
std::string startOfName(const std::string& name) {
  static const std::regex form(R"(-(\d{4})(\d\d)(\d\d)T(\d\d)(\d\d)(\d\d)Z(-\d+)?$)");
  std::smatch found;
  if (!std::regex_search(name, found, form)) return {};
  return found.format("$1-$2-$3T$4:$5:$6Z");
}

void takeProvenance(const fs::path& folder, PastRun& run) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(folder / kProvenance, error);
  if (!error && size > kProvenanceFile.most_bytes) {
    run.problem = "its provenance.json is larger than 1 MB, which no lab run writes";
    return;
  }
  const std::optional<std::string> text = readWholeFile(folder / kProvenance, kProvenanceFile);
  if (!text) return;
  const auto json = parseJsonText(*text);
  if (!json.is_object()) {
    run.problem = "its provenance.json cannot be read";
    return;
  }
  const auto started = json.find("started");
  if (started != json.end() && started->is_string()) run.start_utc = started->get<std::string>();
  const auto faults = json.find("faults");
  if (faults != json.end() && faults->is_array() && !faults->empty()) run.marked = true;
}

void takeSummary(const fs::path& folder, PastRun& run) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(folder / kSummary, error);
  if (!error && size > kSummaryFile.most_bytes) {
    run.problem =
        "its summary.json is larger than 64 MB, which no lab analyze writes; lab analyze "
        "creates it again from the log";
    return;
  }
  const std::optional<std::string> text = readWholeFile(folder / kSummary, kSummaryFile);
  if (!text) {
    run.problem =
        "no summary.json: the run is still active or was interrupted; lab analyze creates one from "
        "its "
        "log";
    return;
  }
  std::optional<SummaryFacts> facts = scanSummary(*text);
  if (!facts) {
    run.problem = "its summary.json cannot be read; lab analyze creates it again from the log";
    return;
  }
  run.experiment = std::move(facts->experiment);
  run.duration_s = facts->duration_s;
  run.marked = run.marked || facts->faults > 0;
  run.lost = facts->lost;
  for (SummaryFacts::Program& program : facts->programs) {
    run.verdicts.push_back(
        {std::move(program.name), std::move(program.verdict), program.max_z, program.restricted});
  }
}

template <class T>
nlohmann::ordered_json orNull(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

nlohmann::ordered_json orNull(const std::string& text) {
  return text.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(text);
}

nlohmann::ordered_json toJson(const PastRun& run) {
  auto verdicts = nlohmann::ordered_json::array();
  for (const RunVerdict& verdict : run.verdicts) {
    verdicts.push_back({{"program", verdict.program},
                        {"verdict", verdict.verdict},
                        {"max_z", orNull(verdict.max_z)},
                        {"restricted", verdict.restricted}});
  }
  return {{"name", run.name},
          {"experiment", orNull(run.experiment)},
          {"start_utc", orNull(run.start_utc)},
          {"duration_s", orNull(run.duration_s)},
          {"marked", run.marked},
          {"lost", orNull(run.lost)},
          {"verdicts", std::move(verdicts)},
          {"thumbnail", orNull(run.thumbnail)},
          {"report", run.report},
          {"film", run.film},
          {"problem", orNull(run.problem)}};
}

}  // namespace

PastRun readRun(const fs::path& folder) {
  PastRun run;
  run.name = folder.filename().string();
  run.start_utc = startOfName(run.name);
  takeProvenance(folder, run);
  takeSummary(folder, run);
  std::error_code error;
  if (fs::is_regular_file(folder / kThumbnail, error)) run.thumbnail = kThumbnail;
  run.report = fs::is_regular_file(folder / "report.html", error);
  run.film = fs::is_regular_file(folder / "film.mp4", error) &&
             fs::is_regular_file(folder / "film_clip.json", error);
  return run;
}

std::vector<PastRun> RunList::runs() {
  const std::lock_guard lock(mutex_);
  std::map<std::string, Known> now;
  std::error_code error;
  for (fs::directory_iterator entry(folder_, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path& path = entry->path();
    const std::string name = path.filename().string();
    std::error_code unreadable;
    if (name.starts_with('.') || !entry->is_directory(unreadable)) continue;
    const Stamps stamps{changeTime(path), changeTime(path / kSummary),
                        changeTime(path / kProvenance)};
    const auto known = known_.find(name);
    if (known != known_.end() && known->second.stamps == stamps) {
      now.insert(known_.extract(known));
    } else if (isRun(path)) {
      now.emplace(name, Known{stamps, readRun(path)});
    }
  }
  known_ = std::move(now);
  std::vector<PastRun> all;
  all.reserve(known_.size());
  for (const auto& [name, known] : known_) all.push_back(known.run);
  std::ranges::sort(all, [](const PastRun& one, const PastRun& other) {
    return std::tie(one.start_utc, one.name) > std::tie(other.start_utc, other.name);
  });
  return all;
}

std::string RunList::json() {
  auto all = nlohmann::ordered_json::array();
  for (const PastRun& run : runs()) all.push_back(toJson(run));
  return toText(all);
}

std::optional<fs::path> RunList::folderOf(std::string_view run) const {
  if (!isPlainName(run)) return std::nullopt;
  fs::path path = folder_ / run;
  std::error_code error;
  if (!fs::is_directory(path, error) || !isRun(path)) return std::nullopt;
  return path;
}

std::optional<fs::path> RunList::file(std::string_view run, std::string_view name) const {
  const std::optional<fs::path> folder = folderOf(run);
  if (!folder) return std::nullopt;
  return servedFile(*folder, name);
}

}  // namespace lab::dashboard
