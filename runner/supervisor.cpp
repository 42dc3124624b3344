#include "runner/supervisor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "runner/services.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr int kMostRestarts = 5;
constexpr int kServicePatience_ms = 3000;
constexpr int kLoggerPatience_ms = 10000;  // it writes what it holds before it ends

}  // namespace

Supervisor::Supervisor(const PreparedRun& run, const LiveOptions& options)
    : run_(run), options_(options) {
  fs::create_directories(logFolder());
}

fs::path Supervisor::logFolder() const { return run_.directory / files::kServiceLogs; }

void Supervisor::startLogger() {
  // A restarted logger goes on in a file of its own: log.lcmlog.01, log.lcmlog.02 ... Its options
  // -l, --increment and --strftime are broken in LCM 1.3.1; --lcm-url= works.
  const std::string name =
      logger_.restarts == 0 ? files::kLog : fmt::format("{}.{:02}", files::kLog, logger_.restarts);
  logger_.process = std::make_unique<ChildProcess>(
      logger_.name,
      std::vector<std::string>{options_.lcm_logger.string(), "-q", "--lcm-url=" + options_.url,
                               (run_.directory / name).string()},
      logFolder() / "lcm-logger.txt");
}

bool Supervisor::loggerWrites() const {
  std::error_code error;
  const auto size = fs::file_size(run_.directory / files::kLog, error);
  return !error && size > 0;
}

void Supervisor::startServices() {
  for (const ServiceDescription& description : labServices(run_.experiment)) {
    services_.push_back({description.name,
                         startService(description.name, description.uses_ports,
                                      run_.directory / files::kExperiment),
                         0, description.uses_ports});
  }
}

std::unique_ptr<ChildProcess> Supervisor::startService(const std::string& name, bool uses_ports,
                                                       const fs::path& file) const {
  std::vector<std::string> arguments{(options_.programs / name).string(), "--experiment",
                                     file.string(), "--lcm-url", options_.url};
  if (uses_ports) {
    arguments.insert(arguments.end(), {"--ports", (run_.directory / files::kPorts).string()});
  }
  return std::make_unique<ChildProcess>(name, arguments, logFolder() / (name + ".txt"));
}

/// What a program said last, without the time and level that its log begins a line with.
static std::string lastLine(const fs::path& log) {
  std::ifstream file(log);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) last = line;
  }
  constexpr std::string_view kLevel = "[error] ";
  const auto level = last.find(kLevel);
  return level == std::string::npos ? last : last.substr(level + kLevel.size());
}

std::string Supervisor::endedWith() const {
  for (const Entry& entry : services_) {
    if (entry.process->running()) continue;
    const std::string said = lastLine(logFolder() / (entry.name + ".txt"));
    return entry.name + ": " + (said.empty() ? entry.process->ending() : said);
  }
  return {};
}

std::string Supervisor::missing() const {
  std::string names;
  for (const Entry& entry : services_) {
    if (ready_.contains(entry.process->pid())) continue;
    names += (names.empty() ? "" : ", ") + entry.name;
    if (!entry.process->running()) names += " (" + entry.process->ending() + ")";
  }
  return names;
}

bool Supervisor::anyEnded() const {
  const auto ended = [](const Entry& entry) { return entry.process && !entry.process->running(); };
  return ended(logger_) || std::any_of(services_.begin(), services_.end(), ended);
}

bool Supervisor::revive(const std::function<void(const std::string&)>& report,
                        const std::function<fs::path()>& resume) {
  const auto died = [&report](Entry& entry) {
    if (entry.process->running()) return false;
    const bool again = ++entry.restarts <= kMostRestarts;
    report(fmt::format("{} died ({}) and {}", entry.name, entry.process->ending(),
                       again ? "was restarted" : "is given up"));
    return true;
  };
  if (died(logger_)) {
    if (logger_.restarts > kMostRestarts) return false;
    startLogger();
  }
  for (Entry& entry : services_) {
    if (!died(entry)) continue;
    if (entry.restarts > kMostRestarts) return false;
    const fs::path file = entry.name == "sim_svc" ? resume() : run_.directory / files::kExperiment;
    entry.process = startService(entry.name, entry.uses_ports, file);
  }
  return true;
}

void Supervisor::endServices() {
  // One after the other: their closing messages together would overflow the logger's queue.
  for (Entry& entry : services_) {
    entry.process->terminate();
    entry.process->waitOrKill(kServicePatience_ms);
  }
}

void Supervisor::endLogger() {
  if (!logger_.process) return;
  logger_.process->terminate();
  logger_.process->waitOrKill(kLoggerPatience_ms);
}

}  // namespace lab::runner
