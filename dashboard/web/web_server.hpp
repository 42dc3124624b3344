/// The HTTP server of the page: its files, the event stream, the requests of its buttons.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "dashboard/control/lab_request_handler.hpp"
#include "dashboard/web/http_guard.hpp"
#include "dashboard/web/hub.hpp"

namespace lab::dashboard {

struct WebOptions {
  std::string address = "127.0.0.1";    ///< to listen on
  int port = 8480;                      ///< if taken, the next free one of 100
  std::string token;                    ///< part of the page's address, required for control
  bool control_from_elsewhere = false;  ///< whether other hosts may control the lab with the token
  std::filesystem::path runs;           ///< folder of past runs
  std::filesystem::path programs;       ///< folder of the lab's executables
  std::filesystem::path experiments;    ///< folder of the shipped experiments
  int camera_port = 0;                  ///< of the tracker's debug view on this host, 0: none
};

/// Listens from construction to destruction, on threads of its own.
class WebServer {
 public:
  /// @throws std::runtime_error if no port is free or the address does not belong to this host
  WebServer(const WebOptions& options, Hub& hub, LabRequestHandler& lab);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  [[nodiscard]] int port() const;

  /// The page's address with the token: "http://127.0.0.1:8480/#token=...".
  [[nodiscard]] std::string address() const;

  [[nodiscard]] Refusals refusals() const;

  /// The number of open event streams.
  [[nodiscard]] int viewers() const;

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

/// 128 random bits in hexadecimal digits, from the operating system.
/// @throws std::runtime_error if the system has no random numbers
[[nodiscard]] std::string newToken();

}  // namespace lab::dashboard
