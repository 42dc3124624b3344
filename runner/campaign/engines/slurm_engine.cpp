#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "common/files/atomic_file.hpp"
#include "common/files/file_text.hpp"
#include "common/text/format.hpp"
#include "common/text/printable.hpp"
#include "runner/campaign/campaign_folder.hpp"
#include "runner/campaign/engines/bundles.hpp"
#include "runner/campaign/engines/engine.hpp"
#include "runner/campaign/engines/tool.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

constexpr const char* kJobs = "jobs.txt";  // ids of the arrays that were submitted
constexpr std::size_t kMostJobs = 100;     // that are asked for: the newest
constexpr int kMostSubmissions = 3;
constexpr std::chrono::seconds kPoll{2};

std::vector<std::string> wordsOf(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// Ids of the arrays that were submitted. What is no id is left out: the folder may be a
/// stranger's.
std::vector<std::string> recordedJobs(const fs::path& folder) {
  auto jobs =
      wordsOf(readWholeFile(folder / names::kSlurm / kJobs, file_kinds::kText).value_or(""));
  std::erase_if(jobs, [](const std::string& job) {
    return job.size() > 10 || job.find_first_not_of("0123456789") != std::string::npos;
  });
  if (jobs.size() > kMostJobs) jobs.erase(jobs.begin(), jobs.end() - kMostJobs);
  return jobs;
}

/// Where the tasks of an array write. sbatch replaces what follows a %.
std::string outputPattern(const fs::path& folder) {
  std::string pattern;
  for (const char letter : folder.string()) {
    pattern += letter == '%' ? "%%" : std::string(1, letter);
  }
  return pattern + "/%A_%a.log";
}

/// Number of tasks of an array of this user that wait or run; 0 when it has ended; none if the user
/// interrupts.
/// @throws UserError if squeue does not answer
std::optional<std::size_t> tasksLeft(const std::string& job) {
  for (int attempt = 0;; ++attempt) {
    const ToolEnd end =
        runTool({"squeue", "--me", "--noheader", "--array", "--format=%T", "--jobs", job});
    if (end.interrupted) return {};
    if (end.ok()) return static_cast<std::size_t>(std::ranges::count(end.output, '\n'));
    // Slurm forgets jobs that ended some minutes ago.
    if (end.errors.find("Invalid job id") != std::string::npos) return 0;
    constexpr int kMostAttempts = 30;  // a minute: the controller may be restarting
    if (attempt >= kMostAttempts) {
      throw UserError(fmt::format(
          "squeue --jobs {}: {}; the jobs go on, and lab sweep waits for them when it is called "
          "again",
          job, end.lastLine()));
    }
    std::this_thread::sleep_for(kPoll);
  }
}

/// Submits an array. @return its id
std::string submit(const CampaignData& data, const fs::path& folder,
                   const std::vector<Bundle>& bundles, const EngineOptions& options, int number) {
  const fs::path campaign = fs::absolute(folder).lexically_normal();
  const fs::path at = campaign / names::kSlurm;
  fs::create_directories(at);
  // Tasks that wait may still read those of earlier submissions.
  std::size_t submission = 1;
  while (fs::exists(at / fmt::format("bundles-{}.txt", submission))) ++submission;
  const fs::path lines = at / fmt::format("bundles-{}.txt", submission);
  const fs::path script = at / fmt::format("job-{}.sh", submission);
  replaceFile(lines, bundleLines(bundles));
  replaceFile(script, slurmScript(data.request.name, options.lab, campaign, lines));
  std::string range = fmt::format("--array=0-{}", bundles.size() - 1);
  if (options.jobs > 0) range += fmt::format("%{}", options.jobs);
  std::vector<std::string> arguments{"sbatch", "--parsable", range,
                                     "--output=" + outputPattern(at)};
  for (std::string& word : wordsOf(options.slurm)) arguments.push_back(std::move(word));
  arguments.push_back(script.string());
  const ToolEnd end = runTool(arguments);
  if (end.interrupted) {
    throw UserError("sbatch: ended by the user; squeue --me says whether it has submitted a job");
  }
  if (!end.ok()) {
    throw UserError(
        fmt::format("sbatch: {}; the script is {}, and --slurm gives sbatch further "
                    "options",
                    end.lastLine(), script.string()));
  }
  const std::string job = end.output.substr(0, end.output.find_first_of(";\n"));
  std::string all;
  for (const std::string& id : recordedJobs(folder)) all += id + "\n";
  replaceFile(at / kJobs, all + job + "\n", Sync::kYes);
  fmt::print(
      "slurm    job {}: {}{}\n", printable(job),
      countText(static_cast<std::int64_t>(bundles.size()), "task"),
      number > 1 ? fmt::format(", submission {} of at most {}", number, kMostSubmissions) : "");
  std::fflush(stdout);
  return job;
}

/// @return false when the user ended it
bool waitFor(const std::string& job, CampaignData& data, const fs::path& folder,
             const std::vector<std::size_t>& rows, const EngineOptions& options) {
  while (true) {
    const std::optional<std::size_t> tasks = tasksLeft(job);
    if (!tasks) return false;
    const bool ended = *tasks == 0;
    refreshRows(data, folder, rows);
    if (options.watch) options.watch();
    if (ended) return true;
    for (int i = 0; i < 10; ++i) {
      if (wasInterrupted()) return false;
      std::this_thread::sleep_for(kPoll / 10);
    }
  }
}

}  // namespace

EngineEnd runBySlurm(CampaignData& data, const fs::path& folder,
                     const std::vector<std::size_t>& rows, const EngineOptions& options) {
  const auto left = [](const std::string& job) {
    return EngineEnd{true, false,
                     fmt::format("job {} goes on in the queue (scancel {} ends it)", job, job)};
  };
  for (const std::string& job : recordedJobs(folder)) {
    const std::optional<std::size_t> tasks = tasksLeft(job);
    if (!tasks) return left(job);
    if (*tasks == 0) continue;
    fmt::print("slurm    job {} is in the queue with {}\n", printable(job),
               countText(static_cast<std::int64_t>(*tasks), "task"));
    if (!options.wait) return left(job);
    if (!waitFor(job, data, folder, rows, options)) return left(job);
  }
  refreshRows(data, folder, rows);
  for (int number = 1; number <= kMostSubmissions; ++number) {
    const std::vector<std::size_t> missing = missingRows(data, rows);
    if (missing.empty()) return {};
    const std::string job =
        submit(data, folder, bundlesOf(missing, options.bundle), options, number);
    if (!options.wait) return left(job);
    if (!waitFor(job, data, folder, missing, options)) return left(job);
  }
  const std::size_t missing = missingRows(data, rows).size();
  if (missing == 0) return {};
  return {false, false,
          fmt::format("{} have no result after {} submissions; the tasks' messages are in {}",
                      countText(static_cast<std::int64_t>(missing), "run"), kMostSubmissions,
                      (folder / names::kSlurm).string())};
}

}  // namespace lab::runner::campaign
