/// Runs the built program `lab` as a user would.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"
#include "tests/support/wait_until.hpp"

namespace lab::system_test {

using support::readFile;

struct Finished {
  int exit_code = -1;  ///< negative signal number if it was killed
  std::string output;  ///< stdout and stderr
};

/// A command in the background, in its own process group. The destructor kills it.
class Background {
 public:
  /// @param command shell command; `lab` and the services are taken from the build folder
  explicit Background(const std::string& command);
  ~Background();
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  void signal(int number) const;
  [[nodiscard]] pid_t pid() const { return pid_; }
  [[nodiscard]] bool running();
  /// The output so far.
  [[nodiscard]] std::string output() const;
  /// Waits for its end; kills it after the timeout.
  Finished wait(std::chrono::seconds timeout);

 private:
  TemporaryFolder folder_;
  pid_t pid_ = -1;
  int status_ = 0;
  bool ended_ = false;
};

/// Runs a command to its end. The timeout only ends a test that hangs: on a loaded machine a
/// command takes twenty times as long.
Finished run(const std::string& command, std::chrono::seconds timeout = std::chrono::seconds(600));

/// The output of `lab COMMAND`. Another exit code than this one fails the test.
std::string labOutput(const std::string& command, int exit_code = 0);

/// The only run folder in `parent`. @throws std::runtime_error if there is not exactly one
std::filesystem::path onlyRun(const std::filesystem::path& parent);

nlohmann::json readJson(const std::filesystem::path& file);

/// Processes whose command line contains `text`, without this process.
std::vector<pid_t> processesWith(const std::string& text);

/// The children of a process whose command line contains `text`.
std::vector<pid_t> childrenWith(pid_t parent, const std::string& text);

/// Shell text that waits, at most for a minute, until a run in `runs` has recorded for about two
/// seconds (its log has 200 kB).
std::string whenLogHasData(const std::filesystem::path& runs);
/// Shell text that waits until a file system is mounted at `folder`, at most for a minute.
std::string whenMounted(const std::filesystem::path& folder);

/// The path of a shipped experiment.
std::filesystem::path experiment(const std::string& name);

}  // namespace lab::system_test
