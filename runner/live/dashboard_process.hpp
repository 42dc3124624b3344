/// The dashboard beside a run: a process on which nothing depends.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "runner/live/local_process.hpp"
#include "runner/live/restart_limit.hpp"

namespace lab::runner {

struct DashboardOptions {
  std::filesystem::path program;         ///< the dashboard
  std::string url;                       ///< of the bus
  std::filesystem::path experiment{};    ///< its file, empty: not known
  std::filesystem::path runs;            ///< folder of past runs
  int port = 0;                          ///< first port tried, 0: from the experiment file
  std::filesystem::path address_file;    ///< readable by the user only, removed at the end
  std::filesystem::path address_copy{};  ///< second file for the address, empty: none
  std::filesystem::path output;          ///< file for its output
  bool this_machine_only = false;        ///< whatever the experiment file says
};

/// Starts the dashboard, prints its address, restarts it when it dies, and gives it up after too
/// many restarts. Errors are reported, never thrown.
class DashboardProcess {
 public:
  /// Receives a sentence for the user and the record.
  using Say = std::function<void(const std::string&)>;

  explicit DashboardProcess(DashboardOptions options) : options_(std::move(options)) {}
  ~DashboardProcess() { end(); }
  DashboardProcess(const DashboardProcess&) = delete;
  DashboardProcess& operator=(const DashboardProcess&) = delete;

  /// Starts it without waiting. Gives it up when it is not installed.
  /// @param say called when it cannot be started
  void start(const Say& say);

  /// Call regularly: prints the address once it is known and when it changes, and restarts a dead
  /// process (RestartLimit).
  /// @param say called for each death
  void supervise(std::int64_t now, const Say& say);

  /// The address with its token; empty: not known yet.
  [[nodiscard]] const std::string& address() const { return address_; }

  /// Whether it was given up.
  [[nodiscard]] bool givenUp() const { return given_up_; }

  /// Ends it and removes the files with its address.
  void end();

 private:
  void startProcess();
  void findAddress();
  void giveUp(const std::string& why, const Say& say);

  DashboardOptions options_;
  std::unique_ptr<LocalProcess> process_;
  std::string address_;
  RestartLimit limit_;
  std::optional<std::int64_t> restart_utime_;  ///< it is dead until then
  bool given_up_ = false;
};

/// Writes a file that only its owner can read: whoever has the address can control the lab. Prints
/// a line on stderr when that fails.
void writePrivately(const std::filesystem::path& path, const std::string& text);

/// Whether a run has the dashboard.
/// @param asked --web or --no-web, nullopt: neither was given
/// @param ci the environment variable CI, may be null
/// @throws UserError for --web in virtual time
[[nodiscard]] bool wantsDashboard(std::optional<bool> asked, bool virtual_time, const char* ci);

}  // namespace lab::runner
