/// Checks before a run uses several hosts: same version, message types and time. Pure functions.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "common/experiment/experiment.hpp"
#include "common/math/clock_offset.hpp"

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

/// @param clock nan: not one of the times that the host sent was possible
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
