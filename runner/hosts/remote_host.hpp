/// Another computer, as the runner sees it: an ssh to a host agent (host_agent.hpp).
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "runner/hosts/host_contract.hpp"
#include "runner/hosts/host_files.hpp"
#include "runner/hosts/json_lines.hpp"
#include "runner/live/child_process.hpp"

namespace lab::runner {

/// Nothing here waits but leave() and hanging up: attend() does what there is to do, and is called
/// many times a second.
class RemoteHost {
 public:
  enum class State {
    kCalling,    ///< ssh is on its way, versions and clocks are compared
    kMet,        ///< the same lab, and clocks that agree
    kBeginning,  ///< its files are on their way; the agent before it may still have to end
    kBegun,      ///< it has its files
    kGone,       ///< ssh has ended: trouble() says why
    kRefused,    ///< it must not take part: trouble() says why
  };

  /// @param max_clock_offset [s]
  RemoteHost(HostSpec spec, double max_clock_offset);
  ~RemoteHost();
  RemoteHost(const RemoteHost&) = delete;
  RemoteHost& operator=(const RemoteHost&) = delete;

  /// Starts ssh, anew when it is gone. @throws UserError when there is no ssh.
  void call();

  void attend();

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] const HostSpec& spec() const { return spec_; }
  [[nodiscard]] const std::string& trouble() const { return trouble_; }
  [[nodiscard]] const HostHello& hello() const { return hello_; }
  [[nodiscard]] const ClockOffset& clock() const { return clock_.best(); }
  [[nodiscard]] const std::string& warning() const { return warning_; }

  /// Counts its meetings, from 1: what was started in an earlier one is gone.
  [[nodiscard]] int meeting() const { return meeting_; }

  /// [s] since the last sign of life over ssh.
  [[nodiscard]] double silentFor() const;

  struct RunSetup {
    std::string name;  ///< of the run
    int port = 0;      ///< of the bus, 0: a free one
    int ttl = 0;
    double patience = 60;        ///< [s] it stays without us
    std::filesystem::path logs;  ///< what its services print goes to NAME.txt there
    std::vector<HostFile> files;
  };
  void begin(const RunSetup& beginning);

  /// One file more, in order with all that is sent. @throws UserError when it cannot be read.
  void send(const HostFile& file);

  /// Gives up a connection on which nothing has been heard for long.
  void lose(const std::string& why);

  struct Order {
    std::string service;
    std::string experiment;  ///< file there
    bool uses_ports = false;
    std::vector<std::string> arguments;
  };
  /// Starts a service there.
  [[nodiscard]] std::unique_ptr<ServiceProcess> start(const Order& order);

  /// Ends everything there, and the connection.
  void leave();

 private:
  friend class RemoteService;
  struct Told {
    bool ready = false;
    bool ended = false;
    std::string how;
  };

  void take(const nlohmann::json& said);
  void say(nlohmann::json message);
  void feed();
  void meet(const HostHello& hello);
  void measure(const nlohmann::json& pong);
  void order(const char* what, const std::string& service);
  void write(const std::string& service, const std::string& text) const;
  void hangUp();
  [[nodiscard]] std::string complaint() const;

  HostSpec spec_;
  double max_clock_offset_;
  State state_ = State::kGone;
  std::string trouble_;
  std::string warning_;
  HostHello hello_;
  ClockMeasurement clock_;
  int meeting_ = 0;
  std::filesystem::path logs_;
  int errors_ = -1;  ///< what ssh says on its standard error, in memory
  int input_ = -1;   ///< to ssh
  int output_ = -1;  ///< from ssh
  std::unique_ptr<ChildProcess> ssh_;
  std::optional<JsonLines> lines_;
  /// What waits for room, in order. Each sends a part of itself and says whether that was the last.
  std::deque<std::function<bool()>> outbox_;
  std::map<std::string, Told> told_;  ///< of services, in this meeting
  std::chrono::steady_clock::time_point heard_;
  std::chrono::steady_clock::time_point spoke_;
};

}  // namespace lab::runner
