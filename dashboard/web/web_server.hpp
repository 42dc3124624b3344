/// The page, its live stream and its buttons over HTTP.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "dashboard/control/lab_request_handler.hpp"
#include "dashboard/web/hub.hpp"

namespace lab::dashboard {

struct WebOptions {
  std::string address = "127.0.0.1";    ///< to listen on
  int port = 8480;                      ///< the next free one is taken, within 100
  std::string token;                    ///< in the page's address: who has it may use the buttons
  bool control_from_elsewhere = false;  ///< else only from this machine, token or not
  std::filesystem::path runs;           ///< folder of past runs
  std::filesystem::path programs;       ///< folder of the lab's programs
  std::filesystem::path experiments;    ///< folder of the shipped experiments
  int camera_port = 0;                  ///< of the tracker's debug view, 0: none
};

/// What was turned away since the start.
struct Refusals {
  std::int64_t host = 0;       ///< a Host that is not ours: DNS rebinding
  std::int64_t origin = 0;     ///< another site's page
  std::int64_t token = 0;      ///< missing or wrong, for what needs it
  std::int64_t path = 0;       ///< outside what is served
  std::int64_t malformed = 0;  ///< no HTTP, no JSON, not a wish
  std::int64_t oversized = 0;
  std::int64_t crowded = 0;  ///< more clients than are served at once
};

/// Listens from construction to destruction, on threads of its own; costs the caller nothing.
class WebServer {
 public:
  /// @throws std::runtime_error when no port is free or the address is not one of this machine.
  WebServer(const WebOptions& options, Hub& hub, LabRequestHandler& lab);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  [[nodiscard]] int port() const;

  /// "http://127.0.0.1:8480/#token=..."
  [[nodiscard]] std::string address() const;

  [[nodiscard]] Refusals refusals() const;

  /// Streams that are open.
  [[nodiscard]] int viewers() const;

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

/// 128 random bits in hexadecimal, from the system's generator.
[[nodiscard]] std::string newToken();

}  // namespace lab::dashboard
