/// What the web server shows of past runs and of experiments that could be run.
#pragma once

#include <httplib.h>

#include <string>

#include "dashboard/library/run_launcher.hpp"
#include "dashboard/library/run_list.hpp"
#include "dashboard/web/http_guard.hpp"

namespace lab::dashboard {

/// The paths /api/runs, /api/compare, /api/experiments, /api/started, /api/check and /api/start.
/// From any thread.
class LibraryRoutes {
 public:
  explicit LibraryRoutes(RunLauncher::Places places);

  /// Answers a GET.
  /// @param control whether who asks may use the buttons
  /// @return why there is nothing of that path; yes() where the response is made.
  [[nodiscard]] Decision get(const httplib::Request& request, bool control,
                             httplib::Response& response);

  /// Answers a POST to /api/check or /api/start. @throws JsonObjectError
  void post(const httplib::Request& request, httplib::Response& response);

  /// What is under way ends soon.
  void close() { launcher_.close(); }

 private:
  [[nodiscard]] Decision compare(const httplib::Request& request, httplib::Response& response);
  [[nodiscard]] Decision file(const std::string& run_and_name, httplib::Response& response);

  RunList runs_;
  RunLauncher launcher_;
};

}  // namespace lab::dashboard
