#include "runner/campaign/local_engine.hpp"

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <set>

#include "common/files/atomic_file.hpp"
#include "runner/campaign/campaign_folder.hpp"
#include "runner/campaign/row_pool.hpp"
#include "runner/campaign/run_row.hpp"
#include "runner/doctor/machine.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

volatile std::sig_atomic_t interrupted = 0;

constexpr std::chrono::milliseconds kStep{200};

}  // namespace

void catchSignals() {
  std::signal(SIGINT, [](int) { interrupted = 1; });
  std::signal(SIGTERM, [](int) { interrupted = 1; });
}

bool wasInterrupted() { return interrupted != 0; }

EngineEnd runLocally(CampaignData& data, const fs::path& folder,
                     const std::vector<std::size_t>& rows, const LocalOptions& options) {
  EngineEnd engine;
  const WorkFolder work(folder);
  RowPool pool(options.jobs, work.path(), [&](std::size_t row) {
    runRow({folder, work.path(), &data.request, &data.points[data.rows[row].point], &data.rows[row],
            data.code});
  });
  for (const std::size_t row : rows) pool.add(row);
  std::set<std::size_t> killed;
  const auto diskFull = [&](const std::string& why) {
    engine.disk_full = true;
    engine.note = why;
    pool.drop();
  };
  while (!pool.empty()) {
    if (wasInterrupted()) {
      engine.interrupted = true;
      engine.note = "ended by the user";
      break;
    }
    if (!engine.disk_full && freeBytes(folder) < options.disk_reserve) {
      diskFull(fmt::format("less than {} MB are free in {}", options.disk_reserve / 1'000'000,
                           folder.string()));
    }
    for (const RowEnd& end : pool.wait(kStep)) {
      const RunIdentity& run = data.rows[end.row].identity;
      switch (end.kind) {
        case RowEnd::Kind::kDone:
          break;
        case RowEnd::Kind::kDiskFull:
          diskFull(end.reason);
          break;
        case RowEnd::Kind::kKilled:
          if (killed.insert(end.row).second) {
            if (!engine.disk_full) pool.add(end.row);
            break;
          }
          [[fallthrough]];
        case RowEnd::Kind::kFailed:
          try {
            replaceFile(folder / failureFile(run), end.reason + "\n");
          } catch (const DiskFull& error) {
            diskFull(error.what());
          }
          break;
      }
      data.survey.rows[end.row] = readRow(folder, run);
      if (options.watch) options.watch();
    }
    if (options.watch) options.watch();
  }
  return engine;
}

}  // namespace lab::runner::campaign
