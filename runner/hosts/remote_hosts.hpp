/// The other computers of one run.
#pragma once

#include <chrono>
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

/// Meets them, joins their buses with ours, and tells a host that is silent from a service that
/// died. All of it happens in attend() and watch(), which do not wait.
class RemoteHosts {
 public:
  /// Calls every host and waits until each has the same lab and the same time.
  /// @throws UserError with a line for each that has not, before anything is started.
  RemoteHosts(const Experiment& experiment, const std::vector<std::string>& hosts);

  /// Sends each what it needs of the run, and waits until all have it. @throws UserError
  void begin(const PreparedRun& run, const std::string& lab, const std::filesystem::path& logs,
             int port);

  void attend();

  [[nodiscard]] RemoteHost& at(const std::string& host) { return *known_.at(host).remote; }
  [[nodiscard]] std::vector<std::string> names() const;

  /// What a host's gateway is told of the others. @param host "": this machine
  [[nodiscard]] std::vector<std::string> linkArguments(const std::string& host) const;

  void take(const link_status_t& status);

  /// Hosts whose bus is not joined with everybody else's, and why; empty: all are.
  [[nodiscard]] std::string notJoined() const;

  /// Why the start cannot succeed any more; empty: nothing is known.
  [[nodiscard]] std::string trouble() const;

  struct Watcher {
    std::function<void(const std::string&)> fault;
    std::function<void(const std::string&)> mark;
  };
  /// Judges who is silent, who is back, and calls again who is gone.
  /// @return why the run cannot go on; empty: it can.
  [[nodiscard]] std::string watch(const Watcher& watcher);

  /// One line for each: where, how fast, its clock.
  [[nodiscard]] std::string describe() const;

  void leave();

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Known {
    std::unique_ptr<RemoteHost> remote;
    Time heard;                  ///< the last time that all was well
    bool silent = false;         ///< and said so
    std::optional<Time> back;    ///< since when a silent one is heard again
    std::optional<Time> called;  ///< the last attempt to reach it anew
  };

  void waitFor(RemoteHost::State state, const char* what);
  [[nodiscard]] bool isWell(const Known& host) const;
  [[nodiscard]] std::string silence(const Known& host) const;
  [[nodiscard]] std::string notHeard() const;
  void callAgain(Known& host);
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
  std::map<std::string, Known> known_;
  std::map<std::string, std::map<std::string, link_peer_t>> peers_;  ///< by the host that says so
  Time heard_link_;
};

}  // namespace lab::runner
