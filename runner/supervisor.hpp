/// The processes of a live run.
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "runner/child_process.hpp"
#include "runner/run_live.hpp"

namespace lab::runner {

/// Starts, watches, restarts and ends lcm-logger and the services of one run.
class Supervisor {
 public:
  Supervisor(const PreparedRun& run, const LiveOptions& options);

  void startLogger();
  void startServices();

  /// Whether lcm-logger has written something: it says nothing itself.
  [[nodiscard]] bool loggerWrites() const;

  /// Takes note that the process says it is READY.
  void noteReady(pid_t pid) { ready_.insert(pid); }

  /// Names of the services that have not said READY.
  [[nodiscard]] std::string missing() const;

  /// The service that ended by itself, and what it said last; empty: none.
  [[nodiscard]] std::string endedWith() const;

  /// Whether a process has already ended by itself.
  [[nodiscard]] bool anyEnded() const;

  /// What the processes printed, to look into.
  [[nodiscard]] std::filesystem::path logFolder() const;

  /// Restarts what has died. @param report called with a sentence for each.
  /// @param resume the experiment file for a restarted sim_svc, made when it is needed.
  /// @return false when something died so often that it is given up.
  [[nodiscard]] bool revive(const std::function<void(const std::string&)>& report,
                            const std::function<std::filesystem::path()>& resume);

  void endServices();
  void endLogger();

 private:
  struct Entry {
    std::string name;
    std::unique_ptr<ChildProcess> process;
    int restarts = 0;
    bool uses_ports = false;
  };

  [[nodiscard]] std::unique_ptr<ChildProcess> startService(const std::string& name, bool uses_ports,
                                                           const std::filesystem::path& file) const;

  const PreparedRun& run_;
  const LiveOptions& options_;
  Entry logger_{"lcm-logger", nullptr};
  std::vector<Entry> services_;
  std::set<pid_t> ready_;
};

}  // namespace lab::runner
