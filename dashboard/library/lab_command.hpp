/// Commands of the lab's own program, run for the page.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lab::dashboard {

struct CommandResult {
  int code = -1;       ///< of its exit; 128 + signal where it was killed
  std::string output;  ///< of both streams, its end where it was long
  bool late = false;   ///< it was stopped: for taking too long, or because of `stop`
};

/// Runs a program to its end, without input.
/// @param arguments the program's path first
/// @param stop ends it as well, should it become true
/// @throws std::runtime_error when it cannot be started.
[[nodiscard]] CommandResult runCommand(const std::vector<std::string>& arguments,
                                       std::chrono::milliseconds patience,
                                       const std::atomic<bool>& stop);

/// A program that goes on when this one ends: in a session of its own, its output in a file.
class DetachedCommand {
 public:
  /// @param folder as makeFolder() made it
  /// @throws std::runtime_error when it cannot be started.
  DetachedCommand(std::filesystem::path folder, const std::vector<std::string>& arguments);
  ~DetachedCommand();
  DetachedCommand(const DetachedCommand&) = delete;
  DetachedCommand& operator=(const DetachedCommand&) = delete;

  /// Its exit code as in CommandResult; nothing: it runs.
  [[nodiscard]] std::optional<int> code() const;

  /// The end of what it printed.
  [[nodiscard]] std::string output() const;

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  /// A new folder that only this user sees. It goes with the command, once that has ended.
  [[nodiscard]] static std::filesystem::path makeFolder();

 private:
  std::filesystem::path folder_;
  std::shared_ptr<std::atomic<int>> code_;  ///< set by the thread that waits for its end
};

/// The last so many bytes of a text, from the begin of a line or a character on.
[[nodiscard]] std::string tailOf(std::string text, std::size_t bytes);

}  // namespace lab::dashboard
