/// A service at work, on this machine or on another.
#pragma once

#include <string>

namespace lab::runner {

/// The ending of a service that went away with the computer it ran on.
inline constexpr const char* kWithItsHost = "with its host";

class ServiceProcess {
 public:
  ServiceProcess() = default;
  ServiceProcess(const ServiceProcess&) = delete;
  ServiceProcess& operator=(const ServiceProcess&) = delete;
  virtual ~ServiceProcess() = default;

  /// Whether it still runs, as far as is known; takes note of its end.
  [[nodiscard]] virtual bool running() = 0;

  /// Whether it is known to have said that it is READY, by other ways than this machine's bus.
  [[nodiscard]] virtual bool ready() const { return false; }

  /// Its number on this machine, 0: it is on another.
  [[nodiscard]] virtual int localPid() const { return 0; }

  /// "killed by signal 9", "exit code 1" once it has ended.
  [[nodiscard]] virtual const std::string& ending() const = 0;

  /// Asks it to end (SIGTERM), without waiting.
  virtual void terminate() = 0;

  /// Waits this long for its end, then SIGKILL. @return whether that was needed
  virtual bool waitOrKill(int patience_ms) = 0;
};

}  // namespace lab::runner
