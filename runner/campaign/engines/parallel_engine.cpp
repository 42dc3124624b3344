#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "common/files/atomic_file.hpp"
#include "common/process/child_process.hpp"
#include "common/text/printable.hpp"
#include "runner/campaign/campaign_folder.hpp"
#include "runner/campaign/engines/bundles.hpp"
#include "runner/campaign/engines/engine.hpp"
#include "runner/campaign/engines/tool.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/live/launch.hpp"

namespace lab::runner::campaign {
namespace fs = std::filesystem;
namespace {

constexpr const char* kHere = ":";  // as GNU parallel names this machine
constexpr std::chrono::milliseconds kPollFiles{1000};

/// The words that run a command on a host, from what --sshlogin takes: "4/user@host", "ssh -p 22
/// host".
std::vector<std::string> sshWords(std::string host) {
  const std::size_t slash = host.find('/');
  if (slash != std::string::npos && host.find_first_not_of("0123456789") == slash) {
    host.erase(0, slash + 1);
  }
  std::vector<std::string> words;
  if (host.find(' ') == std::string::npos) {
    // It cannot ask: it has no terminal.
    words = {"ssh", "-o", "BatchMode=yes", "-o", "ConnectTimeout=10"};
  }
  std::string word;
  for (const char letter : host + " ") {
    if (letter != ' ') {
      word += letter;
    } else if (!word.empty()) {
      words.push_back(std::exchange(word, ""));
    }
  }
  return words;
}

ToolEnd onHost(const std::string& host, const std::string& command) {
  std::vector<std::string> words{"sh", "-c"};
  if (host != kHere) words = sshWords(host);
  words.push_back(command);
  ToolEnd end = runTool(words);
  if (end.interrupted) throw UserError(fmt::format("host {}: ended by the user", host));
  return end;
}

/// Whether every host sees the campaign at the same path; some but not all is an error.
bool isShared(const fs::path& campaign, const std::vector<std::string>& hosts) {
  std::vector<std::string> with;
  std::vector<std::string> without;
  for (const std::string& host : hosts) {
    const ToolEnd end = onHost(host, "test -f " + shellWord((campaign / names::kRequest).string()));
    if (end.code != 0 && end.code != 1) {
      throw UserError(fmt::format("host {}: {}; try: {} true", host, end.lastLine(),
                                  fmt::join(sshWords(host), " ")));
    }
    (end.ok() ? with : without).push_back(host);
  }
  if (with.empty()) return false;
  if (without.empty()) return true;
  throw UserError(fmt::format(
      "found the campaign's folder {} on {} and not on {}, expected it on all hosts (a shared file "
      "system) or on none; use two campaigns, or another folder",
      campaign.string(), fmt::join(with, ", "), fmt::join(without, ", ")));
}

/// Another version there would compute other runs.
void requireSameCode(const CampaignData& data, const fs::path& lab,
                     const std::vector<std::string>& hosts) {
  for (const std::string& host : hosts) {
    const ToolEnd end = onHost(host, shellWord(lab.string()) + " sweep . --code");
    std::string code = end.output;
    while (code.ends_with('\n')) code.pop_back();
    if (end.ok() && code == data.code.text) continue;
    throw UserError(fmt::format(
        "host {}: found {}, expected the lab of version {} at {}; update it there, or name its "
        "program with --lab-there",
        host, end.ok() ? "version " + printable(code) : end.lastLine(), data.code.text,
        lab.string()));
  }
}

std::string jobLines(const std::vector<Bundle>& bundles) {
  std::string text;
  for (std::size_t i = 0; i < bundles.size(); ++i) {
    text += fmt::format("{}\t{}\n", i, rowNumbersText(bundles[i]));
  }
  return text;
}

/// The arguments of GNU parallel.
std::vector<std::string> argumentsFor(const fs::path& campaign, bool shared,
                                      const EngineOptions& options) {
  const fs::path at = campaign / names::kParallel;
  std::vector<std::string> arguments{"parallel",   "--will-cite",
                                     "--colsep",   "\t",
                                     "--arg-file", (at / "jobs.txt").string(),
                                     "--joblog",   (at / "joblog.txt").string(),
                                     "--retries",  "2"};
  if (options.jobs > 0) {
    arguments.insert(arguments.end(), {"--jobs", std::to_string(options.jobs)});
  }
  for (const std::string& host : options.hosts) {
    arguments.insert(arguments.end(), {"--sshlogin", host});
  }
  const std::string lab = shellWord(options.lab.string());
  if (shared) {
    arguments.push_back(lab + " sweep " + shellWord(campaign.string()) + " --rows {2}");
    return arguments;
  }
  // GNU parallel copies with rsync: what follows /./ is the path on the host, below the work
  // folder. Each job has its own work folder ("..."), which --basefile does not know.
  const std::string here = campaign.string() + "/./";
  for (const char* file : {names::kRequest, names::kPoints, names::kFiles}) {
    if (fs::exists(campaign / file)) {
      arguments.insert(arguments.end(), {"--transferfile", here + file});
    }
  }
  arguments.insert(arguments.end(),
                   {"--workdir", "...", "--return", "bundle-{1}.jsonl", "--cleanup"});
  arguments.push_back(lab + " sweep . --rows {2} --bundle-file bundle-{1}.jsonl");
  return arguments;
}

}  // namespace

EngineEnd runByParallel(CampaignData& data, const fs::path& folder,
                        const std::vector<std::size_t>& rows, const EngineOptions& options) {
  requireProgram("parallel", "parallel");
  const fs::path campaign = fs::absolute(folder).lexically_normal();
  requireSameCode(data, options.lab, options.hosts);
  const bool shared = isShared(campaign, options.hosts);
  if (!shared) {
    requireProgram("rsync", "rsync");
    if (data.request.keep == Keep::kLogs) {
      throw UserError(
          "--keep logs: these hosts do not see the campaign's folder, and only numbers and "
          "summaries "
          "are sent back; put the campaign on a file system that all hosts share, or --keep "
          "summary");
    }
  }
  const fs::path at = campaign / names::kParallel;
  fs::create_directories(at);
  replaceFile(at / "jobs.txt", jobLines(bundlesOf(rows, options.bundle)));
  fmt::print("hosts    {}: {}\n", printable(fmt::format("{}", fmt::join(options.hosts, ", "))),
             shared ? "they share the campaign's folder"
                    : "the campaign is copied, results are sent back");
  std::fflush(stdout);
  // Files that are returned lie below its working folder.
  const fs::path returned = at / names::kReturned;
  fs::create_directories(returned);
  ChildProcess parallel({.arguments = argumentsFor(campaign, shared, options),
                         .folder = returned.string(),
                         .errors = ChildSettings::kInherited,
                         .death_signal = SIGTERM});
  const auto take = [&] {
    std::error_code error;
    for (fs::directory_iterator entry(returned, error), end; !error && entry != end;
         entry.increment(error)) {
      if (entry->path().extension() != ".jsonl") continue;
      takeResultBundle(data, folder, entry->path());
      std::error_code ignored;
      fs::remove(entry->path(), ignored);
    }
    refreshRows(data, folder, rows);
    if (options.watch) options.watch();
  };
  while (!parallel.waitFor(kPollFiles)) {
    take();
    if (!wasInterrupted()) continue;
    // The first TERM lets running jobs end, the second kills them.
    parallel.signal(SIGTERM);
    parallel.signal(SIGTERM);
    parallel.wait();
    take();
    return {true, false, "ended by the user"};
  }
  take();
  const std::size_t missing = missingRows(data, rows).size();
  if (missing == 0) return {};
  return {false, false,
          fmt::format("{} rows have no result; the jobs are listed in {}", missing,
                      (at / "joblog.txt").string())};
}

}  // namespace lab::runner::campaign
