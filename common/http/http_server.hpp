/// An HTTP/1.1 server: one thread and one request per connection.
#pragma once

#include <atomic>
#include <functional>
#include <utility>

#include "common/http/connection_acceptor.hpp"
#include "common/http/http_exchange.hpp"

namespace lab {

/// Why the server refuses a connection before a handler sees a request.
enum class RequestFault { kMalformed, kTooLarge, kNoPlace };

/// The HTTP status of a fault: 400, 431 or 503.
[[nodiscard]] int statusOf(RequestFault fault);

/// Listens from construction and serves from open() to close(), on threads of its own.
class HttpServer {
 public:
  /// Called with a request whose head has been read. It must respond. Runs on many threads at once.
  using Handler = std::function<void(HttpExchange&)>;

  /// Returns the response to a faulty request. Called exactly once for each.
  using FaultHandler = std::function<HttpResponse(RequestFault)>;

  /// @throws std::runtime_error if no port is free or the address does not belong to this host
  explicit HttpServer(ListenOptions options) : acceptor_(std::move(options)) {}
  ~HttpServer() { close(); }
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] int port() const { return acceptor_.port(); }

  /// Begins to serve. Call it once.
  void open(Handler handler, FaultHandler fault_handler);

  /// Marks the request of the exchange as permitted: its connection keeps its place when others
  /// ask for one. Call it from the handler.
  void identify(HttpExchange& exchange) { acceptor_.identify(exchange.stream().socket()); }

  /// Shuts down all connections and waits until their handlers have returned.
  void close();

 private:
  void serve(int socket, bool has_place);

  Handler handler_;
  FaultHandler fault_handler_;
  std::atomic<bool> closing_ = false;
  ConnectionAcceptor acceptor_;
};

}  // namespace lab
