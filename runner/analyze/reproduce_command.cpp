#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "analyzer/reproduction_page.hpp"
#include "common/experiment/experiment_file.hpp"
#include "runner/analyze/analyze_commands.hpp"
#include "runner/command_line/progress_bar.hpp"
#include "runner/doctor/machine.hpp"
#include "runner/live/launch.hpp"
#include "runner/runs/run_directory.hpp"
#include "runner/virtual_time/run_virtual.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

volatile std::sig_atomic_t ended_by_user = 0;

/// One recording of one set.
struct Task {
  report::PaperSet set;
  int member = 0;
  Experiment experiment;
};

std::vector<Task> tasksOf(const std::vector<report::PaperSet>& sets,
                          const ReproduceOptions& options) {
  std::vector<Task> tasks;
  for (const report::PaperSet& set : sets) {
    for (int member = 0; member < options.ensemble; ++member) {
      const std::string text = report::experimentText(
          set, {options.hours, options.seed, member, options.through == "firmware"});
      tasks.push_back({set, member, parseExperiment(text, set.id)});
    }
  }
  return tasks;
}

constexpr const char* kFilms = "films";
constexpr const char* kPage = "reproduction.html";

/// Makes the folder. @throws UserError when it holds something, without --force
void requireFolder(const ReproduceOptions& options) {
  std::error_code error;
  if (fs::exists(options.out, error) && !fs::is_directory(options.out, error)) {
    throw UserError(options.out.string() + " is a file; choose another folder with --out");
  }
  if (fs::is_directory(options.out, error) && !fs::is_empty(options.out, error)) {
    if (!fs::exists(options.out / kPage)) {
      throw UserError(options.out.string() +
                      " is not empty, and what is in it is no reproduction; choose another folder "
                      "with --out");
    }
    if (!options.force) {
      throw UserError(
          options.out.string() +
          " is not empty; choose another folder with --out, or replace the reproduction "
          "in it by --force");
    }
  }
  fs::create_directories(options.out, error);
  if (error) {
    throw UserError(fmt::format("cannot make {}: {}; choose another folder with --out",
                                options.out.string(), error.message()));
  }
}

void requireRoom(const std::vector<Task>& tasks, const ReproduceOptions& options,
                 std::size_t jobs) {
  std::vector<std::int64_t> needs;
  for (const Task& task : tasks) needs.push_back(diskNeed_bytes(task.experiment));
  std::sort(needs.rbegin(), needs.rend());
  if (!options.keep_logs && needs.size() > jobs)
    needs.resize(jobs);  // a log is removed after it was read
  std::int64_t need = 0;
  for (const std::int64_t one : needs) need += one;
  const std::int64_t have = freeBytes(options.out);
  if (have >= need) return;
  throw UserError(fmt::format(
      "too little disk in {}: this needs about {} MB, {} MB are free; make room, choose another "
      "folder with --out, or lower --hours, --ensemble or --jobs",
      options.out.string(), need / 1'000'000, have / 1'000'000));
}

/// Runs the tasks on several threads. Runs in virtual time share no state.
class RecordingPool {
 public:
  RecordingPool(const ReproduceOptions& options, std::vector<Task> tasks,
                const std::vector<report::PaperPanel>& panels)
      : options_(options), tasks_(std::move(tasks)), panels_(panels), recordings_(tasks_.size()) {
    for (const Task& task : tasks_) total_s_ += task.experiment.duration;
  }

  /// @return false when the user ended it. @throws the error that ended a run
  bool record(std::size_t jobs) {
    std::vector<std::jthread> workers;
    for (std::size_t i = 0; i < jobs; ++i) workers.emplace_back([this] { work(); });
    {
      ProgressBar progress(static_cast<std::int64_t>(total_s_), "s of film");
      while (!finished()) {
        progress.show(done_ms_.load() / 1000);
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        if (ended_by_user != 0) stop_ = true;
      }
    }
    workers.clear();
    if (problem_) std::rethrow_exception(problem_);
    return !stop_;
  }

  report::Reproduction take() {
    report::Reproduction all;
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      report::SetData& set = all[tasks_[i].set.id];
      set.set = tasks_[i].set;
      set.recordings.push_back(std::move(recordings_[i]));
    }
    return all;
  }

 private:
  [[nodiscard]] bool finished() const { return stop_ || ready_ == tasks_.size(); }

  void work() {
    while (!stop_) {
      const std::size_t i = next_++;
      if (i >= tasks_.size()) return;
      try {
        recordings_[i] = recordOne(tasks_[i]);
        ++ready_;
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!problem_) problem_ = std::current_exception();
        stop_ = true;
      }
    }
  }

  report::RecordingData recordOne(const Task& task) {
    const fs::path runs = options_.out / kFilms;
    const PreparedRun run = prepareRun(task.experiment, {}, runs, 0, "--out");
    std::int64_t shown_ms = 0;
    const auto show = [&](const Progress& progress) {
      const auto now_ms = static_cast<std::int64_t>(
          1000 * std::clamp(progress.elapsed, 0.0, task.experiment.duration));
      done_ms_ += now_ms - shown_ms;
      shown_ms = now_ms;
    };
    const RunOutcome outcome = runVirtual(run, show, [this] { return stop_.load(); });
    if (outcome.interrupted) return {};
    const bool one = options_.ensemble == 1;
    report::RecordingData recording = report::readRecording(
        run.directory, report::contentsFor(panels_, task.set),
        one && options_.bootstrap ? analysis::Depth::kFull : analysis::Depth::kLive);
    for (const std::string& fault : outcome.faults) recording.faults.push_back(fault);
    if (!options_.keep_logs) fs::remove(run.directory / files::kLog);
    const std::string name =
        one ? task.set.id : fmt::format("{}_film{:03}", task.set.id, task.member + 1);
    fs::remove_all(runs / name);  // left by a reproduction that --force replaces
    fs::rename(run.directory, runs / name);
    done_ms_ += static_cast<std::int64_t>(1000 * task.experiment.duration) - shown_ms;
    return recording;
  }

  const ReproduceOptions& options_;
  std::vector<Task> tasks_;
  const std::vector<report::PaperPanel>& panels_;
  std::vector<report::RecordingData> recordings_;
  double total_s_ = 0;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<std::size_t> ready_ = 0;
  std::atomic<std::int64_t> done_ms_ = 0;
  std::atomic<bool> stop_ = false;
  std::mutex mutex_;
  std::exception_ptr problem_;
};

}  // namespace

ExitCode reproduce(const ReproduceOptions& options) {
  const std::vector<report::PaperPanel> panels = report::choosePanels(options.panels);
  requireProgram("gnuplot", "gnuplot-nox");
  std::vector<Task> tasks = tasksOf(report::setsOf(panels), options);
  requireFolder(options);
  const std::size_t wanted = options.jobs > 0 ? static_cast<std::size_t>(options.jobs)
                                              : std::max(1U, std::thread::hardware_concurrency());
  const std::size_t jobs = std::min(wanted, tasks.size());
  requireRoom(tasks, options, jobs);
  const fs::path runs = options.out / kFilms;
  std::error_code ignored;
  fs::remove_all(runs, ignored);

  const auto begin = std::chrono::steady_clock::now();
  fmt::print("films    {} of {} panels, {} at a time\n", tasks.size(), panels.size(), jobs);
  std::fflush(stdout);
  std::signal(SIGINT, [](int) { ended_by_user = 1; });
  std::signal(SIGTERM, [](int) { ended_by_user = 1; });
  RecordingPool pool(options, std::move(tasks), panels);
  const auto removeAll = [&] {
    fs::remove_all(runs, ignored);
    fs::remove(options.out, ignored);  // fails unless it is empty
  };
  bool recorded = false;
  try {
    recorded = pool.record(jobs);
  } catch (...) {
    removeAll();
    throw;
  }
  if (!recorded) {
    removeAll();
    fmt::print("ended by the user: nothing was drawn\n");
    return kFailed;
  }
  const report::WrittenReproduction written = report::writeReproduction(
      options.out, panels, pool.take(),
      {options.hours, options.seed, options.ensemble, options.through == "firmware"});
  for (const std::string& line : written.lines) fmt::print("{}\n", line);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  fmt::print("page     {} ({:.0f} s)\n", fs::absolute(written.page).lexically_normal().string(),
             took.count());
  return kDone;
}

}  // namespace lab::runner
