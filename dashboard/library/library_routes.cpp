#include "dashboard/library/library_routes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "common/files/file_text.hpp"
#include "common/process/running_labs.hpp"
#include "dashboard/library/run_compare.hpp"
#include "dashboard/web/http_response.hpp"
#include "dashboard/web/json.hpp"

namespace lab::dashboard {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxCompared = 8;
constexpr FileKind kSummaries{"a summary", 20'000'000};  // of one comparison, together

/// Restricts a file of a run. Its content is not trusted: it must not run scripts with the rights
/// of the page.
void restrictFile(const std::string& name, HttpResponse& response) {
  if (name.ends_with(".html")) {
    response.setHeader(
        "Content-Security-Policy",
        "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; style-src "
        "'unsafe-inline'; img-src 'self' data: blob:; media-src 'self'; font-src data:; "
        "frame-ancestors "
        "'self'");
    response.setHeader("X-Frame-Options", "SAMEORIGIN");
  } else if (name.ends_with(".pdf")) {
    // The browsers' viewers do not work in a sandbox.
    response.setHeader("Content-Disposition", "attachment");
  } else {
    response.setHeader("Content-Security-Policy",
                       "sandbox; default-src 'none'; style-src 'unsafe-inline'; img-src data:");
  }
}

/// Sends a file in pieces, because trajectories of long runs can be larger than the memory.
void sendFile(const fs::path& path, HttpResponse& response) {
  const auto file = std::make_shared<std::ifstream>(path, std::ios::binary);
  response.setHeader("Content-Type", contentType(path.filename().string()));
  const std::uintmax_t size = fs::file_size(path);
  response.source_length = size;
  response.source = [file, left = size](ClientStream& client) mutable {
    std::array<char, 65536> piece{};
    const auto wanted = std::min<std::uintmax_t>(left, piece.size());
    file->read(piece.data(), static_cast<std::streamsize>(wanted));
    const auto count = static_cast<std::size_t>(file->gcount());
    left -= count;
    return count > 0 && client.write({piece.data(), count}) && left > 0;
  };
}

/// The labs that run on this machine. Only clients that may control this lab get the addresses of
/// their pages, which include the tokens.
std::string labsJson(bool control) {
  Json all = Json::array();
  for (const RunningLab& lab : runningLabs()) {
    const std::string page = control ? pageOf(lab) : "";
    all.push_back({{"name", lab.name},
                   {"directory", lab.directory},
                   {"replay", lab.replay},
                   {"address", page.empty() ? Json() : Json(page)}});
  }
  return toText(all);
}

}  // namespace

LibraryRoutes::LibraryRoutes(RunLauncher::Folders folders)
    : LibraryRoutes(std::move(folders), [](const fs::path& summary) {
        return readWholeFile(summary, kSummaries).value_or("");
      }) {}

LibraryRoutes::LibraryRoutes(RunLauncher::Folders folders, ReadSummary read_summary)
    : runs_(folders.runs),
      // lab sweep makes the folder `campaigns` beside `runs`.
      campaigns_(fs::absolute(folders.runs).lexically_normal().parent_path() / "campaigns"),
      launcher_(std::move(folders)),
      read_summary_(std::move(read_summary)) {}

Decision LibraryRoutes::get(const HttpRequest& request, bool control, HttpResponse& response) {
  constexpr std::string_view kRuns = "/api/runs/";
  constexpr std::string_view kCampaigns = "/api/campaigns/";
  const std::string path = request.path();
  if (path == "/api/compare") return compare(request, response);
  if (path.starts_with(kRuns)) return file(path.substr(kRuns.size()), response);
  if (path.starts_with(kCampaigns)) return campaignFile(path.substr(kCampaigns.size()), response);
  if (path == "/api/campaigns") {
    respondJson(response, campaigns_.json());
  } else if (path == "/api/runs") {
    respondJson(response, runs_.json());
  } else if (path == "/api/labs") {
    respondJson(response, labsJson(control));
  } else if (path == "/api/experiments") {
    respondJson(response, launcher_.experiments());
  } else if (path == "/api/started") {
    respondJson(response, launcher_.started(control));
  } else {
    return {Refusal::kPath, 404, "there is no such path; docs/dashboard.md lists all paths"};
  }
  return {};
}

void LibraryRoutes::post(const HttpRequest& request, HttpResponse& response) {
  RunLauncher::Response result = request.path() == "/api/start" ? launcher_.start(request.body)
                                                                : launcher_.check(request.body);
  respondJson(response, std::move(result.json), result.status);
}

Decision LibraryRoutes::compare(const HttpRequest& request, HttpResponse& response) {
  const std::lock_guard lock(comparing_);
  if (closing_) {
    respondError(response, 503, "the server ends");
    return {};
  }
  Json all = Json::array();
  std::istringstream names(request.query("runs"));
  std::size_t count = 0;
  std::uintmax_t bytes = 0;
  for (std::string name; std::getline(names, name, ',');) {
    if (++count > kMaxCompared) {
      return {Refusal::kMalformed, 400, fmt::format("runs: expected at most {}", kMaxCompared)};
    }
    if (!runs_.folderOf(name)) return {Refusal::kPath, 404, "runs: there is no run " + name};
    const auto summary = runs_.file(name, "summary.json");
    if (!summary) {
      respondError(response, 409,
                   name + " has no summary.json; lab analyze creates one from its log");
      return {};
    }
    bytes += fs::file_size(*summary);
    if (bytes > kSummaries.most_bytes) {
      respondError(response, 409,
                   fmt::format("{}: up to this run, the files summary.json have {} bytes, expected "
                               "at most {}; compare fewer runs, or their report.html",
                               name, bytes, kSummaries.most_bytes));
      return {};
    }
    const std::string text = read_summary_(*summary);
    try {
      for (auto& program : curvesOf(name, text)) all.push_back(std::move(program));
    } catch (const std::runtime_error& error) {
      respondError(response, 409, error.what());
      return {};
    }
  }
  respondJson(response, toText(all));
  return {};
}

Decision LibraryRoutes::file(const std::string& run_and_name, HttpResponse& response) {
  const std::size_t slash = run_and_name.find('/');
  if (slash != std::string::npos) {
    const std::string name = run_and_name.substr(slash + 1);
    if (const auto path = runs_.file(run_and_name.substr(0, slash), name)) {
      restrictFile(name, response);
      sendFile(*path, response);
      return {};
    }
  }
  return {Refusal::kPath, 404, "there is no such run, or the file is not part of its report"};
}

Decision LibraryRoutes::campaignFile(const std::string& campaign_and_name, HttpResponse& response) {
  const std::size_t slash = campaign_and_name.find('/');
  if (slash != std::string::npos) {
    const std::string name = campaign_and_name.substr(slash + 1);
    if (const auto path = campaigns_.file(campaign_and_name.substr(0, slash), name)) {
      restrictFile(name, response);
      sendFile(*path, response);
      return {};
    }
  }
  return {Refusal::kPath, 404, "there is no such campaign, or the file is not part of its page"};
}

}  // namespace lab::dashboard
