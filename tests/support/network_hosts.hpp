/// Access to the hosts of tests/two_hosts.sh: their LCM buses and gateways.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <lab/link_status_t.hpp>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/bus/message_header.hpp"

namespace lab::gateway {

inline const std::string kUrl = lcmUrl(7811);
inline constexpr double kLong = 60;  ///< [s] time limit for expected events

/// Whether this test was started by two_hosts.sh.
inline bool hostsAreThere() { return std::getenv("TWO_HOSTS") != nullptr; }

inline std::string required(const std::string& variable) {
  const char* value = std::getenv(variable.c_str());
  if (value == nullptr) throw std::runtime_error("$" + variable + ": start by tests/two_hosts.sh");
  return value;
}

/// Steady clock [s].
inline double steadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

inline std::int64_t wallUtime() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// Moves the thread into the network namespace of a process. Sockets opened meanwhile stay there.
class NetworkNamespaceScope {
 public:
  explicit NetworkNamespaceScope(const std::string& process)
      : home_(open("/proc/self/ns/net", O_RDONLY | O_CLOEXEC)) {
    const int target = open(("/proc/" + process + "/ns/net").c_str(), O_RDONLY | O_CLOEXEC);
    const bool in = target >= 0 && setns(target, CLONE_NEWNET) == 0;
    close(target);
    if (!in) throw std::runtime_error("cannot enter the network namespace of process " + process);
  }
  ~NetworkNamespaceScope() {
    static_cast<void>(setns(home_, CLONE_NEWNET));
    close(home_);
  }
  NetworkNamespaceScope(const NetworkNamespaceScope&) = delete;
  NetworkNamespaceScope& operator=(const NetworkNamespaceScope&) = delete;

 private:
  int home_;
};

/// A program on one of the hosts; the destructor ends it.
class Program {
 public:
  Program(const std::string& process, std::vector<std::string> command) : id_(fork()) {
    if (id_ != 0) return;
    command.insert(command.begin(), {"nsenter", "-t", process, "-n"});
    std::vector<char*> arguments;
    for (std::string& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  ~Program() { end(); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void end() {
    if (id_ <= 0) return;
    signal(SIGCONT);
    signal(SIGTERM);
    waitpid(id_, nullptr, 0);
    id_ = 0;
  }
  void signal(int number) const { kill(id_, number); }
  [[nodiscard]] pid_t id() const { return id_; }

  /// Resident memory [MB].
  [[nodiscard]] double megabytes() const {
    std::ifstream file("/proc/" + std::to_string(id_) + "/statm");
    double all = 0;
    double resident = 0;
    file >> all >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6;
  }

 private:
  pid_t id_;
};

/// A message received on a bus.
struct Message {
  std::string channel;
  std::vector<std::uint8_t> data;
  double came = 0;  ///< [s] time of arrival, as steadySeconds()
  std::string sender;
  std::int64_t seq = 0;
};

/// One host with its bus.
class Host {
 public:
  explicit Host(const std::string& letter)
      : name("host" + letter),
        process(required("HOST_" + letter)),
        address(required("ADDRESS_" + letter)) {
    const NetworkNamespaceScope there(process);
    bus = std::make_unique<LcmBus>(kUrl);
    bus->subscribeAll([this](const Packet& packet) { hear(packet); });
  }

  /// Messages of a sender on a channel, without those of the gateways themselves.
  [[nodiscard]] std::vector<Message> of(std::string_view sender, std::string_view channel) const {
    std::vector<Message> found;
    for (const Message& message : heard) {
      if (message.sender == sender && message.channel == channel) found.push_back(message);
    }
    return found;
  }

  /// The report of its own gateway about a peer; state 0 if there is none.
  [[nodiscard]] link_peer_t peer(const std::string& host) const {
    for (const link_peer_t& row : status.peers) {
      if (row.host == host) return row;
    }
    return {};
  }

  std::string name;
  std::string process;
  std::string address;
  std::unique_ptr<LcmBus> bus;
  std::vector<Message> heard;
  link_status_t status{};
  std::vector<std::pair<std::string, int>> states;  ///< state changes of peers

 private:
  void hear(const Packet& packet) {
    if (packet.channel == channels::kLinkStatus) {
      link_status_t received{};
      if (decode(packet.data, received) && received.host == name) {
        for (const link_peer_t& row : received.peers) {
          if (peer(row.host).state != row.state) states.emplace_back(row.host, row.state);
        }
        status = received;
      }
      return;
    }
    const auto header = peekHeader(packet.data);
    if (header && header->sender == "dds_gateway") return;
    heard.push_back({std::string(packet.channel),
                     {packet.data.begin(), packet.data.end()},
                     steadySeconds(),
                     header ? std::string(header->sender) : "",
                     header ? header->seq : 0});
  }
};

/// All hosts of a test.
class Hosts {
 public:
  explicit Hosts(const std::vector<std::string>& letters) {
    for (const std::string& letter : letters) all_.push_back(std::make_unique<Host>(letter));
  }

  Host& operator[](std::size_t index) { return *all_[index]; }

  /// Starts the gateway of a host, with all other hosts as peers.
  std::unique_ptr<Program> gateway(std::size_t index, std::int64_t clock_shift_us = 0,
                                   double most_offset = 0.005, const std::string& key = "run") {
    Host& host = *all_[index];
    std::vector<std::string> command{LAB_LINK_END,
                                     kUrl,
                                     host.name,
                                     host.address,
                                     key,
                                     std::to_string(clock_shift_us),
                                     std::to_string(most_offset)};
    for (const auto& other : all_) {
      if (other.get() != &host) command.push_back(other->address);
    }
    return std::make_unique<Program>(host.process, std::move(command));
  }

  /// Receives on all buses for `seconds`.
  void run(double seconds) {
    until([] { return false; }, seconds);
  }

  /// Receives on all buses until `condition` is true, at most for `seconds`.
  /// @return the last value of `condition`
  bool until(const std::function<bool()>& condition, double seconds) {
    const double end = steadySeconds() + seconds;
    std::vector<pollfd> waits;
    for (const auto& host : all_) waits.push_back({host->bus->fileDescriptor(), POLLIN, 0});
    while (!condition()) {
      const double left = end - steadySeconds();
      if (left <= 0) return false;
      poll(waits.data(), waits.size(), static_cast<int>(std::min(left * 1e3 + 1, 20.0)));
      for (const auto& host : all_) host->bus->drain();
    }
    return true;
  }

  /// Waits until every host reports at least `peers` peers in this state.
  bool untilState(std::int8_t state, std::size_t peers, double seconds) {
    return until(
        [&] {
          for (const auto& host : all_) {
            std::size_t count = 0;
            for (const link_peer_t& row : host->status.peers) count += row.state == state ? 1 : 0;
            if (count < peers) return false;
          }
          return true;
        },
        seconds);
  }

  /// Receives on all buses until the gateway of a host has reported, at most for `seconds`. By then
  /// it receives what is published on its bus.
  bool untilReports(std::size_t host, double seconds) {
    return until([&] { return all_[host]->status.host == all_[host]->name; }, seconds);
  }

  /// Receives on all buses until a host has the message `seq` of a sender, at most for `seconds`.
  bool untilHeard(std::size_t host, std::string_view sender, std::string_view channel,
                  std::int64_t seq, double seconds) {
    return until(
        [&] {
          const std::vector<Message> heard = all_[host]->of(sender, channel);
          return !heard.empty() && heard.back().seq >= seq;
        },
        seconds);
  }

  /// Calls `publish` at `rate` [1/s] for `seconds` and receives meanwhile.
  /// @return number of calls
  int publishing(double rate, double seconds, const std::function<void(int)>& publish) {
    const double start = steadySeconds();
    const int count = static_cast<int>(rate * seconds);
    for (int i = 0; i < count; ++i) {
      const double at = start + i / rate;
      if (const double left = at - steadySeconds(); left > 0) run(left);
      publish(i);
    }
    return count;
  }

 private:
  std::vector<std::unique_ptr<Host>> all_;
};

/// Sends a command to the router of two_hosts.sh, as "cut B".
inline void wire(const std::string& what) {
  const std::string command = required("TWO_HOSTS") + " " + what;
  if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
}

template <class Type>
std::vector<std::uint8_t> message(const std::string& sender, std::int64_t seq, Type type = {}) {
  type.utime = wallUtime();
  type.sender = sender;
  type.instance = 1000;
  type.seq = seq;
  return encode(type);
}

}  // namespace lab::gateway
