/// Checks experiment files and starts runs for the page.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "dashboard/library/lab_command.hpp"

namespace lab::dashboard {

/// Runs the program `lab`. Thread-safe. At most one run that was started here exists at a time.
class RunLauncher {
 public:
  struct Folders {
    std::filesystem::path programs;     ///< of the executable `lab`
    std::filesystem::path experiments;  ///< the shipped files
    std::filesystem::path runs;         ///< where runs are created
    std::filesystem::path own;          ///< the user's folder with experiment files
  };

  struct Response {
    int status = 200;  ///< of HTTP
    std::string json;
  };

  explicit RunLauncher(Folders folders) : folders_(std::move(folders)) {}

  /// The response to GET /api/experiments.
  [[nodiscard]] std::string experiments() const;

  // Both take the body of the request. @throws JsonObjectError if it is not the expected object
  [[nodiscard]] Response check(std::string_view body);
  [[nodiscard]] Response start(std::string_view body);

  /// Ends the running check and all later ones. A run goes on.
  void close() { closing_ = true; }

  /// The response to GET /api/started.
  /// @param control whether the client may control this lab; only then the response has the address
  ///        of the new run's page, which includes its token
  [[nodiscard]] std::string started(bool control);

 private:
  Folders folders_;
  std::atomic<bool> closing_ = false;
  std::mutex checking_;  ///< one check at a time: each takes a core for a second
  std::mutex mutex_;
  std::unique_ptr<DetachedCommand> run_;
};

}  // namespace lab::dashboard
