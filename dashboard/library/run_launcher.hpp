/// Checks experiments and starts one, as the page asks.
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

/// From any thread.
class RunLauncher {
 public:
  struct Places {
    std::filesystem::path programs;     ///< where `lab` is
    std::filesystem::path experiments;  ///< the shipped ones
    std::filesystem::path runs;         ///< where runs are made
    std::filesystem::path own;          ///< the user's: files of experiments, and where runs start
  };

  struct Answer {
    int status = 200;  ///< of HTTP
    std::string json;
  };

  explicit RunLauncher(Places places) : places_(std::move(places)) {}

  [[nodiscard]] std::string experiments() const;

  // Both take the body of the request. @throws JsonObjectError for what it must not be.
  [[nodiscard]] Answer check(std::string_view body);
  [[nodiscard]] Answer start(std::string_view body);

  /// Ends a check that is under way, and those to come. A run goes on.
  void close() { closing_ = true; }

  /// Of `GET /api/started`.
  /// @param control whether who asks may use this page's buttons, and so those of the run's own.
  [[nodiscard]] std::string started(bool control);

 private:
  Places places_;
  std::atomic<bool> closing_ = false;
  std::mutex checking_;  ///< one at a time: a check takes a core for a second
  std::mutex mutex_;
  std::unique_ptr<DetachedCommand> run_;
};

}  // namespace lab::dashboard
