/// The processes of a run in real time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/process/orphan_guard.hpp"
#include "runner/live/heartbeat_monitor.hpp"
#include "runner/live/local_process.hpp"
#include "runner/live/restart_limit.hpp"
#include "runner/live/run_live.hpp"

namespace lab::runner {

/// Starts, watches, restarts and ends the recorder and the services of one run, on this machine and
/// on other hosts.
///
/// Order of calls: startRecorder(), startGateways() when recorderWrites(), startServices() when
/// missing() is empty; during the run restartEnded() and checkHeartbeats() repeatedly; at the end
/// endServices(), endRecorder(), reportHeld(). noteHeartbeat() at any time after startRecorder().
class Supervisor {
 public:
  /// @param clock_offset_us of the runner's loop: all services of this machine share its time,
  ///   also those that are restarted after a step of the wall clock
  Supervisor(const PreparedRun& run, const LiveOptions& options, std::int64_t clock_offset_us);

  void startRecorder();

  /// Starts the gateways that connect the buses of all hosts; none if all services are here.
  void startGateways();
  void startServices();

  /// Whether the newest recorder has written something.
  [[nodiscard]] bool recorderWrites() const;

  /// Takes a heartbeat. Processes are known by sender and pid: two hosts may use the same pid.
  void noteHeartbeat(const std::string& sender, pid_t pid, bool ready);

  /// Names of the services that were started and are not READY, for the user; empty: none.
  [[nodiscard]] std::string missing() const;

  /// A service that ended by itself, with its last line of output; empty: none.
  [[nodiscard]] std::string endedWith() const;

  /// Whether a process has ended by itself.
  [[nodiscard]] bool anyEnded() const;

  /// Folder of the output of all processes.
  [[nodiscard]] std::filesystem::path logFolder() const;

  /// Restarts processes that died (RestartLimit); one that dies too often is left out if
  /// isDispensable().
  /// @param report called with one sentence per death. The sentences are held back until a
  ///   recorder writes, but delivered at once if the result is false
  /// @param resume makes the experiment file for a restarted sim_svc
  /// @return false if a process that the run needs died too often
  [[nodiscard]] bool restartEnded(std::int64_t now,
                                  const std::function<void(const std::string&)>& report,
                                  const std::function<std::filesystem::path()>& resume);

  /// Checks that the services of this machine send heartbeats and that the log grows. Call at least
  /// every HeartbeatMonitor::kLongestStep_us.
  /// @param silent called once with a sentence when one does not
  /// @param again called with a sentence when it does again
  void checkHeartbeats(std::int64_t now, const std::function<void(const std::string&)>& silent,
                       const std::function<void(const std::string&)>& again);

  /// Reports what happened while no recorder ran.
  void reportHeld(const std::function<void(const std::string&)>& report);

  /// @param report called with a sentence for each that had to be killed
  void endServices(const std::function<void(const std::string&)>& report);
  void endRecorder(const std::function<void(const std::string&)>& report);

 private:
  struct Entry {
    std::string name;
    std::unique_ptr<ServiceProcess> process{};
    int restarts = 0;
    bool uses_ports = false;                      ///< gets the folder of serial lines (`--ports`)
    std::string host{};                           ///< "": this machine
    pid_t ready_pid = 0;                          ///< of the process here that said READY
    RestartLimit limit{};                         ///< counts its deaths
    std::optional<std::int64_t> restart_utime{};  ///< it is dead until then
    bool left_out = false;                        ///< it died too often
  };

  void checkLogGrowth();
  void add(const std::string& name, const std::string& host, bool uses_ports);
  [[nodiscard]] std::unique_ptr<ServiceProcess> startService(const Entry& entry,
                                                             const std::filesystem::path& file);
  [[nodiscard]] std::unique_ptr<ServiceProcess> startThere(const Entry& entry,
                                                           const std::filesystem::path& file) const;
  [[nodiscard]] bool restartEach(std::int64_t now,
                                 const std::function<std::filesystem::path()>& resume);
  [[nodiscard]] bool isDue(Entry& entry, std::int64_t now);
  void noteDeath(Entry& entry, std::int64_t now);
  [[nodiscard]] std::unique_ptr<LocalProcess> startHere(const std::vector<std::string>& arguments,
                                                        const std::filesystem::path& output);
  [[nodiscard]] std::filesystem::path logFile() const;
  [[nodiscard]] std::vector<std::string> argumentsOf(const Entry& entry) const;
  [[nodiscard]] bool joinsBuses() const;
  [[nodiscard]] std::filesystem::path logOf(const Entry& entry) const;

  const PreparedRun& run_;
  const LiveOptions& options_;
  std::int64_t clock_offset_us_;
  OrphanGuard guard_;  ///< of the processes below
  Entry recorder_{.name = "recorder"};
  std::vector<Entry> services_;
  std::vector<std::string> held_;  ///< sentences to report once a recorder runs
  HeartbeatMonitor heartbeats_;
  std::uintmax_t log_size_ = 0;      ///< at the last check
  int heartbeats_since_growth_ = 0;  ///< heartbeats since the log last grew
};

}  // namespace lab::runner
