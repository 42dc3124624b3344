/// The processes of a live run.
#pragma once

#include <cstdint>
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

/// Starts, watches, restarts and ends lcm-logger and the services of one run, those on other hosts
/// too.
class Supervisor {
 public:
  Supervisor(const PreparedRun& run, const LiveOptions& options);

  void startLogger();

  /// Those that join the buses of all hosts; none where all services are here.
  void startGateways();
  void startServices();

  /// Whether lcm-logger, the newest one, has written something: it says nothing itself.
  [[nodiscard]] bool loggerWrites() const;

  /// Takes note of a heartbeat, and whether it says READY. Two hosts may have the same pid.
  void noteHeartbeat(const std::string& sender, pid_t pid, bool ready);

  /// Names of the services that were started and have not said READY.
  [[nodiscard]] std::string missing() const;

  /// The service that ended by itself, and what it said last; empty: none.
  [[nodiscard]] std::string endedWith() const;

  /// Whether a process has already ended by itself.
  [[nodiscard]] bool anyEnded() const;

  /// What the processes printed, to look into.
  [[nodiscard]] std::filesystem::path logFolder() const;

  /// Restarts what has died. @param report called with a sentence for each, once there is a logger
  /// that hears it.
  /// @param resume the experiment file for a restarted sim_svc, made when it is needed.
  /// @return false when something died so often that it is given up.
  [[nodiscard]] bool restartEnded(const std::function<void(const std::string&)>& report,
                                  const std::function<std::filesystem::path()>& resume);

  /// Looks, at least every HeartbeatMonitor::kLongestStep_us, whether the services of this machine
  /// are heard of and the log grows. @param silent called with a sentence when not, once
  /// @param again called with a sentence when they are again
  void checkHeartbeats(std::int64_t now, const std::function<void(const std::string&)>& silent,
                       const std::function<void(const std::string&)>& again);

  /// Reports what no logger was there to hear.
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
  std::vector<std::string> held_;  ///< what is to be reported
  HeartbeatMonitor heartbeats_;
  std::uintmax_t log_size_ = 0;      ///< when it was last looked at
  int heartbeats_since_growth_ = 0;  ///< which the log should have grown by
};

}  // namespace lab::runner
