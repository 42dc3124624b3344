/// The processes of a live run.
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "runner/child_process.hpp"
#include "runner/run_live.hpp"

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

  /// Takes note that a process of this machine says it is READY. Two hosts may have the same pid.
  void noteReady(const std::string& sender, pid_t pid) { ready_.emplace(sender, pid); }

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
  [[nodiscard]] bool revive(const std::function<void(const std::string&)>& report,
                            const std::function<std::filesystem::path()>& resume);

  /// Reports what no logger was there to hear.
  void sayHeld(const std::function<void(const std::string&)>& report);

  void endServices();
  void endLogger();

 private:
  struct Entry {
    std::string name;
    std::unique_ptr<ServiceProcess> process{};
    int restarts = 0;
    bool uses_ports = false;
    std::string host{};  ///< "": this machine
  };

  void add(const std::string& name, const std::string& host, bool uses_ports);
  [[nodiscard]] std::unique_ptr<ServiceProcess> startService(
      const Entry& entry, const std::filesystem::path& file) const;
  [[nodiscard]] std::unique_ptr<ServiceProcess> startThere(const Entry& entry,
                                                           const std::filesystem::path& file) const;
  [[nodiscard]] bool reviveEach(const std::function<std::filesystem::path()>& resume);
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
};

}  // namespace lab::runner
