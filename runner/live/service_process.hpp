/// The process of a service, on this machine or on another.
#pragma once

#include <string>

namespace lab::runner {

/// ending() of a service whose host was lost.
inline constexpr const char* kWithItsHost = "with its host";

class ServiceProcess {
 public:
  ServiceProcess() = default;
  ServiceProcess(const ServiceProcess&) = delete;
  ServiceProcess& operator=(const ServiceProcess&) = delete;
  virtual ~ServiceProcess() = default;

  /// Whether it still runs, as far as is known. Updates ending().
  [[nodiscard]] virtual bool running() = 0;

  /// Whether its host reported it READY. A local process reports this on the bus.
  [[nodiscard]] virtual bool ready() const { return false; }

  /// Its pid on this machine; 0: it runs on another.
  [[nodiscard]] virtual int localPid() const { return 0; }

  /// How it ended: "killed by signal 9", "exit code 1".
  [[nodiscard]] virtual const std::string& ending() const = 0;

  /// Sends SIGTERM without waiting.
  virtual void terminate() = 0;

  /// Waits this long for its end, then sends SIGKILL. @return whether that was needed
  virtual bool waitOrKill(int timeout_ms) = 0;
};

}  // namespace lab::runner
