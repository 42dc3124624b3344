/// The folder of a campaign.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/files/file_text.hpp"
#include "common/process/file_descriptor.hpp"
#include "runner/campaign/campaign.hpp"
#include "runner/campaign/run_result.hpp"

namespace lab::runner::campaign {

namespace names {
inline constexpr const char* kRequest = "campaign.toml";
inline constexpr const char* kExperiment = "experiment.toml";  ///< the user's file, as it was
inline constexpr const char* kPoints = "points.jsonl";
inline constexpr const char* kFiles = "files";          ///< images, calibrations, by SHA-256
inline constexpr const char* kResults = "results";      ///< one JSON file per run
inline constexpr const char* kSummaries = "summaries";  ///< with --keep summary
inline constexpr const char* kRuns = "runs";            ///< with --keep logs
inline constexpr const char* kFailures = "failures";    ///< why a run has no result
inline constexpr const char* kMarked = "marked";    ///< runs of a live campaign that were repeated
inline constexpr const char* kFigures = "figures";  ///< of the page
inline constexpr const char* kWork = "work";        ///< runs in flight
inline constexpr const char* kEarlier = "earlier";  ///< requests that were replaced
inline constexpr const char* kProgress = "progress.json";
inline constexpr const char* kJournal = "journal.jsonl";  ///< of a live campaign
inline constexpr const char* kRounds = "adaptive.jsonl";  ///< of an adaptive campaign
inline constexpr const char* kSurface = "surface.csv";    ///< what it knows
inline constexpr const char* kBoundary = "boundary.csv";  ///< where a level is crossed
inline constexpr const char* kTable = "campaign.csv";
inline constexpr const char* kPooled = "points.csv";
inline constexpr const char* kJson = "campaign.json";
inline constexpr const char* kPage = "index.html";
inline constexpr const char* kLock = "lock";          ///< of the command that runs the campaign
inline constexpr const char* kSlurm = "slurm";        ///< scripts and logs of Slurm's jobs
inline constexpr const char* kParallel = "parallel";  ///< lists and logs of GNU parallel
inline constexpr const char* kReturned = "returned";  ///< in it: results that hosts send back
}  // namespace names

inline constexpr FileKind kRoundsFile{"the rounds of a campaign", 64 * file_kinds::kMega};

/// A file that the experiments of a campaign need, under its name by content.
struct CampaignFile {
  std::string content;           ///< unless `source` is given
  std::filesystem::path source;  ///< a recording, which stays where it is: the name becomes a link
};
using CampaignFiles = std::map<std::string, CampaignFile>;  ///< by name below the campaign's folder

/// A campaign as stored.
struct StoredCampaign {
  Request request;
  std::string created;          ///< "2026-01-31T12:00:00Z"
  std::string experiment_text;  ///< the user's file
  std::vector<Point> points;
};

/// Checks that no link in a campaign's folder, which may come from a stranger, leads what is
/// written to another place. @throws UserError
void refuseCampaignLinks(const std::filesystem::path& folder);

/// Whether the folder holds a campaign.
[[nodiscard]] bool isCampaign(const std::filesystem::path& folder);

/// Writes campaign.toml, points.jsonl, experiment.toml and the files, and makes the other folders.
/// An earlier request goes to `earlier/`; results stay.
void writeCampaign(const std::filesystem::path& folder, const StoredCampaign& campaign,
                   const CampaignFiles& files);

/// @throws ExperimentError, UserError: what is damaged, and how it is written again
[[nodiscard]] StoredCampaign readCampaign(const std::filesystem::path& folder);

/// What there is of a row.
struct RowState {
  enum class Kind {
    kMissing,
    kDone,
    kStale,    ///< there is only a result of another version of the code
    kFailed,   ///< the run was tried, and has no result
    kDamaged,  ///< its file cannot be used; it is computed again
  };
  Kind kind = Kind::kMissing;
  std::optional<RunResult> result;  ///< kDone, kStale
  std::string note;                 ///< kStale: the other version; kFailed, kDamaged: why
};

/// All rows, and what else lies in the folder.
struct Survey {
  std::vector<RowState> rows;
  std::size_t of_other_points = 0;  ///< results of experiments that are not in this campaign now

  [[nodiscard]] std::size_t count(RowState::Kind kind) const;
};

/// One row again, after it was run.
[[nodiscard]] RowState readRow(const std::filesystem::path& folder, const RunIdentity& run);

[[nodiscard]] Survey surveyRows(const std::filesystem::path& folder, const std::vector<Row>& rows);

/// The files of one run, below the campaign's folder.
[[nodiscard]] std::filesystem::path resultFile(const RunIdentity& run);
[[nodiscard]] std::filesystem::path summaryFile(const RunIdentity& run);
[[nodiscard]] std::filesystem::path runFolder(const RunIdentity& run);
[[nodiscard]] std::filesystem::path failureFile(const RunIdentity& run);

/// A lock on a file that ends with the process. On network file systems it needs NFS 4.
class FileLock {
 public:
  /// @return nothing if another process has it. @throws std::runtime_error if it cannot be made
  [[nodiscard]] static std::optional<FileLock> tryLock(const std::filesystem::path& file);

 private:
  explicit FileLock(FileDescriptor file) : file_(std::move(file)) {}
  FileDescriptor file_;
};

/// A folder for runs in flight: `work/HOST-PID`. Removed at the end; what killed processes left
/// behind is removed when the next one begins.
class WorkFolder {
 public:
  explicit WorkFolder(const std::filesystem::path& campaign);
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::optional<FileLock> lock_;
};

}  // namespace lab::runner::campaign
