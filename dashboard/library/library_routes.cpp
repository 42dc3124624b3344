#include "dashboard/library/library_routes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "dashboard/library/run_compare.hpp"
#include "dashboard/web/http_response.hpp"

namespace lab::dashboard {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMostCompared = 8;
constexpr std::uintmax_t kLargestSummary = 20'000'000;  // bytes; in memory several times that

/// A file comes from a run and may hold anything: it runs no script in the page's own name.
void shieldFile(const std::string& name, httplib::Response& response) {
  if (name.ends_with(".html")) {
    replaceHeader(
        response, "Content-Security-Policy",
        "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; style-src "
        "'unsafe-inline'; img-src 'self' data: blob:; font-src data:; frame-ancestors "
        "'self'");
    replaceHeader(response, "X-Frame-Options", "SAMEORIGIN");
  } else if (name.ends_with(".pdf")) {
    replaceHeader(response, "Content-Disposition", "attachment");  // viewers do not run sandboxed
  } else {
    replaceHeader(response, "Content-Security-Policy",
                  "sandbox; default-src 'none'; style-src 'unsafe-inline'; img-src data:");
  }
}

/// By pieces: trajectories of a long run do not go through memory.
void sendFile(const fs::path& path, httplib::Response& response) {
  const auto file = std::make_shared<std::ifstream>(path, std::ios::binary);
  const std::uintmax_t size = fs::file_size(path);
  const std::string type = contentType(path.filename().string());
  if (size == 0) {
    response.set_content("", type);
    return;
  }
  response.set_content_provider(
      static_cast<std::size_t>(size), type,
      [file](std::size_t, std::size_t length, httplib::DataSink& sink) {
        std::array<char, 65536> piece{};
        file->read(piece.data(), static_cast<std::streamsize>(std::min(length, piece.size())));
        const std::streamsize count = file->gcount();
        return count > 0 && sink.write(piece.data(), static_cast<std::size_t>(count));
      });
}

}  // namespace

LibraryRoutes::LibraryRoutes(RunLauncher::Places places)
    : runs_(places.runs), launcher_(std::move(places)) {}

Decision LibraryRoutes::get(const httplib::Request& request, bool control,
                            httplib::Response& response) {
  constexpr std::string_view kRuns = "/api/runs/";
  const std::string& path = request.path;
  if (path == "/api/compare") return compare(request, response);
  if (path.starts_with(kRuns)) return file(path.substr(kRuns.size()), response);
  if (path == "/api/runs") {
    respondJson(response, runs_.json());
  } else if (path == "/api/experiments") {
    respondJson(response, launcher_.experiments());
  } else if (path == "/api/started") {
    respondJson(response, launcher_.started(control));
  } else {
    return {Refusal::kPath, 404, "there is no such path; docs/dashboard.md lists all"};
  }
  return {};
}

void LibraryRoutes::post(const httplib::Request& request, httplib::Response& response) {
  RunLauncher::Answer answer =
      request.path == "/api/start" ? launcher_.start(request.body) : launcher_.check(request.body);
  respondJson(response, std::move(answer.json), answer.status);
}

Decision LibraryRoutes::compare(const httplib::Request& request, httplib::Response& response) {
  auto all = nlohmann::ordered_json::array();
  std::istringstream names(request.get_param_value("runs"));
  std::size_t count = 0;
  for (std::string name; std::getline(names, name, ',');) {
    if (++count > kMostCompared) {
      return {Refusal::kMalformed, 400, fmt::format("runs: expected at most {}", kMostCompared)};
    }
    if (!runs_.folderOf(name)) return {Refusal::kPath, 404, "runs: there is no run " + name};
    const auto summary = runs_.file(name, "summary.json");
    if (!summary) {
      respondError(response, 409,
                   name + " has no summary.json; lab analyze makes one from its log");
      return {};
    }
    if (fs::file_size(*summary) > kLargestSummary) {
      respondError(response, 409,
                   fmt::format("{}: its summary.json has more than {} MB; compare by lab report",
                               name, kLargestSummary / 1'000'000));
      return {};
    }
    std::ifstream stream(*summary, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    try {
      for (auto& program : curvesOf(name, text)) all.push_back(std::move(program));
    } catch (const std::runtime_error& error) {
      respondError(response, 409, error.what());
      return {};
    }
  }
  respondJson(response, all.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  return {};
}

Decision LibraryRoutes::file(const std::string& run_and_name, httplib::Response& response) {
  const std::size_t slash = run_and_name.find('/');
  if (slash != std::string::npos) {
    const std::string name = run_and_name.substr(slash + 1);
    if (const auto path = runs_.file(run_and_name.substr(0, slash), name)) {
      shieldFile(name, response);
      sendFile(*path, response);
      return {};
    }
  }
  return {Refusal::kPath, 404, "there is no such file of a run, or it is none of its report"};
}

}  // namespace lab::dashboard
