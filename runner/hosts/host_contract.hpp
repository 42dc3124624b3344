/// What two computers must agree on before a run spans them. Numbers and texts in, sentences out.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "common/experiment/experiment.hpp"

namespace lab::runner {

/// What a host agent says first.
struct HostHello {
  std::string version;
  int contract_version = 0;
  std::string fingerprints;    ///< of the message types, one number for all
  std::string revision;        ///< of the source, empty: the build does not know
  std::string host;            ///< its own name
  std::string ssh_connection;  ///< $SSH_CONNECTION: "client port server port"
  std::string multicast;       ///< interface by which multicast leaves, empty: not known
  std::int64_t utime = 0;      ///< [us since 1970]
};

/// This program's own.
[[nodiscard]] HostHello ownHello();

[[nodiscard]] nlohmann::json toJson(const HostHello& hello);

/// @return nothing when it is no hello.
[[nodiscard]] std::optional<HostHello> helloFrom(const nlohmann::json& json);

/// Why the two must not work together, with the way out; empty: they may.
[[nodiscard]] std::string refusal(const HostSpec& host, const HostHello& here,
                                  const HostHello& there);

/// How far another clock is ahead of ours.
struct ClockOffset {
  double offset = 0;  ///< [s]
  double error = 0;   ///< [s] known to within this
};

/// The fastest of several questions and answers says most (NTP's formula).
class ClockMeasurement {
 public:
  /// @param asked, answered our clock [us] @param there its clock between the two [us]
  void add(std::int64_t asked, std::int64_t there, std::int64_t answered);
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] const ClockOffset& best() const { return best_; }

 private:
  int count_ = 0;
  ClockOffset best_;
};

/// Why the clocks are too far apart, with the way out; empty: they are not. @param allowed [s]
[[nodiscard]] std::string clockRefusal(const HostSpec& host, const ClockOffset& clock,
                                       double allowed);

/// Both ends of an ssh connection, as the other computer saw it.
struct SshEnds {
  std::string here;
  std::string there;
};
[[nodiscard]] std::optional<SshEnds> endsOf(const std::string& ssh_connection);

/// What ssh's failure means, with the way out. @param said on its standard error
/// @param ending "exit code 255"
[[nodiscard]] std::string sshTrouble(const HostSpec& host, const std::string& said,
                                     const std::string& ending);

/// The command that ssh is to run there.
[[nodiscard]] std::string agentCommand(const HostSpec& host);

}  // namespace lab::runner
