/// The listening socket of a server, the admission of connections and the threads that serve them.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/process/event_descriptor.hpp"

namespace lab {

struct ListenOptions {
  std::string owner;         ///< begins every error message, e.g. "dashboard"
  std::string address;       ///< numeric
  int port = 0;              ///< the first port to try, 0: any free one
  int ports_tried = 1;       ///< if the port is taken, the next ones are tried, this many in total
  int max_connections = 64;  ///< served at once
  int max_remote = 64;       ///< of those, from other hosts
  int send_buffer = 0;       ///< SO_SNDBUF [byte], 0: the system's default
};

/// Accepts connections and runs `serve` for each on a thread of its own. When all places are taken,
/// the oldest connection that has not yet been identified is shut down to make room, so that silent
/// clients never keep others out; without one, the connection whose client has taken none of its
/// response for the longest time, of at least a second. Connections from other hosts are limited
/// separately, so that this host always gets a place.
class ConnectionAcceptor {
 public:
  /// Called with a non-blocking socket, which is closed afterwards, and with whether there is a
  /// place for this client. If not, it should only send a refusal.
  using Serve = std::function<void(int socket, bool has_place)>;

  /// Binds and listens.
  /// @throws std::runtime_error if no port is free or the address does not belong to this host
  explicit ConnectionAcceptor(ListenOptions options);
  ~ConnectionAcceptor();
  ConnectionAcceptor(const ConnectionAcceptor&) = delete;
  ConnectionAcceptor& operator=(const ConnectionAcceptor&) = delete;

  [[nodiscard]] int port() const { return port_; }

  /// Begins to accept. Call it once.
  void open(Serve serve);

  /// Marks a connection as identified: its request is known and permitted, so it keeps its place.
  /// Call it from `serve`.
  void identify(int socket);

  /// Shuts down all connections and waits until their threads have ended.
  void close();

 private:
  struct Connection {
    std::chrono::steady_clock::time_point since;
    bool identified = false;
    bool ending = false;  ///< shut down, so that it is not chosen again
    bool remote = false;
    std::thread thread;
  };

  void acceptAll();
  void start(int socket, bool remote);
  [[nodiscard]] bool hasPlaceFor(bool remote);
  [[nodiscard]] std::map<int, Connection>::iterator leastNeeded(bool only_remote);
  void leave(int socket);
  void joinFinished();

  ListenOptions options_;
  int listener_ = -1;
  EventDescriptor wakeup_;  ///< wakes the accepting thread when the acceptor closes
  int port_ = 0;
  Serve serve_;
  std::atomic<bool> closing_ = false;
  std::mutex mutex_;
  std::condition_variable left_;           ///< a connection has ended, or closing_ is set
  std::map<int, Connection> connections_;  ///< by socket
  std::vector<std::thread> finished_;      ///< to be joined
  std::thread accepting_;
};

}  // namespace lab
