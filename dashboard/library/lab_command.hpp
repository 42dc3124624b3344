/// Runs commands of the program `lab` for the page.
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
  int code = -1;            ///< exit code; 128 + signal if a signal ended it
  std::string output;       ///< stdout and stderr; only the end if it is long
  bool was_killed = false;  ///< because of the timeout or of `stop`
};

/// Runs a program with empty input and waits for its end.
/// @param arguments the first one is the program's path
/// @param stop the program is killed when it becomes true
/// @throws std::runtime_error if the program cannot be started
[[nodiscard]] CommandResult runCommand(const std::vector<std::string>& arguments,
                                       std::chrono::milliseconds timeout,
                                       const std::atomic<bool>& stop);

/// A program that continues after this one has ended: it has its own session and writes its output
/// to a file.
class DetachedCommand {
 public:
  /// @param folder from makeFolder()
  /// @throws std::runtime_error if the program cannot be started
  DetachedCommand(std::filesystem::path folder, const std::vector<std::string>& arguments);
  ~DetachedCommand();
  DetachedCommand(const DetachedCommand&) = delete;
  DetachedCommand& operator=(const DetachedCommand&) = delete;

  /// The exit code as in CommandResult; nothing while it runs.
  [[nodiscard]] std::optional<int> code() const;

  /// The end of its output.
  [[nodiscard]] std::string output() const;

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  /// Creates a folder that only this user can read. The destructor removes it if the command has
  /// ended.
  [[nodiscard]] static std::filesystem::path makeFolder();

 private:
  std::filesystem::path folder_;
  std::shared_ptr<std::atomic<int>> code_;  ///< set by the thread that waits for the process
};

/// At most the last `bytes` bytes of a text, from the beginning of a line if there is one, else of
/// a UTF-8 character.
[[nodiscard]] std::string tailOf(std::string text, std::size_t bytes);

}  // namespace lab::dashboard
