#include "runner/campaign/adaptive/adaptive_engine.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "common/files/atomic_file.hpp"
#include "common/files/file_text.hpp"
#include "common/text/format.hpp"
#include "common/text/printable.hpp"
#include "runner/campaign/adaptive/adaptive_goal.hpp"
#include "runner/campaign/adaptive/adaptive_rounds.hpp"
#include "runner/campaign/campaign_folder.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

void sayLine(const std::string& line) {
  fmt::print("{}\n", printable(line));
  std::fflush(stdout);
}

std::string endText(const CampaignData& data, const AdaptiveRound& round) {
  const AdaptivePlan& plan = *data.request.adaptive;
  return fmt::format("known    {}: error {} after {} of robot time; {}", goalText(plan),
                     errorText(plan, round.error), durationText(round.robot_time_s), round.end);
}

/// What is known, in surface.csv; nothing before the first run.
void writeSurface(const CampaignData& data, const fs::path& folder) {
  const GoalState state = goalState(data);
  if (!state.surface.empty()) replaceFile(folder / names::kSurface, surfaceCsv(data, state));
  if (!state.crossings.empty()) replaceFile(folder / names::kBoundary, boundaryCsv(data, state));
}

}  // namespace

EngineEnd runAdaptively(CampaignData& data, const fs::path& folder,
                        const std::vector<std::size_t>& first, const RunRows& run_rows) {
  const fs::path file = folder / names::kRounds;
  std::string text = readWholeFile(file, kRoundsFile).value_or("");
  if (!text.empty() && !text.ends_with('\n')) text += '\n';
  std::vector<AdaptiveRound> rounds = readRounds(text, data.axes.size());
  const AdaptivePlan& plan = *data.request.adaptive;
  sayLine(fmt::format("adaptive {}, {} a round", goalText(plan),
                      countText(plan.runs_per_round, "run")));
  std::vector<std::size_t> rows = first;
  if (rows.empty()) rows = openRows(data, rounds);
  while (true) {
    if (!rows.empty()) {
      EngineEnd end = run_rows(rows);
      writeSurface(data, folder);
      if (end.interrupted || end.disk_full || !end.note.empty()) return end;
      const std::vector<std::size_t> open = openRows(data, rounds);
      if (!open.empty() && open == rows) {
        end.note = "the chosen runs leave no result that can be read";
        return end;
      }
      rows = open;
      if (!rows.empty()) continue;
    }
    const AdaptiveRound round = nextRound(data, rounds.empty() ? 1 : rounds.back().number + 1);
    if (round.runs.empty()) {
      writeSurface(data, folder);  // again, if the campaign was killed after its last run
      sayLine(endText(data, round));
      return {.known = true};
    }
    sayLine(roundText(data, round));
    text += roundLine(round);
    replaceFile(file, text, Sync::kYes);
    rounds.push_back(round);
    rows = openRows(data, {round});
  }
}

std::vector<std::size_t> affordableRows(const CampaignData& data, std::vector<std::size_t> rows) {
  const double limit = data.request.adaptive->robot_time_s;
  double time = 0;
  for (std::size_t i = 0; limit > 0 && i < rows.size(); ++i) {
    time += data.points[data.rows[rows[i]].point].duration;
    if (time <= limit) continue;
    rows.resize(i + 1);
    break;
  }
  return rows;
}

}  // namespace lab::runner::campaign
