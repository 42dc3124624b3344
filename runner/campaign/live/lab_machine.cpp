// The real lab of a live campaign: `lab run` as a child process, the wall clock.
#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "common/experiment/experiment_file.hpp"
#include "common/loop/wall_clock.hpp"
#include "common/process/child_process.hpp"
#include "common/process/file_descriptor.hpp"
#include "common/process/installation.hpp"
#include "common/text/printable.hpp"
#include "runner/campaign/live/live_engine.hpp"
#include "runner/campaign/row_pool.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

constexpr std::chrono::milliseconds kLookAgain{200};
constexpr const char* kOutput = "output.txt";

fs::path folderIn(const fs::path& parent) {
  for (const fs::directory_entry& entry : fs::directory_iterator(parent)) {
    if (entry.is_directory()) return entry.path();
  }
  return {};
}

PlayedRun playByLab(const fs::path& file, const fs::path& parent, bool virtual_time) {
  const FileDescriptor output(
      ::open((parent / kOutput).c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
  ChildSettings settings{.arguments = {(installation().programs / "lab").string(), "run",
                                       file.string(), "--out", parent.string(), "--no-report"},
                         .output = output.get(),
                         .errors = output.get(),
                         .death_signal = SIGTERM};
  settings.arguments.emplace_back(virtual_time ? "--virtual-time" : "--no-web");
  ChildProcess lab(settings);
  bool told = false;
  while (!lab.waitFor(kLookAgain)) {
    if (wasInterrupted() && !std::exchange(told, true)) lab.signal(SIGINT);
  }
  PlayedRun played{folderIn(parent), {}};
  const int code = lab.code();
  // Runs with a mark or closed early have a folder, and their log says why.
  if (played.run.empty() || (code != kDone && code != kFailed && code != kClosedEarly)) {
    played.run.clear();
    played.failure = fmt::format("lab run: {}", lastLine(parent / kOutput));
  }
  return played;
}

}  // namespace

LiveMachine labMachine(bool rehearse) {
  LiveMachine machine;
  // In a rehearsal, the time that was skipped [us].
  const auto skipped = std::make_shared<std::int64_t>(0);
  machine.play = [=](const fs::path& file, const fs::path& parent) {
    const std::int64_t begin = wallClock();
    PlayedRun played = playByLab(file, parent, rehearse);
    if (rehearse && !played.run.empty()) {
      const double duration = loadExperiment(played.run / "experiment.toml", {}).duration;
      const std::int64_t took = wallClock() - begin;
      *skipped += std::max<std::int64_t>(0, static_cast<std::int64_t>(duration * 1e6) - took);
    }
    return played;
  };
  machine.now = [=] { return wallClock() + *skipped; };
  machine.wait = [=](std::int64_t until_us) {
    if (rehearse) *skipped += std::max<std::int64_t>(0, until_us - wallClock() - *skipped);
    while (!wasInterrupted() && wallClock() + *skipped < until_us) {
      std::this_thread::sleep_for(kLookAgain);
    }
  };
  machine.interrupted = wasInterrupted;
  machine.say = [](const std::string& line) {
    fmt::print("{}\n", printable(line));
    std::fflush(stdout);
  };
  return machine;
}

}  // namespace lab::runner::campaign
