/// Plays the runs of a campaign one after another on a real lab.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "runner/campaign/campaign_table.hpp"
#include "runner/campaign/live/live_plan.hpp"
#include "runner/campaign/local_engine.hpp"

namespace lab::runner::campaign {

struct PlayedRun {
  std::filesystem::path run;  ///< its folder; empty: it could not be played
  std::string failure;        ///< why it could not be played
};

/// What a live campaign needs from outside.
struct LiveMachine {
  /// Plays an experiment file to its end. The run's folder is made in `parent`.
  std::function<PlayedRun(const std::filesystem::path& file, const std::filesystem::path& parent)>
      play;
  std::function<std::int64_t()> now;  ///< UTC [us]
  /// Waits until a time, or until the user interrupts.
  std::function<void(std::int64_t until_us)> wait;
  std::function<bool()> interrupted;
  std::function<void(const std::string& line)> say;  ///< a line for the terminal
  std::function<void()> watch;                       ///< called after each activity
};

/// Plays the rows by the campaign's LivePlan, until all have ended, all points are known, the time
/// is over, the disk is full or the user interrupts. Keeps `data.survey` up to date and writes
/// journal.jsonl, which it also continues after a restart.
[[nodiscard]] EngineEnd runLive(CampaignData& data, const std::filesystem::path& folder,
                                const std::vector<std::size_t>& rows, const LiveMachine& machine);

/// Notes in the journal that all robots take part again.
void takeBackRobots(const std::filesystem::path& folder, std::int64_t now_us);

/// Text of journal.jsonl; empty if there is none.
[[nodiscard]] std::string journalText(const std::filesystem::path& folder);

/// A lab whose runs are child processes `lab run`.
/// @param rehearse in virtual time: the clock advances by the runs and waits only
[[nodiscard]] LiveMachine labMachine(bool rehearse);

}  // namespace lab::runner::campaign
