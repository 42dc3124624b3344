/// The listening socket, who came in, and the threads that serve them.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace httplib {
class ThreadPool;
}

namespace lab::dashboard {

/// Takes connections and hands each to `serve` on a thread of its own, at most kMost at once. Who
/// has not yet said what they want makes room for who comes: silent clients, however many, keep
/// nobody out. Of other machines there are at most kMostRemote: the page on this one always gets
/// in.
class ConnectionAcceptor {
 public:
  static constexpr int kMost = 64;
  static constexpr int kMostRemote = 40;

  /// Called with a socket that does not block, and whether there is room for another client: if
  /// not, it is to be told so. Closed behind it.
  using Serve = std::function<void(int socket, bool room)>;

  /// Takes the first free port from `port` on; 0: any free one.
  /// @throws std::runtime_error when none of 100 is free or the address is not this machine's.
  ConnectionAcceptor(const std::string& address, int port);
  ~ConnectionAcceptor();
  ConnectionAcceptor(const ConnectionAcceptor&) = delete;
  ConnectionAcceptor& operator=(const ConnectionAcceptor&) = delete;

  [[nodiscard]] int port() const { return port_; }

  /// Begins. Once.
  void open(Serve serve);

  /// Says that what this client wants is known: it keeps its place. From `serve`.
  void settled(int socket);

  /// Turns everybody out and waits until they have gone.
  void close();

 private:
  struct Connection {
    std::chrono::steady_clock::time_point since;
    bool settled = false;
    bool far = false;  ///< of another machine
  };

  void acceptAll();
  bool enter(int socket, bool far);
  void leave(int socket);

  int listener_ = -1;
  int wakeup_ = -1;  ///< an eventfd: wakes the accepting thread for its end
  int port_ = 0;
  Serve serve_;
  std::atomic<bool> closing_ = false;
  std::mutex mutex_;
  std::map<int, Connection> connections_;
  std::unique_ptr<httplib::ThreadPool> threads_;
  std::thread accepting_;
};

}  // namespace lab::dashboard
