/// The part of the web server that serves past runs and experiment files.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>

#include "common/http/http_message.hpp"
#include "dashboard/library/campaign_list.hpp"
#include "dashboard/library/run_launcher.hpp"
#include "dashboard/library/run_list.hpp"
#include "dashboard/web/http_guard.hpp"

namespace lab::dashboard {

/// Serves the paths /api/runs, /api/campaigns, /api/compare, /api/labs, /api/experiments,
/// /api/started, /api/check and /api/start. Thread-safe.
class LibraryRoutes {
 public:
  /// Reads the summary.json of a run; empty if it cannot be read.
  using ReadSummary = std::function<std::string(const std::filesystem::path&)>;

  explicit LibraryRoutes(RunLauncher::Folders folders);
  /// @param read_summary for comparisons; called by one thread at a time
  LibraryRoutes(RunLauncher::Folders folders, ReadSummary read_summary);

  /// Fills in the response to a GET.
  /// @param control whether the client may control the lab
  /// @return yes(), or why nothing is served
  [[nodiscard]] Decision get(const HttpRequest& request, bool control, HttpResponse& response);

  /// Fills in the response to a POST to /api/check or /api/start.
  /// @throws JsonObjectError if the body is not the expected JSON object
  void post(const HttpRequest& request, HttpResponse& response);

  /// Ends running commands, and the comparisons that wait for another one.
  void close() {
    closing_ = true;
    launcher_.close();
  }

 private:
  [[nodiscard]] Decision compare(const HttpRequest& request, HttpResponse& response);
  [[nodiscard]] Decision file(const std::string& run_and_name, HttpResponse& response);
  [[nodiscard]] Decision campaignFile(const std::string& campaign_and_name, HttpResponse& response);

  RunList runs_;
  CampaignList campaigns_;
  RunLauncher launcher_;
  ReadSummary read_summary_;
  std::atomic<bool> closing_ = false;
  std::mutex
      comparing_;  ///< one comparison at a time: parsed, summaries take many times their size
};

}  // namespace lab::dashboard
