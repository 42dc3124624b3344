#include "runner/campaign/campaign_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "common/experiment/keys/experiment_keys.hpp"
#include "common/files/atomic_file.hpp"
#include "common/files/experiment_error.hpp"
#include "common/files/file_text.hpp"
#include "common/loop/wall_clock.hpp"
#include "common/text/json_text.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/command_line/output_file.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr FileKind kPointsFile{"the points of a campaign", 4'000'000'000};
constexpr FileKind kResultFile{"a result", 64U << 20U};
constexpr FileKind kRequestFile{"a campaign's request", file_kinds::kMega};
constexpr int kFormat = 1;

std::string pointsText(const std::vector<Point>& points) {
  std::string text = Json{{"format", kFormat}, {"points", points.size()}}.dump() + "\n";
  for (const Point& point : points) {
    text += Json{{"values", point.values},
                 {"sha256", point.hash},
                 {"duration_s", point.duration},
                 {"experiment", point.experiment}}
                .dump(-1, ' ', false, Json::error_handler_t::replace) +
            "\n";
  }
  return text;
}

[[noreturn]] void damagedPoints(const fs::path& file, std::size_t line, const std::string& what) {
  throw UserError(fmt::format(
      "{}:{}: {}, expected what lab sweep wrote; lab sweep FILE --out {} writes it again, results "
      "stay",
      file.string(), line, what, file.parent_path().string()));
}

/// @param axes number of swept keys, which all users of a point's values rely on
std::vector<Point> readPoints(const fs::path& file, std::size_t axes) {
  const std::string text = readFileText(file, kPointsFile);
  std::vector<Point> points;
  std::size_t expected = 0;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const auto json = parseJsonText<Json>(std::string_view(text).substr(begin, end - begin));
    begin = end + 1;
    ++number;
    try {
      if (number == 1) {
        if (json.at("format") != kFormat) {
          damagedPoints(file, number, "found another format");
        }
        expected = json.at("points");
        if (expected > static_cast<std::size_t>(kMostPoints)) {
          damagedPoints(file, number, fmt::format("found {} points", expected));
        }
        continue;
      }
      if (points.size() == expected) {
        damagedPoints(file, number, fmt::format("found more than {} points", expected));
      }
      Point point = makePoint(json.at("values"), json.at("experiment"), json.at("duration_s"));
      if (json.at("sha256") != point.hash) {
        damagedPoints(file, number, "found a line without its checksum");
      }
      if (point.values.size() != axes) {
        damagedPoints(file, number,
                      fmt::format("found {} values for {} swept keys", point.values.size(), axes));
      }
      if (!(point.duration > 0 && point.duration <= keys::kLongestRun)) {
        damagedPoints(file, number, fmt::format("found a run of {} s", point.duration));
      }
      points.push_back(std::move(point));
    } catch (const Json::exception&) {
      damagedPoints(file, number, "found a damaged line");
    }
  }
  if (points.size() != expected || expected == 0) {
    damagedPoints(file, number + 1, fmt::format("found {} points of {}", points.size(), expected));
  }
  return points;
}

void writeFiles(const fs::path& folder, const CampaignFiles& files) {
  for (const auto& [name, file] : files) {
    const fs::path path = folder / name;
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (fs::exists(path, error)) continue;
    if (file.source.empty()) {
      replaceFile(path, file.content, Sync::kYes);
    } else {
      fs::remove(path, error);  // a link that leads nowhere
      fs::create_symlink(file.source, path);
    }
  }
}

/// Keeps a file that will be replaced by another content.
void keepEarlier(const fs::path& folder, const char* name, const std::string& text) {
  const std::optional<std::string> before = readWholeFile(folder / name, kPointsFile);
  if (!before || *before == text) return;
  fs::create_directories(folder / names::kEarlier);
  for (int number = 1;; ++number) {
    const fs::path kept = folder / names::kEarlier / fmt::format("{}-{}", number, name);
    if (fs::exists(kept)) continue;
    fs::rename(folder / name, kept);
    return;
  }
}

/// Identities of the results in the folder: their code hashes by recipe.
std::map<std::string, std::set<std::string>> resultsIn(const fs::path& folder) {
  constexpr std::string_view kEnding = ".json";
  std::map<std::string, std::set<std::string>> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder / names::kResults, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const std::size_t dash = name.find('-');
    if (name.starts_with('.') || dash == std::string::npos || !name.ends_with(kEnding)) continue;
    found[name.substr(0, dash)].insert(
        name.substr(dash + 1, name.size() - kEnding.size() - dash - 1));
  }
  return found;
}

RowState stateOf(const fs::path& folder, const RunIdentity& run) {
  const fs::path file = folder / resultFile(run);
  const std::optional<std::string> text = readWholeFile(file, kResultFile);
  if (!text) return {RowState::Kind::kDamaged, {}, "cannot be read"};
  ReadResult read = readResult(*text, run);
  if (const RunResult* result = read.get()) return {RowState::Kind::kDone, *result, {}};
  return {RowState::Kind::kDamaged, {}, read.problem()};
}

RowState staleState(const fs::path& folder, const RunIdentity& run,
                    const std::set<std::string>& codes) {
  for (const std::string& code : codes) {
    RowState state = stateOf(folder, {run.recipe, code});
    if (state.kind != RowState::Kind::kDone) continue;
    state.kind = RowState::Kind::kStale;
    state.note = state.result->code;
    return state;
  }
  return {};
}

}  // namespace

void refuseCampaignLinks(const fs::path& folder) {
  for (const char* name :
       {names::kFiles, names::kResults, names::kSummaries, names::kRuns, names::kFailures,
        names::kWork, names::kEarlier, names::kFigures, names::kMarked, names::kJournal,
        names::kRounds, names::kLock, names::kSlurm, names::kParallel}) {
    refuseLink(folder / name);
  }
  // Slurm and GNU parallel write here themselves, under names that are not known before.
  for (const char* name : {names::kSlurm, names::kParallel}) {
    std::error_code error;
    for (fs::directory_iterator entry(folder / name, error), end; !error && entry != end;
         entry.increment(error)) {
      refuseLink(entry->path());
    }
  }
}

bool isCampaign(const fs::path& folder) {
  std::error_code error;
  return fs::is_regular_file(folder / names::kRequest, error);
}

void writeCampaign(const fs::path& folder, const StoredCampaign& campaign,
                   const CampaignFiles& files) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw UserError(fmt::format("cannot make {}: {}; choose another folder with --out",
                                folder.string(), error.message()));
  }
  for (const char* name : {names::kResults, names::kFailures, names::kWork}) {
    fs::create_directories(folder / name);
  }
  writeFiles(folder, files);
  const std::string request = requestText(campaign.request, campaign.created);
  const std::string points = pointsText(campaign.points);
  keepEarlier(folder, names::kExperiment, campaign.experiment_text);
  keepEarlier(folder, names::kRequest, request);
  replaceFile(folder / names::kExperiment, campaign.experiment_text, Sync::kYes);
  replaceFile(folder / names::kPoints, points, Sync::kYes);
  // Last: the folder is a campaign from here on.
  replaceFile(folder / names::kRequest, request, Sync::kYes);
}

StoredCampaign readCampaign(const fs::path& folder) {
  if (!isCampaign(folder)) {
    throw UserError(fmt::format(
        "{}: found no campaign.toml in it, expected an experiment file or the folder of a campaign",
        folder.string()));
  }
  const fs::path file = folder / names::kRequest;
  const std::string text = readFileText(file, kRequestFile);
  StoredCampaign campaign;
  campaign.request = readRequest(text, file.string());
  const std::size_t created = text.find("created = \"");
  if (created != std::string::npos) {
    const std::size_t begin = created + std::string_view("created = \"").size();
    campaign.created = text.substr(begin, text.find('"', begin) - begin);
  }
  campaign.experiment_text =
      readWholeFile(folder / names::kExperiment, file_kinds::kExperiment).value_or("");
  const std::vector<Axis> axes =
      parseAxes(campaign.request.over, fmt::format("{}: over", file.string()));
  campaign.points = readPoints(folder / names::kPoints, axes.size());
  requireFewRows(campaign.request, campaign.points.size(), file.string());
  for (const char* name : {names::kResults, names::kFailures, names::kWork}) {
    std::error_code ignored;
    fs::create_directories(folder / name, ignored);
  }
  return campaign;
}

std::size_t Survey::count(RowState::Kind kind) const {
  return static_cast<std::size_t>(
      std::ranges::count_if(rows, [kind](const RowState& row) { return row.kind == kind; }));
}

RowState readRow(const fs::path& folder, const RunIdentity& run) {
  std::error_code error;
  if (fs::exists(folder / resultFile(run), error)) return stateOf(folder, run);
  RowState state;
  if (const auto why = readWholeFile(folder / failureFile(run), kResultFile)) {
    state = {RowState::Kind::kFailed, {}, *why};
    while (state.note.ends_with('\n')) state.note.pop_back();
  }
  return state;
}

Survey surveyRows(const fs::path& folder, const std::vector<Row>& rows) {
  std::map<std::string, std::set<std::string>> found = resultsIn(folder);
  Survey survey;
  survey.rows.reserve(rows.size());
  std::set<std::string> mine;
  for (const Row& row : rows) {
    const auto codes = found.find(row.identity.recipe);
    RowState state;
    if (codes != found.end()) {
      mine.insert(row.identity.recipe);
      state = codes->second.contains(row.identity.code)
                  ? stateOf(folder, row.identity)
                  : staleState(folder, row.identity, codes->second);
    }
    if (state.kind == RowState::Kind::kMissing) state = readRow(folder, row.identity);
    survey.rows.push_back(std::move(state));
  }
  for (const auto& [recipe, codes] : found) {
    if (!mine.contains(recipe)) survey.of_other_points += codes.size();
  }
  return survey;
}

fs::path resultFile(const RunIdentity& run) {
  return fs::path(names::kResults) / (run.text() + ".json");
}
fs::path summaryFile(const RunIdentity& run) {
  return fs::path(names::kSummaries) / (run.text() + ".json");
}
fs::path runFolder(const RunIdentity& run) { return fs::path(names::kRuns) / run.text(); }
fs::path failureFile(const RunIdentity& run) {
  return fs::path(names::kFailures) / (run.text() + ".txt");
}

std::optional<FileLock> FileLock::tryLock(const fs::path& file) {
  FileDescriptor descriptor(open(file.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (descriptor.get() < 0) {
    throw std::runtime_error(
        fmt::format("cannot write {}: {}", file.string(), std::strerror(errno)));
  }
  if (flock(descriptor.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return {};
    // A file system without locks: no protection against a second process.
  }
  return FileLock(std::move(descriptor));
}

WorkFolder::WorkFolder(const fs::path& campaign) {
  const fs::path all = campaign / names::kWork;
  std::error_code error;
  fs::create_directories(all, error);
  char host[64] = {};
  gethostname(host, sizeof host - 1);
  // What a killed process of this host left behind. Of other hosts, locks may not be visible here.
  for (fs::directory_iterator entry(all, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path& path = entry->path();
    if (entry->is_symlink() || !path.filename().string().starts_with(std::string(host) + "-"))
      continue;
    try {
      if (const auto lock = FileLock::tryLock(path / "lock")) {
        std::error_code ignored;
        fs::remove_all(path, ignored);
      }
    } catch (const std::runtime_error&) {
      continue;  // of another user
    }
  }
  path_ = all / fmt::format("{}-{}", host, getpid());
  // Locked before others can see it.
  const fs::path hidden = all / ("." + path_.filename().string());
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  fs::remove_all(hidden, ignored);  // also a link that a stranger put there
  fs::create_directories(hidden);
  lock_ = FileLock::tryLock(hidden / "lock");
  fs::rename(hidden, path_);
}

WorkFolder::~WorkFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace lab::runner::campaign
