#include "runner/live/run_live.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <lab/link_status_t.hpp>
#include <lab/service_status_t.hpp>
#include <optional>
#include <thread>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/bus/unicast_sink.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/loop/asio_loop.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/command_line/print_line.hpp"
#include "runner/hosts/remote_hosts.hpp"
#include "runner/live/dashboard_process.hpp"
#include "runner/live/resumed_experiment.hpp"
#include "runner/live/supervisor.hpp"
#include "runner/runs/lab_registry.hpp"
#include "runner/user_program/user_program.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kSupervise_us = 100'000;
constexpr std::int64_t kShowEvery_us = 500'000;
constexpr std::int64_t kDiskEvery_us = 1'000'000;
constexpr std::int64_t kSinkEvery_us = 1'000'000;
constexpr std::int64_t kReadyTimeout_us = 10'000'000;
constexpr std::int64_t kAttend_us = 50'000;
constexpr std::int64_t kJoinTimeout_us = 20'000'000;
// The script starts without waiting longer for the dashboard's address, which is printed first.
constexpr std::int64_t kDashboardTimeout_us = 3'000'000;
constexpr int kTick_ms = 20;
constexpr int kRobotsStop_ms = 500;
constexpr int kBusSettles_ms = 500;

/// One live run from the first process to the last.
class LiveRun {
 public:
  LiveRun(const PreparedRun& run, const LiveOptions& options, const ShowProgress& show,
          const ProcedureFactory& procedure)
      : run_(run),
        options_(options),
        show_(show),
        bus_(options.url),
        node_(bus_, loop_, {"lab", 0, loop_.now()}),
        controller_({node_, loop_, run.experiment, run.directory}, run.effective,
                    [this](Ending ending, const std::string& why) { over(ending, why); }),
        supervisor_(run, options, loop_.clockOffset()),
        unicast_sink_(static_cast<std::uint16_t>(options.port)) {
    node_.reportBus([this] {
      RefusedDatagrams refused = bus_.refused();
      refused.add(unicast_sink_.refused());
      return refused.rows();
    });
    if (procedure) {
      if (options.cameras) cameras_ = options.cameras(loop_, run.directory / files::kPorts);
      procedure_.emplace(bus_, loop_, cameras_ ? *cameras_ : noCameras(), run, loop_.now(),
                         procedure, controller_, [this] { finish(kProcedureDone); });
    }
    node_.subscribe<service_status_t>(channels::kServiceStatus, [this](const auto& status) {
      supervisor_.noteHeartbeat(status.sender, status.pid, status.state == service_status_t::READY);
    });
    if (hosts() != nullptr) {
      node_.subscribe<link_status_t>(channels::kLinkStatus,
                                     [this](const auto& status) { hosts()->take(status); });
    }
    loop_.onReadable(bus_.fileDescriptor(), [this] { bus_.drain(); });
    loop_.onSignals({SIGINT, SIGTERM, SIGHUP}, [this](int) {
      outcome_.interrupted = true;
      if (started_) finish("ended by the user");
    });
  }

  RunOutcome execute() {
    try {
      start();
    } catch (...) {
      announce();
      throw;
    }
    announce();
    guarded([this] { conduct(); });
    guarded([this] { end(); });
    endProcesses();
    endUserProgram();
    for (const std::string& fault : controller_.faults()) outcome_.faults.push_back(fault);
    supervisor_.reportHeld([this](const std::string& what) { outcome_.faults.push_back(what); });
    return outcome_;
  }

 private:
  void conduct() {
    controller_.announceMarks([](const std::string& label, const std::string& what) {
      printLine(fmt::format("{:<9}{}", label, what));
    });
    controller_.begin();
    controlling_ = true;
    for (const std::string& what : early_remarks_) controller_.mark(what);
    if (run_.user_program) {
      controller_.mark(describe(*run_.user_program));
      user_process_.emplace(*run_.user_program, run_.directory,
                            std::vector<std::string>{"ACTIVE_LAB_URL=" + options_.url});
    }
    loop_.every(kSupervise_us, loop_.now(), [this] { supervise(); });
    loop_.every(kShowEvery_us, loop_.now(), [this] { show_(controller_.progress()); });
    loop_.every(kSinkEvery_us, loop_.now(), [this] { unicast_sink_.update(); });
    loop_.every(kDiskEvery_us, loop_.now(), [this] { watchDisk(); });
    if (hosts() != nullptr) loop_.every(kAttend_us, loop_.now(), [this] { watchHosts(); });
    loop_.run();
  }

  /// After the run has begun, an error (the network goes down, a program cannot be restarted) ends
  /// it early, but keeps its data.
  void guarded(const std::function<void()>& part) {
    try {
      part();
    } catch (const std::exception& error) {
      outcome_.closed_early = true;
      outcome_.faults.emplace_back(error.what());
    }
  }

  [[nodiscard]] RemoteHosts* hosts() const { return options_.hosts; }

  void announce() {
    if (announced_) return;
    announced_ = true;
    if (options_.announce) options_.announce();
  }

  void start() {
    // Connecting the buses of several hosts may take 20 s: the user sees the run's folder
    // meanwhile.
    if (!options_.web || hosts() != nullptr) announce();
    if (hosts() != nullptr) {
      hosts()->begin(run_, options_.name, supervisor_.logFolder(), options_.port);
    }
    supervisor_.startRecorder();
    // This node's heartbeat is the first message for the recorder.
    waitUntil([this] { return supervisor_.recorderWrites(); }, [this] { node_.ready(); },
              [this] { return "the recorder wrote nothing" + whereToLook(); });
    if (hosts() != nullptr) joinBuses();
    startDashboard();
    supervisor_.startServices();
    const std::int64_t give_up_utime = loop_.now() + kDashboardTimeout_us;
    waitUntil(
        [&] {
          return supervisor_.missing().empty() && (announced_ || loop_.now() > give_up_utime);
        },
        [] {},
        [this] {
          const std::string ended = supervisor_.endedWith();
          return (ended.empty() ? "not ready: " + supervisor_.missing() : ended) + whereToLook();
        });
    node_.start();
    if (procedure_) procedure_->begin();
    started_ = true;
  }

  /// Starts the dashboard before the services, so that it receives their first messages. Nothing
  /// waits for it.
  void startDashboard() {
    if (!options_.web) return;
    page_.emplace(DashboardOptions{.program = options_.programs / kObserverService,
                                   .url = options_.url,
                                   .experiment = run_.directory / files::kExperiment,
                                   .runs = fs::absolute(run_.directory).parent_path(),
                                   .address_file = registryFile(kPageFile),
                                   .address_copy = options_.web_address,
                                   .output = supervisor_.logFolder() / "dashboard.txt"});
    page_->start([this](const std::string& what) { reportDashboard(what); });
  }

  void superviseDashboard() {
    if (!page_) return;
    page_->supervise(loop_.now(), [this](const std::string& what) { reportDashboard(what); });
    if (!page_->address().empty() || page_->givenUp()) announce();
  }

  void reportDashboard(const std::string& what) {
    printLine("web      " + what);
    controlling_ ? controller_.mark(what) : early_remarks_.push_back(what);
  }

  /// Connects the buses of all hosts before the services start, so that no message is missed.
  void joinBuses() {
    supervisor_.startGateways();
    waitUntil([this] { return supervisor_.missing().empty() && hosts()->notJoined().empty(); },
              [] {},
              [this] {
                const std::string ended = supervisor_.endedWith();
                const std::string missing = supervisor_.missing();
                return (!ended.empty()     ? ended
                        : !missing.empty() ? "not ready: " + missing
                                           : hosts()->notJoined()) +
                       whereToLook();
              },
              kJoinTimeout_us);
  }

  [[nodiscard]] std::string whereToLook() const {
    return "; see " + supervisor_.logFolder().string() +
           ". All processes of the run have been ended.";
  }

  /// Calls `meanwhile` every kTick_ms until `done`.
  /// @throws UserError, after ending all processes, on timeout and when the user ends the run
  void waitUntil(const std::function<bool()>& done, const std::function<void()>& meanwhile,
                 const std::function<std::string()>& complaint,
                 std::int64_t timeout_us = kReadyTimeout_us) {
    const std::int64_t deadline = loop_.now() + timeout_us;
    while (!done() || outcome_.interrupted) {
      std::string trouble = hosts() == nullptr ? "" : hosts()->trouble();
      if (outcome_.interrupted) trouble = "ended by the user before it had begun";
      if (loop_.now() > deadline || supervisor_.anyEnded() || !trouble.empty()) {
        const std::string text = trouble.empty() ? complaint() : trouble;
        endProcesses();
        throw UserError(text);
      }
      meanwhile();
      superviseDashboard();
      if (hosts() != nullptr) hosts()->attend();
      loop_.poll();
      std::this_thread::sleep_for(std::chrono::milliseconds(kTick_ms));
    }
  }

  void endProcesses() {
    page_.reset();
    const auto report = [this](const std::string& what) { outcome_.faults.push_back(what); };
    supervisor_.endServices(report);
    supervisor_.endRecorder(report);
    if (hosts() != nullptr) hosts()->leave();
  }

  void watchHosts() {
    if (finishing_) {
      hosts()->attend();
      return;
    }
    const std::string over =
        hosts()->watch({.fault = [this](const std::string& what) { controller_.fault(what); },
                        .mark = [this](const std::string& what) { controller_.mark(what); }});
    if (!over.empty()) closeEarly(over);
  }

  void supervise() {
    if (finishing_) return;
    superviseDashboard();
    superviseUserProgram();
    const bool all_up = supervisor_.restartEnded(
        loop_.now(), [this](const std::string& what) { controller_.fault(what); },
        [this] { return resume(); });
    if (!all_up) closeEarly("a process of the run died too often");
    supervisor_.checkHeartbeats(
        loop_.now(), [this](const std::string& what) { controller_.fault(what); },
        [this](const std::string& what) { controller_.mark(what); });
  }

  fs::path resume() {
    ++restarts_;
    const fs::path file = run_.directory / fmt::format("resumed_{:02}.toml", restarts_);
    writeNewFile(file, writeExperiment(
                           resumedExperiment(run_.experiment, controller_.lastPoses(), restarts_)));
    return file;
  }

  void superviseUserProgram() {
    if (!user_process_ || user_process_ended_ || user_process_->running()) return;
    user_process_ended_ = true;
    controller_.mark("the user program has ended");
    if (const std::string problem = user_process_->problem(); !problem.empty()) closeEarly(problem);
  }

  /// It learns from EXPERIMENT_STATUS that the run is over, and may then still save its results.
  void endUserProgram() {
    if (!user_process_ || user_process_ended_) return;
    user_process_->waitForEnd([this] {
      loop_.poll();  // for Ctrl-C
      return outcome_.interrupted;
    });
    if (const std::string problem = user_process_->problem(); !problem.empty()) {
      outcome_.faults.push_back(problem);
    }
  }

  void watchDisk() {
    std::error_code error;
    const auto space = fs::space(run_.directory, error);
    if (error) {
      closeEarly(fmt::format("the run's folder {} cannot be reached: {}; its data are lost",
                             run_.directory.string(), error.message()));
    } else if (!fs::exists(run_.directory / files::kLog, error)) {
      closeEarly(fmt::format("the log {} is gone: what was recorded is lost",
                             (run_.directory / files::kLog).string()));
    } else if (static_cast<std::int64_t>(space.available) <= options_.disk_reserve) {
      closeEarly(fmt::format("the disk is full ({} MB left)", space.available / 1'000'000));
    }
  }

  void over(Ending ending, const std::string& why) {
    if (ending == Ending::kBroken) {
      closeEarly(why);
      return;
    }
    outcome_.interrupted = outcome_.interrupted || ending == Ending::kRequested;
    outcome_.closed_early = outcome_.closed_early || ending == Ending::kUnmet;
    finish(why);
  }

  void closeEarly(const std::string& why) {
    if (finishing_) return;
    outcome_.closed_early = true;
    const auto& known = controller_.faults();
    if (std::find(known.begin(), known.end(), why) == known.end()) controller_.fault(why);
    controller_.stopRobots(why);
    finish(why);
  }

  void finish(const std::string& why) {
    if (finishing_) return;
    finishing_ = true;
    outcome_.ended_because = why;
    controller_.conclude(why);
    // Robots receive the stop and report it before their services end.
    loop_.at(loop_.now() + kRobotsStop_ms * 1000, [this] { loop_.stop(); });
  }

  /// Ends the publishers, waits, then ends the recorder, so that the log has the last messages.
  void end() {
    show_(controller_.progress());
    supervisor_.endServices([this](const std::string& what) { controller_.fault(what); });
    if (procedure_) procedure_->end();
    node_.close();
    page_.reset();  // only now, so that it can show the end of the run
    for (int waited = 0; waited < kBusSettles_ms; waited += kTick_ms) {
      bus_.drain();
      std::this_thread::sleep_for(std::chrono::milliseconds(kTick_ms));
    }
    supervisor_.endRecorder([this](const std::string& what) { outcome_.faults.push_back(what); });
  }

  const PreparedRun& run_;
  const LiveOptions& options_;
  const ShowProgress& show_;
  AsioLoop loop_;
  LcmBus bus_;
  std::unique_ptr<Cameras> cameras_;  ///< for the procedure
  Node node_;
  ExperimentController controller_;
  std::optional<ProcedureNode> procedure_;
  Supervisor supervisor_;
  UnicastSink unicast_sink_;  ///< for stock programs
  std::optional<DashboardProcess> page_;
  std::optional<UserProcess> user_process_;
  bool user_process_ended_ = false;
  RunOutcome outcome_;
  bool announced_ = false;
  bool started_ = false;
  bool controlling_ = false;
  std::vector<std::string> early_remarks_;  ///< of the dashboard, made before the record began
  bool finishing_ = false;
  int restarts_ = 0;
};

}  // namespace

RunOutcome runLive(const PreparedRun& run, const LiveOptions& options, const ShowProgress& show,
                   const ProcedureFactory& procedure) {
  return LiveRun(run, options, show, procedure).execute();
}

}  // namespace lab::runner
