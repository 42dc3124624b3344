#include "runner/live/supervisor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <thread>
#include <utility>

#include "common/experiment/command_line_sources.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/service_placement.hpp"
#include "runner/hosts/host_files.hpp"
#include "runner/hosts/remote_hosts.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr const char* kGatewayService = "dds_gateway";
constexpr int kLinkSettles_ms = 300;  // [ms] for the last messages of other hosts
// On a loaded machine a service needs seconds for its last messages, the recorder for its buffers.
constexpr int kEndTimeout_ms = 10'000;

}  // namespace

Supervisor::Supervisor(const PreparedRun& run, const LiveOptions& options,
                       std::int64_t clock_offset_us)
    : run_(run), options_(options), clock_offset_us_(clock_offset_us) {
  fs::create_directories(logFolder());
}

fs::path Supervisor::logFolder() const { return run_.directory / files::kServiceLogs; }

/// A restarted recorder goes on in a file of its own: log.lcmlog.01, log.lcmlog.02 ...
fs::path Supervisor::logFile() const {
  return run_.directory / (recorder_.restarts == 0
                               ? files::kLog
                               : fmt::format("{}.{:02}", files::kLog, recorder_.restarts));
}

void Supervisor::startRecorder() {
  recorder_.process =
      startHere({(options_.programs / recorder_.name).string(), "--log", logFile().string(),
                 "--lcm-url", options_.url, "--clock-offset-us", std::to_string(clock_offset_us_)},
                logOf(recorder_));
  heartbeats_.expect(recorder_.name);
  log_size_ = 0;
  heartbeats_since_growth_ = 0;
}

bool Supervisor::recorderWrites() const {
  std::error_code error;
  const auto size = fs::file_size(logFile(), error);
  return !error && size > 0;
}

void Supervisor::add(const std::string& name, const std::string& host, bool uses_ports) {
  Entry& entry =
      services_.emplace_back(Entry{.name = name, .uses_ports = uses_ports, .host = host});
  entry.process = startService(entry, run_.directory / files::kExperiment);
  if (host.empty()) heartbeats_.expect(name);
}

bool Supervisor::joinsBuses() const {
  return options_.hosts != nullptr && joinsByGateways(run_.experiment, options_.hosts->names());
}

void Supervisor::startGateways() {
  if (!joinsBuses()) return;
  // The local gateway first: it must be READY before messages of other hosts can pass.
  add(kGatewayService, "", false);
  for (const std::string& host : options_.hosts->names()) add(kGatewayService, host, false);
}

void Supervisor::startServices() {
  for (const std::string& name : neededServices(run_.experiment)) {
    if (joinsBuses() && name == kGatewayService) continue;
    add(name, options_.hosts == nullptr ? "" : hostOf(run_.experiment, name), usesPorts(name));
  }
}

std::vector<std::string> Supervisor::argumentsOf(const Entry& entry) const {
  std::vector<std::string> arguments;
  const std::string pipeline = pipelineOf(run_.experiment.camera);
  if (entry.name == "tracker_svc" && !pipeline.empty()) {
    arguments.push_back("--camera-pipeline=" + pipeline);
  }
  if (entry.name == "sim_svc" && run_.threads > 0) {
    arguments.push_back("--threads=" + std::to_string(run_.threads));
  }
  if (entry.name != kGatewayService) return arguments;
  if (joinsBuses()) arguments = options_.hosts->linkArguments(entry.host);
  if (const std::string file = run_.experiment.gateway.configuration; !file.empty()) {
    arguments.push_back("--dds-configuration=" +
                        (entry.host.empty() ? file : std::string(kDdsConfigurationElsewhere)));
  }
  return arguments;
}

std::unique_ptr<ServiceProcess> Supervisor::startService(const Entry& entry, const fs::path& file) {
  if (!entry.host.empty()) return startThere(entry, file);
  std::vector<std::string> arguments{(options_.programs / entry.name).string(),
                                     "--experiment",
                                     file.string(),
                                     "--lcm-url",
                                     options_.url,
                                     "--clock-offset-us",
                                     std::to_string(clock_offset_us_)};
  if (entry.uses_ports) {
    arguments.insert(arguments.end(), {"--ports", (run_.directory / files::kPorts).string()});
  }
  for (const std::string& argument : argumentsOf(entry)) arguments.push_back(argument);
  return startHere(arguments, logOf(entry));
}

std::unique_ptr<LocalProcess> Supervisor::startHere(const std::vector<std::string>& arguments,
                                                    const fs::path& output) {
  auto process = std::make_unique<LocalProcess>(arguments, output);
  if (process->pid() > 0) guard_.watch(process->pid());
  return process;
}

std::unique_ptr<ServiceProcess> Supervisor::startThere(const Entry& entry,
                                                       const fs::path& file) const {
  RemoteHost& host = options_.hosts->at(entry.host);
  const std::string name = file.filename().string();
  if (name != files::kExperiment) {
    host.send({name, {}, writeExperiment(experimentElsewhere(loadExperiment(file)))});
  }
  return host.start({.service = entry.name,
                     .experiment = name,
                     .uses_ports = entry.uses_ports,
                     .arguments = argumentsOf(entry)});
}

fs::path Supervisor::logOf(const Entry& entry) const {
  return logFolder() / entry.host / (entry.name + ".txt");
}

/// "sim_svc", "sim_svc on bench"
static std::string titleOf(const std::string& name, const std::string& host) {
  return host.empty() ? name : name + " on " + host;
}

/// The last line of a log file, without its time and level.
static std::string lastLine(const fs::path& log) {
  std::ifstream file(log);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) last = line;
  }
  for (const std::string_view level : {"[error] ", "[critical] "}) {
    const auto at = last.find(level);
    if (at != std::string::npos) return last.substr(at + level.size());
  }
  return last;
}

std::string Supervisor::endedWith() const {
  for (const Entry& entry : services_) {
    if (entry.process->running()) continue;
    const std::string said = lastLine(logOf(entry));
    return titleOf(entry.name, entry.host) + ": " + (said.empty() ? entry.process->ending() : said);
  }
  return {};
}

std::string Supervisor::missing() const {
  std::string names;
  for (const Entry& entry : services_) {
    const bool here = entry.ready_pid != 0 && entry.ready_pid == entry.process->localPid();
    if (entry.host.empty() ? here : entry.process->ready()) continue;
    names += (names.empty() ? "" : ", ") + titleOf(entry.name, entry.host);
    if (!entry.process->running()) names += " (" + entry.process->ending() + ")";
  }
  return names;
}

void Supervisor::noteHeartbeat(const std::string& sender, pid_t pid, bool ready) {
  for (Entry& entry : services_) {
    if (entry.name != sender || !entry.host.empty() || entry.process->localPid() != pid) continue;
    if (ready) entry.ready_pid = pid;
    heartbeats_.beat(sender);
    ++heartbeats_since_growth_;
  }
}

/// The log grows by the messages of the services. While these are silent, a log that does not grow
/// says nothing about the recorder.
void Supervisor::checkLogGrowth() {
  std::error_code error;
  const auto size = fs::file_size(logFile(), error);
  const bool grew = !error && size != log_size_;
  if (!grew && heartbeats_since_growth_ > 0) return;
  heartbeats_.beat(recorder_.name);
  heartbeats_since_growth_ = 0;
  if (!error) log_size_ = size;
}

void Supervisor::checkHeartbeats(std::int64_t now,
                                 const std::function<void(const std::string&)>& silent,
                                 const std::function<void(const std::string&)>& again) {
  checkLogGrowth();
  for (const auto& [name, is_silent, silence_s] : heartbeats_.look(now)) {
    const bool recorder = name == recorder_.name;
    if (is_silent) {
      silent(recorder ? fmt::format("{} has written nothing for {} s", name, silence_s)
                      : fmt::format("{} has sent no heartbeat for {} s", name, silence_s));
    } else {
      again(recorder ? fmt::format("{} writes again after {} s", name, silence_s)
                     : fmt::format("{} sends heartbeats again after {} s", name, silence_s));
    }
  }
}

bool Supervisor::anyEnded() const {
  const auto ended = [](const Entry& entry) { return entry.process && !entry.process->running(); };
  return ended(recorder_) || std::any_of(services_.begin(), services_.end(), ended);
}

bool Supervisor::restartEnded(std::int64_t now,
                              const std::function<void(const std::string&)>& report,
                              const std::function<fs::path()>& resume) {
  const bool all_up = restartEach(now, resume);
  if (!all_up || recorderWrites()) reportHeld(report);
  return all_up;
}

void Supervisor::reportHeld(const std::function<void(const std::string&)>& report) {
  for (const std::string& what : std::exchange(held_, {})) report(what);
}

/// Decides when a process that has died is started again, if at all.
void Supervisor::noteDeath(Entry& entry, std::int64_t now) {
  const std::string title = titleOf(entry.name, entry.host);
  std::string ending = entry.process->ending();
  // A recorder that cannot write has said why, and cannot say it in the log.
  if (&entry == &recorder_ && ending.starts_with("exit code")) {
    ending += ": " + lastLine(logOf(entry));
  }
  if (entry.host.empty()) heartbeats_.forget(entry.name);
  entry.restart_utime = ending == kWithItsHost ? now : entry.limit.noteDeath(now);
  if (entry.restart_utime) {
    held_.push_back(
        fmt::format("{} died ({}) and {}", title, ending, restartText(*entry.restart_utime - now)));
    return;
  }
  entry.left_out = true;
  held_.push_back(fmt::format(
      "{} died ({}) and is not started again: it {}{}; see {}", title, ending, tooOftenText(),
      isDispensable(run_.experiment, entry.name) ? "; the run continues without it" : "",
      logOf(entry).string()));
}

/// Whether a process is dead and must be started now.
bool Supervisor::isDue(Entry& entry, std::int64_t now) {
  if (entry.left_out || entry.process->running()) return false;
  if (!entry.restart_utime) noteDeath(entry, now);
  if (!entry.restart_utime || now < *entry.restart_utime) return false;
  entry.restart_utime.reset();
  ++entry.restarts;
  return true;
}

bool Supervisor::restartEach(std::int64_t now, const std::function<fs::path()>& resume) {
  if (isDue(recorder_, now)) startRecorder();
  if (recorder_.left_out) return false;
  for (Entry& entry : services_) {
    if (isDue(entry, now)) {
      const fs::path file =
          entry.name == "sim_svc" ? resume() : run_.directory / files::kExperiment;
      entry.process = startService(entry, file);
      if (entry.host.empty()) heartbeats_.expect(entry.name);
    }
    if (entry.left_out && !isDispensable(run_.experiment, entry.name)) return false;
  }
  return true;
}

static std::string killedText(const std::string& title, int timeout_ms) {
  return fmt::format("{} did not end on request and was killed after {} s", title,
                     timeout_ms / 1000);
}

void Supervisor::endServices(const std::function<void(const std::string&)>& report) {
  const auto end = [&report](Entry& entry) {
    entry.process->terminate();
    if (!entry.process->waitOrKill(kEndTimeout_ms)) return;
    report(killedText(titleOf(entry.name, entry.host), kEndTimeout_ms));
  };
  // One after the other: their closing messages together would overflow the queue of a stock
  // logger. The gateways last, as they bring the messages of other hosts.
  for (Entry& entry : services_) {
    if (entry.name != kGatewayService) end(entry);
  }
  if (joinsBuses()) std::this_thread::sleep_for(std::chrono::milliseconds(kLinkSettles_ms));
  for (auto entry = services_.rbegin(); entry != services_.rend(); ++entry) {
    if (entry->name == kGatewayService) end(*entry);
  }
}

void Supervisor::endRecorder(const std::function<void(const std::string&)>& report) {
  if (!recorder_.process) return;
  recorder_.process->terminate();
  if (recorder_.process->waitOrKill(kEndTimeout_ms)) {
    report(killedText(recorder_.name, kEndTimeout_ms) + ": the log's end may be missing");
  }
}

}  // namespace lab::runner
