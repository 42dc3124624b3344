/// The processes of a run in real time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "runner/live/child_process.hpp"
#include "runner/live/heartbeat_monitor.hpp"
#include "runner/live/run_live.hpp"

namespace lab::runner {

/// Starts, watches, restarts and ends lcm-logger and the services of one run, on this machine and
/// on other hosts.
class Supervisor {
 public:
  Supervisor(const PreparedRun& run, const LiveOptions& options);

  void startLogger();

  /// Starts the gateways that connect the buses of all hosts; none if all services are here.
  void startGateways();
  void startServices();

  /// Whether the newest lcm-logger has written something. It does not report READY itself.
  [[nodiscard]] bool loggerWrites() const;

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

  /// Restarts processes that died.
  /// @param report called with a sentence for each, once a logger runs that records it
  /// @param resume makes the experiment file for a restarted sim_svc
  /// @return false when a process died too often and is given up
  [[nodiscard]] bool restartEnded(const std::function<void(const std::string&)>& report,
                                  const std::function<std::filesystem::path()>& resume);

  /// Checks that the services of this machine send heartbeats and that the log grows. Call at least
  /// every HeartbeatMonitor::kLongestStep_us.
  /// @param silent called once with a sentence when one does not
  /// @param again called with a sentence when it does again
  void checkHeartbeats(std::int64_t now, const std::function<void(const std::string&)>& silent,
                       const std::function<void(const std::string&)>& again);

  /// Reports what happened while no logger ran.
  void reportHeld(const std::function<void(const std::string&)>& report);

  /// @param report called with a sentence for each that had to be killed
  void endServices(const std::function<void(const std::string&)>& report);
  void endLogger(const std::function<void(const std::string&)>& report);

 private:
  struct Entry {
    std::string name;
    std::unique_ptr<ServiceProcess> process{};
    int restarts = 0;
    bool uses_ports = false;
    std::string host{};  ///< "": this machine
  };

  void checkLogGrowth();
  void add(const std::string& name, const std::string& host, bool uses_ports);
  [[nodiscard]] std::unique_ptr<ServiceProcess> startService(
      const Entry& entry, const std::filesystem::path& file) const;
  [[nodiscard]] std::unique_ptr<ServiceProcess> startThere(const Entry& entry,
                                                           const std::filesystem::path& file) const;
  [[nodiscard]] bool restartEach(const std::function<std::filesystem::path()>& resume);
  [[nodiscard]] std::filesystem::path logFile() const;
  [[nodiscard]] std::vector<std::string> argumentsOf(const Entry& entry) const;
  [[nodiscard]] bool joinsBuses() const;
  [[nodiscard]] std::filesystem::path logOf(const Entry& entry) const;

  const PreparedRun& run_;
  const LiveOptions& options_;
  Entry logger_{"lcm-logger"};
  std::vector<Entry> services_;
  std::set<std::pair<std::string, pid_t>> ready_;
  std::vector<std::string> held_;  ///< sentences to report once a logger runs
  HeartbeatMonitor heartbeats_;
  std::uintmax_t log_size_ = 0;      ///< at the last check
  int heartbeats_since_growth_ = 0;  ///< heartbeats since the log last grew
};

}  // namespace lab::runner
