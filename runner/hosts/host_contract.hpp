/// Checks before a run uses several hosts: same version, message types and time. Pure functions.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "common/experiment/experiment.hpp"

namespace lab::runner {

/// First message of a host agent.
struct HostHello {
  std::string version;
  int contract_version = 0;
  std::string fingerprints;    ///< one hash over the fingerprints of all message types
  std::string revision;        ///< of the source; empty if the build does not record it
  std::string host;            ///< host name, as gethostname() returns it
  std::string ssh_connection;  ///< $SSH_CONNECTION: "client port server port"
  std::string multicast;       ///< interface of the multicast route; empty if unknown
  std::int64_t utime = 0;      ///< [us since 1970]
};

/// The hello of this program on this host.
[[nodiscard]] HostHello ownHello();

[[nodiscard]] nlohmann::json toJson(const HostHello& hello);

/// @return nothing if `json` is not a hello
[[nodiscard]] std::optional<HostHello> helloFrom(const nlohmann::json& json);

/// @return why the two versions cannot work together and how to fix it; empty if they can
[[nodiscard]] std::string refusal(const HostSpec& host, const HostHello& here,
                                  const HostHello& there);

/// Offset of another host's clock: positive if it is ahead of the local clock.
struct ClockOffset {
  double offset = 0;  ///< [s]
  double error = 0;   ///< [s] bound of the measurement error: half the round trip
};

/// Estimates a clock offset from request and answer times as NTP does (RFC 5905, section 8). The
/// exchange with the shortest round trip is used.
class ClockMeasurement {
 public:
  /// @param asked, answered local time of request and answer [us]
  /// @param there time of the other clock in between [us]
  void add(std::int64_t asked, std::int64_t there, std::int64_t answered);
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] const ClockOffset& best() const { return best_; }

 private:
  int count_ = 0;
  ClockOffset best_;
};

/// @return why the clock offset is too large and how to fix it; empty if it is within limits
/// @param allowed largest offset [s]
[[nodiscard]] std::string clockRefusal(const HostSpec& host, const ClockOffset& clock,
                                       double allowed);

/// Addresses of both ends of an ssh connection, as the remote host sees them.
struct SshEnds {
  std::string here;
  std::string there;
};
[[nodiscard]] std::optional<SshEnds> endsOf(const std::string& ssh_connection);

/// Explains why ssh failed and how to fix it. @param said standard error of ssh
/// @param ending how it ended, as "exit code 255"
[[nodiscard]] std::string sshTrouble(const HostSpec& host, const std::string& said,
                                     const std::string& ending);

/// The command that ssh runs on the host.
[[nodiscard]] std::string agentCommand(const HostSpec& host);

}  // namespace lab::runner
