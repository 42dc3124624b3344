/// Lists past runs from the files in their folders.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lab::dashboard {

struct RunVerdict {
  std::string program;
  std::string verdict;
  std::optional<double> max_z;
  bool restricted = false;  ///< an agreement is not shown in green
};

struct PastRun {
  std::string name;        ///< of the run's folder
  std::string experiment;  ///< empty if unknown
  std::string start_utc;   ///< "2026-01-31T12:00:00Z"
  std::optional<double> duration_s;
  bool marked = false;               ///< whether it has faults
  std::optional<std::int64_t> lost;  ///< messages missing in its log
  std::vector<RunVerdict> verdicts;
  std::string thumbnail;  ///< file name of a figure; empty if there is none
  bool report = false;    ///< whether there is a report.html
  bool film = false;      ///< whether there are film.mp4 and film_clip.json, its pictures' times
  std::string problem;    ///< why facts are missing and what to do; else empty
};

/// The runs in a folder. Files are read again only after they have changed. Thread-safe.
class RunList {
 public:
  explicit RunList(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// All runs, the newest first. Incomplete and damaged runs are included, with a problem.
  [[nodiscard]] std::vector<PastRun> runs();

  /// The response to GET /api/runs.
  [[nodiscard]] std::string json();

  /// The folder of a run; nothing if there is no such run.
  [[nodiscard]] std::optional<std::filesystem::path> folderOf(std::string_view run) const;

  /// The path of a file of the run's report ("msd_NAME.svg", "figures/msd_NAME.csv"). Nothing if it
  /// does not exist, is of another type, or is a link to a file outside the run's folder.
  [[nodiscard]] std::optional<std::filesystem::path> file(std::string_view run,
                                                          std::string_view name) const;

 private:
  /// Times of the last changes of the folder and of the files that are read.
  using Stamps = std::array<std::int64_t, 3>;
  struct Known {
    Stamps stamps{};
    PastRun run;
  };

  std::filesystem::path folder_;
  std::mutex mutex_;
  std::map<std::string, Known> known_;
};

/// Reads the folder of one run. Does not throw because of its content.
[[nodiscard]] PastRun readRun(const std::filesystem::path& folder);

}  // namespace lab::dashboard
