/// The progress of a campaign: a line on the terminal, and progress.json for others.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/campaign/campaign_page.hpp"
#include "runner/campaign/campaign_table.hpp"

namespace lab::runner::campaign {

/// State of a campaign at one moment.
struct ProgressState {
  std::size_t total = 0;
  std::size_t done = 0;
  std::size_t failed = 0;
  double seconds_left = -1;  ///< [s]; negative: not known
};

/// "[#####.....] 37 of 90 runs, 1 failed, 12 s left".
[[nodiscard]] std::string progressText(const ProgressState& state);

/// Shows the progress, and writes tables and page meanwhile. Time left is by the virtual time of
/// the runs, which may differ.
class SweepProgress {
 public:
  /// @param rows that will be run
  /// @param page how the page is drawn meanwhile; nothing: only the tables are written
  /// @param line whether a line shows the progress on stderr
  SweepProgress(const CampaignData& data, std::filesystem::path folder,
                const std::vector<std::size_t>& rows, std::optional<PageOptions> page,
                bool line = true);
  ~SweepProgress();
  SweepProgress(const SweepProgress&) = delete;
  SweepProgress& operator=(const SweepProgress&) = delete;

  /// Shows the state of data.survey, at most a few times a second.
  void update();

  /// Time since construction [s].
  [[nodiscard]] double seconds() const;

 private:
  [[nodiscard]] ProgressState state() const;
  void write(const ProgressState& state, bool running) const;

  const CampaignData& data_;
  std::filesystem::path folder_;
  std::vector<std::size_t> rows_;
  std::vector<double> virtual_s_;  ///< [s] of each of rows_
  std::optional<PageOptions> page_;
  bool line_;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double next_line_ = 0;    ///< [s]
  double next_file_ = 0;    ///< [s]
  double next_table_ = 10;  ///< [s]
};

}  // namespace lab::runner::campaign
