#include "runner/campaign/sweep_progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/files/atomic_file.hpp"
#include "common/loop/wall_clock.hpp"
#include "common/text/format.hpp"
#include "runner/campaign/campaign_folder.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner::campaign {
namespace {

constexpr int kBar = 24;             // characters
constexpr double kOnTerminal = 0.2;  // [s] between two lines
constexpr double kElsewhere = 60;    // [s] the same without a terminal
constexpr double kFileInterval = 1;  // [s]
constexpr double kTableShare = 30;   // of the time that writing a table takes

}  // namespace

std::string progressText(const ProgressState& state) {
  const double share = state.total == 0 ? 1
                                        : static_cast<double>(state.done + state.failed) /
                                              static_cast<double>(state.total);
  const auto full = static_cast<std::size_t>(std::lround(std::clamp(share, 0.0, 1.0) * kBar));
  std::string text = fmt::format("[{}{}] {} of {} runs", std::string(full, '#'),
                                 std::string(kBar - full, '.'), state.done, state.total);
  if (state.failed > 0) text += fmt::format(", {} failed", state.failed);
  if (state.seconds_left >= 0) text += ", " + durationText(std::ceil(state.seconds_left)) + " left";
  return text;
}

SweepProgress::SweepProgress(const CampaignData& data, std::filesystem::path folder,
                             const std::vector<std::size_t>& rows, std::optional<PageOptions> page,
                             bool line)
    : data_(data),
      folder_(std::move(folder)),
      rows_(rows),
      page_(std::move(page)),
      line_(line),
      terminal_(isatty(STDERR_FILENO) == 1),
      next_line_(terminal_ ? 0 : kElsewhere) {
  if (page_) page_->running = true;
  for (const std::size_t row : rows_) {
    virtual_s_.push_back(data.points[data.rows[row].point].duration);
  }
}

SweepProgress::~SweepProgress() {
  if (shown_ && terminal_) std::fputs("\r\033[K", stderr);
  try {
    write(state(), false);
  } catch (const std::exception&) {
    // The disk may be full; the file is for display only.
  }
}

double SweepProgress::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

ProgressState SweepProgress::state() const {
  ProgressState state;
  state.total = data_.rows.size();
  state.done =
      data_.survey.count(RowState::Kind::kDone) + data_.survey.count(RowState::Kind::kStale);
  state.failed = data_.survey.count(RowState::Kind::kFailed);
  double finished = 0;
  double all = 0;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const auto kind = data_.survey.rows[rows_[i]].kind;
    all += virtual_s_[i];
    if (kind == RowState::Kind::kDone || kind == RowState::Kind::kFailed) finished += virtual_s_[i];
  }
  if (finished > 0) state.seconds_left = seconds() * (all - finished) / finished;
  return state;
}

void SweepProgress::write(const ProgressState& state, bool running) const {
  const nlohmann::ordered_json json{
      {"total", state.total},
      {"done", state.done},
      {"failed", state.failed},
      {"running", running},
      {"pid", getpid()},
      {"seconds_left", state.seconds_left < 0
                           ? nlohmann::ordered_json()
                           : nlohmann::ordered_json(std::ceil(state.seconds_left))},
      {"updated", runner::utcText(wallClock())}};
  replaceFile(folder_ / names::kProgress, json.dump() + "\n");
}

void SweepProgress::update() {
  const double now = seconds();
  const bool line = line_ && now >= next_line_;
  const bool file = now >= next_file_;
  const bool table = now >= next_table_;
  if (!line && !file && !table) return;
  const ProgressState current = state();
  if (line) {
    next_line_ = now + (terminal_ ? kOnTerminal : kElsewhere);
    shown_ = true;
    std::fprintf(stderr, terminal_ ? "\r\033[K%s" : "%s\n", progressText(current).c_str());
    std::fflush(stderr);
  }
  try {
    if (file) {
      next_file_ = now + kFileInterval;
      write(current, true);
    }
    if (table) {
      if (page_) {
        static_cast<void>(writeTables(data_, folder_, *page_));
      } else {
        writeCsv(data_, folder_, poolCampaign(data_));
      }
      next_table_ = seconds() + std::max(10.0, kTableShare * (seconds() - now));
    }
  } catch (const std::exception&) {
    // The engine notices a full disk too, and ends; these files are written again at the end.
    next_file_ = now + kElsewhere;
    next_table_ = now + kElsewhere;
  }
}

}  // namespace lab::runner::campaign
