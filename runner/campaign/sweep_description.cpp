#include "runner/campaign/sweep_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "common/text/format.hpp"
#include "common/text/printable.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

using Kind = RowState::Kind;

constexpr std::size_t kListedLines = 10;

}  // namespace

void describe(const CampaignData& data, const fs::path& folder) {
  fmt::print("campaign {}\n", printable(folder.string()));
  double virtual_s = 0;
  for (const Row& row : data.rows) virtual_s += data.points[row.point].duration;
  fmt::print("points   {} x {} = {}, {} of {}\n",
             countText(static_cast<std::int64_t>(data.points.size()), "point"),
             countText(data.request.seeds, "seed"),
             countText(static_cast<std::int64_t>(data.rows.size()), "run"), durationText(virtual_s),
             data.request.live ? "robot time" : "virtual time");
  const auto count = [&](Kind kind) { return data.survey.count(kind); };
  if (count(Kind::kDone) > 0) {
    fmt::print("there    {} of {} runs are done\n", count(Kind::kDone), data.rows.size());
  }
  if (data.request.common_seeds) {
    fmt::print("seeds    all points share their random numbers; their errors are correlated\n");
  }
}

void listRows(const CampaignData& data, Kind kind, const char* word) {
  std::size_t listed = 0;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    if (data.survey.rows[i].kind != kind || ++listed > kListedLines) continue;
    fmt::print("{:<8} row {}: {}\n", word, i, printable(data.survey.rows[i].note));
  }
  if (listed > kListedLines) fmt::print("{:<8} and {} more\n", word, listed - kListedLines);
}

void describeProblems(const CampaignData& data, const fs::path& folder, bool retry,
                      bool redo_stale) {
  std::size_t listed = 0;
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    const RowState& state = data.survey.rows[i];
    if (state.kind != Kind::kDamaged || ++listed > kListedLines) continue;
    fmt::print("damaged  {} (row {}) {}; computed again\n",
               (folder / resultFile(data.rows[i].identity)).string(), i, state.note);
  }
  if (listed > kListedLines) fmt::print("damaged  and {} more\n", listed - kListedLines);
  if (const std::size_t stale = data.survey.count(Kind::kStale)) {
    const auto first = std::ranges::find(data.survey.rows, Kind::kStale, &RowState::kind);
    fmt::print("stale    {} of {} results are of version {}, this is {}; {}\n", stale,
               data.rows.size(), printable(first->note), data.code.text,
               redo_stale ? "computed again"
                          : "kept, and marked in the table (--redo-stale computes them "
                            "again)");
  }
  if (data.survey.of_other_points > 0) {
    fmt::print(
        "stale    {} results are of another experiment file or of points that are not in "
        "this sweep; they stay in {}, not in the table\n",
        data.survey.of_other_points, (folder / names::kResults).string());
  }
  if (const std::size_t failed = data.survey.count(Kind::kFailed)) {
    listRows(data, Kind::kFailed, "failed");
    if (!retry)
      fmt::print("failed   {}: --retry tries them again\n",
                 countText(static_cast<std::int64_t>(failed), "run"));
  }
}

}  // namespace lab::runner::campaign
