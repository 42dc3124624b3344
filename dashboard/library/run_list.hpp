/// Past runs, from what lies in their folder.
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
};

struct PastRun {
  std::string name;        ///< of its folder
  std::string experiment;  ///< empty: not known
  std::string start_utc;   ///< "2026-01-31T12:00:00Z"
  std::optional<double> duration_s;
  bool marked = false;               ///< it has faults
  std::optional<std::int64_t> lost;  ///< messages that its log lacks
  std::vector<RunVerdict> verdicts;
  std::string thumbnail;  ///< a figure; empty: none
  bool report = false;    ///< there is a report.html
  std::string problem;    ///< why something is not known, and what to do; empty: all is
};

/// The folder of runs. What was read once is read again only when it changed. From any thread.
class RunList {
 public:
  explicit RunList(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Newest first. Half-written and broken runs are among them and say so.
  [[nodiscard]] std::vector<PastRun> runs();

  /// Of `GET /api/runs`.
  [[nodiscard]] std::string json();

  /// The folder of a run; nothing where the name is not one of the list's.
  [[nodiscard]] std::optional<std::filesystem::path> folderOf(std::string_view run) const;

  /// A file that belongs to the run's report ("msd_abp.svg", "figures/msd_abp.csv"); nothing where
  /// there is no such file, or one of another kind, or one that lies elsewhere.
  [[nodiscard]] std::optional<std::filesystem::path> file(std::string_view run,
                                                          std::string_view name) const;

 private:
  /// When what is read last changed.
  using Stamps = std::array<std::int64_t, 3>;
  struct Known {
    Stamps stamps{};
    PastRun run;
  };

  std::filesystem::path folder_;
  std::mutex mutex_;
  std::map<std::string, Known> known_;
};

/// Reads one run's folder. Never throws for what is in it.
[[nodiscard]] PastRun readRun(const std::filesystem::path& folder);

}  // namespace lab::dashboard
