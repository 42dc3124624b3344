/// The page in a browser beside a lab: a process on which nothing depends.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "runner/live/child_process.hpp"

namespace lab::runner {

struct DashboardOptions {
  std::filesystem::path program;         ///< the dashboard
  std::string url;                       ///< of the bus
  std::filesystem::path experiment{};    ///< its file, empty: none is known
  std::filesystem::path runs;            ///< folder of past runs
  int port = 0;                          ///< the first one tried, 0: as the experiment says
  std::filesystem::path address_file;    ///< for the user's eyes only, removed at the end
  std::filesystem::path address_copy{};  ///< where else the address is written, empty: nowhere
  std::filesystem::path output;          ///< file for what it prints
};

/// Starts the dashboard, says where it is, starts it again on the same address when it dies, and
/// gives it up when that happens too often. Nothing that goes wrong is thrown.
class DashboardProcess {
 public:
  /// What is to be known about it, a sentence.
  using Say = std::function<void(const std::string&)>;

  explicit DashboardProcess(DashboardOptions options) : options_(std::move(options)) {}
  ~DashboardProcess() { end(); }
  DashboardProcess(const DashboardProcess&) = delete;
  DashboardProcess& operator=(const DashboardProcess&) = delete;

  /// Starts it and returns at once; gives it up where it is not installed.
  /// @param say called when it cannot be started
  void start(const Say& say);

  /// To be called again and again: prints the address when it is known and when it is another one,
  /// restarts what has died.
  /// @param say called for each death
  void supervise(const Say& say);

  /// With the token; empty: not known yet.
  [[nodiscard]] const std::string& address() const { return address_; }

  /// It will not be tried again.
  [[nodiscard]] bool givenUp() const { return given_up_; }

  /// Ends it; nothing is left of its address.
  void end();

 private:
  void startProcess();
  void findAddress();
  void giveUp(const std::string& why, const Say& say);

  DashboardOptions options_;
  std::unique_ptr<ChildProcess> process_;
  std::string address_;
  int restarts_ = 0;
  bool given_up_ = false;
};

/// Writes a file that its owner alone can read, from its first moment: who has the page's address
/// may use its buttons. Says so where it cannot.
void writePrivately(const std::filesystem::path& path, const std::string& text);

/// What a user asks for with --web and --no-web, or what holds without.
/// @param asked nothing: neither was said
/// @param ci the environment's CI, may be null
/// @throws UserError for a page of a run in virtual time
[[nodiscard]] bool wantsDashboard(std::optional<bool> asked, bool virtual_time, const char* ci);

}  // namespace lab::runner
