/// Connection of the runner to one remote host: ssh to a host agent (host_agent.hpp).
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

#include "common/process/child_process.hpp"
#include "common/process/output_tail.hpp"
#include "runner/hosts/host_contract.hpp"
#include "runner/hosts/host_files.hpp"
#include "runner/hosts/json_lines.hpp"
#include "runner/live/service_process.hpp"

namespace lab::runner {

/// Only disconnect() and closing a connection block. attend() does all other work and must be
/// called many times per second.
class RemoteHost {
 public:
  enum class State {
    kCalling,    ///< ssh connects; versions and clocks are compared
    kMet,        ///< the host has the same version, and the clocks agree
    kBeginning,  ///< files are being sent; a previous agent may still have to end
    kBegun,      ///< the host has received the files
    kGone,       ///< ssh has ended; trouble() gives the reason
    kRefused,    ///< the host cannot be used; trouble() gives the reason
  };

  /// @param max_clock_offset [s]
  RemoteHost(HostSpec spec, double max_clock_offset);
  ~RemoteHost();
  RemoteHost(const RemoteHost&) = delete;
  RemoteHost& operator=(const RemoteHost&) = delete;

  /// Starts ssh, or restarts it after it has ended. @throws UserError if ssh is not installed
  void connect();

  /// Receives, sends what is queued, and checks whether ssh still runs.
  void attend();

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] const HostSpec& spec() const { return spec_; }
  [[nodiscard]] const std::string& trouble() const { return trouble_; }
  [[nodiscard]] const HostHello& hello() const { return hello_; }
  [[nodiscard]] ClockOffset clock() const { return round_trips_.estimate(); }
  [[nodiscard]] const std::string& warning() const { return warning_; }

  /// Number of the connection, from 1. Services of an earlier connection have ended.
  [[nodiscard]] int connection() const { return connection_; }

  /// Time since the last message over ssh [s].
  [[nodiscard]] double silentFor() const;

  struct RunSetup {
    std::string name;  ///< name of the run
    int port = 0;      ///< UDP port of the LCM bus; 0: any free port
    int ttl = 0;
    double patience = 60;        ///< [s] the agent ends if it receives nothing for this long
    std::filesystem::path logs;  ///< folder for the output of its services, as NAME.txt
    std::vector<HostFile> files;
  };
  /// Sends the setup and the files of a run.
  void begin(const RunSetup& setup);

  /// Queues one more file. @throws UserError if it cannot be read
  void send(const HostFile& file);

  /// Closes a connection that has been silent for too long.
  void drop(const std::string& why);

  struct StartRequest {
    std::string service;
    std::string experiment;  ///< file on the host
    bool uses_ports = false;
    std::vector<std::string> arguments;
  };
  /// Starts a service on the host.
  [[nodiscard]] std::unique_ptr<ServiceProcess> start(const StartRequest& request);

  /// Ends all services on the host, then the connection. Blocks for at most about 7 s.
  void disconnect();

 private:
  friend class RemoteService;
  struct ServiceReport {
    bool ready = false;
    bool ended = false;
    std::string how;
  };

  void handle(const nlohmann::json& message);
  void queue(nlohmann::json message);
  void sendQueued();
  void compare(const HostHello& hello);
  void measure(const nlohmann::json& pong);
  void request(const char* what, const std::string& service);
  void write(const std::string& service, const std::string& text) const;
  void closeConnection();

  HostSpec spec_;
  double max_clock_offset_;
  State state_ = State::kGone;
  std::string trouble_;
  std::string warning_;
  HostHello hello_;
  ClockOffsetEstimator round_trips_;
  int pongs_ = 0;
  int connection_ = 0;
  std::filesystem::path logs_;
  OutputTail errors_{65536};  ///< last part [byte] of what ssh wrote to standard error
  FileDescriptor input_;      ///< standard input of ssh
  FileDescriptor output_;     ///< standard output of ssh
  std::optional<ChildProcess> ssh_;
  std::optional<JsonLines> lines_;
  /// Messages to send, in order. Each function sends one part and returns whether it was the last.
  std::deque<std::function<bool()>> outbox_;
  std::map<std::string, ServiceReport> reports_;  ///< by service, of this connection
  std::chrono::steady_clock::time_point last_receive_;
  std::chrono::steady_clock::time_point last_alive_;
};

}  // namespace lab::runner
