#include "runner/live/launch.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "common/bus/lcm_bus.hpp"
#include "common/experiment/command_line_sources.hpp"
#include "common/experiment/experiment_reach.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/loop/wall_clock.hpp"
#include "common/math/units.hpp"
#include "common/process/installation.hpp"
#include "common/process/version.hpp"
#include "common/text/printable.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/doctor/doctor.hpp"
#include "runner/hosts/remote_hosts.hpp"
#include "runner/runs/lab_registry.hpp"
#include "runner/runs/network.hpp"
#include "runner/runs/place_checks.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

volatile std::sig_atomic_t interrupted = 0;

/// Packages leave out programs that only some experiments need, and `./lab` builds only those that
/// the command needs.
void requireParts(const Experiment& experiment, bool virtual_time) {
  for (const std::string& name : neededPrograms(experiment, virtual_time)) {
    const fs::path file = installation().programs / name;
    if (fs::exists(file)) continue;
    const bool chip = name.starts_with("robot_emulator") || name.starts_with("robot_firmware");
    throw UserError(
        fmt::format("this experiment needs {}, which does not exist: {}", file.string(),
                    installation().installHint(
                        name, chip ? "install gcc-avr, avr-libc, libsimavr-dev and build again"
                                   : "./lab build builds everything")));
  }
}

/// With ttl 0 the kernel keeps messages on this machine only while the interface does not change.
void warnOfReach(const Network& network) {
  const std::string warning =
      network.ttl == 0 ? unpinnedWarning() : "the bus is " + openBusText(network);
  if (!warning.empty()) fmt::print(stderr, "warn     {}\n", printable(warning));
}

RunOutcome execute(const LaunchOptions& options, const PreparedRun& run, const std::string& name,
                   const std::string& url, RemoteHosts* hosts,
                   const std::function<void()>& announce, const ShowProgress& show,
                   const ProcedureFactory& procedure) {
  if (!options.run_virtual) {
    return runLive(run,
                   {.name = name,
                    .url = url,
                    .programs = options.programs,
                    .hosts = hosts,
                    .port = run.experiment.network.port,
                    .web = options.web,
                    .web_address = options.web_address,
                    .cameras = options.cameras,
                    .announce = announce},
                   show, procedure);
  }
  announce();
  std::signal(SIGINT, [](int) { interrupted = 1; });
  std::signal(SIGTERM, [](int) { interrupted = 1; });
  return options.run_virtual(
      run, show, [] { return interrupted != 0; }, procedure);
}

/// Writes what may differ between two runs of the same file and seed.
void writeProvenance(const LaunchOptions& options, const PreparedRun& run, const std::string& url,
                     std::int64_t start, const RunOutcome& outcome) {
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  const std::int64_t end = wallClock();
  const nlohmann::ordered_json json{
      {"experiment_file", fs::absolute(options.file).string()},
      {"set", options.set},
      {"user_program", options.user_program ? describe(*options.user_program) : std::string()},
      {"started", utcText(start)},
      {"ended", utcText(end)},
      {"wall_s", units::seconds(end - start)},
      {"virtual_time", static_cast<bool>(options.run_virtual)},
      {"host", host},
      {"bus", url},
      {"version", kVersion},
      {"interrupted", outcome.interrupted},
      {"faults", outcome.faults}};
  // Faults quote what others have sent, which may be no UTF-8.
  constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;
  writeNewFile(run.directory / files::kProvenance, json.dump(2, ' ', false, kReplace) + "\n");
}

}  // namespace

std::vector<std::string> neededPrograms(const Experiment& experiment, bool virtual_time) {
  std::vector<std::string> names;
  const auto is_here = [&](const std::string& service) {
    return virtual_time || hostOf(experiment, service).empty();
  };
  if (!virtual_time) {
    names.emplace_back("recorder");
    for (const std::string& service : neededServices(experiment)) {
      if (is_here(service)) names.push_back(service);
    }
  }
  const bool chips = std::ranges::any_of(
      experiment.robots, [](const RobotSpec& robot) { return robot.body == Body::kFirmware; });
  if (chips && is_here("sim_svc")) {
    names.insert(names.end(), {"robot_emulator", "robot_firmware.elf"});
  }
  return names;
}

std::string diskProblem(const Experiment& experiment, const fs::path& folder,
                        std::string_view other_folder) {
  const std::int64_t need = diskNeed_bytes(experiment);
  const std::int64_t have = freeBytes(folder);
  if (have >= need) return {};
  return fmt::format(
      "too little disk in {}: this run needs about {} MB, {} MB are free; make room, {}, or "
      "shorten duration_s",
      folder.string(), need / 1'000'000, have / 1'000'000, other_folder);
}

fs::path requireProgram(const std::string& name, const std::string& package) {
  if (const auto path = findProgram(name)) return *path;
  throw UserError(fmt::format("{} is not installed: sudo apt-get install {}", name, package));
}

Launched launch(const LaunchOptions& options, Experiment experiment, const ShowProgress& show,
                const ProcedureFactory& procedure) {
  const bool virtual_time = static_cast<bool>(options.run_virtual);
  std::string url;
  std::optional<PortLock> port_lock;
  std::optional<RemoteHosts> hosts;
  const Camera& camera = experiment.camera;
  if (virtual_time && camera.tracker == Tracker::kCamera && !isPainted(camera)) {
    throw UserError(fmt::format(
        "camera.camera = \"{}\": in virtual time there is only the simulated camera; set camera = "
        "\"sim\", or run in real time",
        camera.source));
  }
  if (!virtual_time && experiment.robots.size() > kMostLiveRobots) {
    throw UserError(fmt::format(
        "robots: found {} robots, a lab in real time has at most {}, because their messages do not "
        "fit into one datagram; add --virtual-time",
        experiment.robots.size(), kMostLiveRobots));
  }
  if (camera.tracker == Tracker::kCamera || options.cameras) requirePipeline(experiment);
  if (isFilmed(camera)) requireProgram("ffmpeg", "ffmpeg");
  requireParts(experiment, virtual_time);
  if (const std::string problem = diskProblem(experiment, options.out); !problem.empty()) {
    throw UserError(problem);
  }
  const fs::path source = options.file.parent_path();
  checkFiles(experiment, source);  // before an agent is started on another host
  if (!virtual_time) {
    if (const auto problem = multicastProblem()) throw UserError(*problem);
    const bool wanted = experiment.network.port != 0;
    experiment.network.port = choosePort(experiment.network.port);
    port_lock.emplace(experiment.network.port);
    url = lcmUrl(experiment.network.port, experiment.network.ttl);
    // Services send a heartbeat once a second. A port that was free a moment ago is watched only
    // briefly.
    refuseForeignTraffic(url, wanted ? 1300 : 300);
    warnOfReach(experiment.network);
    requireCertificates(experiment, source);
    const std::vector<std::string> others = hostsInUse(experiment);
    if (!others.empty()) hosts.emplace(experiment, others);
  }

  const std::int64_t start = wallClock();
  PreparedRun prepared = prepareCheckedRun(std::move(experiment), source, options.out, start);
  prepared.threads = options.threads;
  prepared.user_program = options.user_program;
  if (prepared.user_program) adoptUserProgram(*prepared.user_program, prepared.directory);
  std::optional<Registration> registration;
  std::string name = prepared.directory.filename().string();
  std::string head = fmt::format("run      {}\n", prepared.directory.string());
  if (!virtual_time) {
    head += fmt::format("bus      {}\n", url);
    if (hosts) head += hosts->describe();
    registration.emplace(
        RunningLab{name, url, getpid(), fs::absolute(prepared.directory).string()});
    if (registration->name() != printable(name)) {
      head += fmt::format("lab      {} (another running lab is named {})\n", registration->name(),
                          name);
    }
    name = registration->name();
  }
  const auto announce = [&head] {
    fmt::print("{}", printableLines(head));
    std::fflush(stdout);
  };
  RunOutcome outcome =
      execute(options, prepared, name, url, hosts ? &*hosts : nullptr, announce, show, procedure);
  registration.reset();
  // The report takes seconds; Ctrl-C must not leave it half-written.
  std::signal(SIGINT, SIG_IGN);
  try {
    writeProvenance(options, prepared, url, start, outcome);
  } catch (const UserError& error) {
    // The run is over, and its faults must be reported although this file cannot be written.
    outcome.closed_early = true;
    outcome.faults.emplace_back(error.what());
  }
  return {prepared.directory, std::move(outcome)};
}

}  // namespace lab::runner
