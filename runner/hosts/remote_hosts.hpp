/// The remote hosts of one run.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <lab/link_status_t.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runner/hosts/remote_host.hpp"
#include "runner/runs/run_directory.hpp"

namespace lab::runner {

/// Connects to the hosts, joins their LCM buses with the local one, and distinguishes a silent host
/// from a service that ended. attend() and watch() do the work and do not block.
class RemoteHosts {
 public:
  /// Connects to every host and checks that version and clock agree. Blocks for at most 20 s.
  /// @throws UserError with a line for each host that fails, before anything is started
  RemoteHosts(const Experiment& experiment, const std::vector<std::string>& hosts);

  /// Sends the files of the run to every host and waits until all have them. @throws UserError
  void begin(const PreparedRun& run, const std::string& lab, const std::filesystem::path& logs,
             int port);

  void attend();

  [[nodiscard]] RemoteHost& at(const std::string& host) { return *hosts_.at(host).remote; }
  [[nodiscard]] std::vector<std::string> names() const;

  /// Arguments for the dds_gateway of a host. @param host name, or "" for this machine
  [[nodiscard]] std::vector<std::string> linkArguments(const std::string& host) const;

  /// Handles the LINK_STATUS of a gateway.
  void take(const link_status_t& status);

  /// @return which buses are not joined with each other, and why; empty if all are
  [[nodiscard]] std::string notJoined() const;

  /// @return why the start has failed; empty if it has not
  [[nodiscard]] std::string trouble() const;

  struct Watcher {
    std::function<void(const std::string&)> fault;
    std::function<void(const std::string&)> mark;
  };
  /// Reports hosts that become silent and hosts that are back, and reconnects to lost hosts.
  /// @return why the run must end; empty if it can go on
  [[nodiscard]] std::string watch(const Watcher& watcher);

  /// One line per host: ssh name, host name and clock offset.
  [[nodiscard]] std::string describe() const;

  /// Ends everything on all hosts.
  void leave();

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Host {
    std::unique_ptr<RemoteHost> remote;
    Time heard;                  ///< last time at which the host was well
    bool silent = false;         ///< a fault was reported
    std::optional<Time> back;    ///< since when a silent host responds again
    std::optional<Time> called;  ///< last attempt to reconnect
  };

  void waitFor(RemoteHost::State state, const char* what);
  [[nodiscard]] bool isWell(const Host& host) const;
  [[nodiscard]] std::string describeSilence(const Host& host) const;
  [[nodiscard]] std::string noDdsTraffic() const;
  void reconnect(Host& host);
  void findAddresses();
  [[nodiscard]] RemoteHost::RunSetup runSetupFor(const RemoteHost& host) const;

  Experiment experiment_;
  bool gateways_;
  std::string own_name_;
  std::string own_address_;
  std::string key_;
  std::filesystem::path directory_;
  std::string lab_;
  std::filesystem::path logs_;
  int port_ = 0;
  std::map<std::string, Host> hosts_;
  std::map<std::string, std::map<std::string, link_peer_t>> peers_;  ///< by the reporting host
  Time last_link_status_;
};

}  // namespace lab::runner
