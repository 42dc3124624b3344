#include "dashboard/web/http_guard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "common/http/ip_address.hpp"

namespace lab::dashboard {
namespace {

constexpr std::size_t kMaxTarget = 2048;
constexpr std::array<std::string_view, 4> kControlPaths{"/api/request", "/api/wish", "/api/check",
                                                        "/api/start"};

bool has(std::string_view text, std::string_view piece) {
  return text.find(piece) != std::string_view::npos;
}

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char letter) {
    return static_cast<char>(std::tolower(letter));
  });
  return lower;
}

/// An address as it is written in a Host header.
std::string hostForm(std::string_view address) {
  return has(address, ":") ? fmt::format("[{}]", address) : std::string(address);
}

bool isOurHost(const GuardRules& rules, const RequestFacts& facts) {
  const std::string host = lowerCase(facts.host);
  // The address that the client connected to is not a name, so no DNS server can have led here.
  const std::array<std::string, 5> ours{"127.0.0.1", "localhost", "[::1]", hostForm(rules.address),
                                        hostForm(withoutMappedPrefix(facts.local))};
  return std::ranges::any_of(ours, [&](const std::string& name) {
    return host == name || host == fmt::format("{}:{}", name, rules.port);
  });
}

bool isForeign(const RequestFacts& facts) {
  if (!facts.origin.empty() && lowerCase(facts.origin) != "http://" + lowerCase(facts.host)) {
    return true;
  }
  if (facts.fetch_site.empty() || facts.fetch_site == "same-origin" || facts.fetch_site == "none") {
    return false;
  }
  // The user followed a link to this page. The linking page does not see the response.
  return facts.method != "GET" || facts.target != "/" || facts.fetch_mode != "navigate";
}

bool isSuspicious(std::string_view target) {
  if (!target.starts_with('/') || has(target, "//")) return true;
  const std::string path = lowerCase(target.substr(0, target.find('?')));
  for (const std::string_view piece : {"%2e", "%2f", "%5c", "%25", "%00", "\\", "/../", "/./"}) {
    if (has(path, piece)) return true;
  }
  if (path.ends_with("/..") || path.ends_with("/.")) return true;
  return std::ranges::any_of(target,
                             [](unsigned char letter) { return letter <= ' ' || letter > '~'; });
}

}  // namespace

RequestFacts factsOf(const HttpRequest& request) {
  return {.method = request.method,
          .target = request.target,
          .host = request.header("Host"),
          .origin = request.header("Origin"),
          .fetch_site = request.header("Sec-Fetch-Site"),
          .fetch_mode = request.header("Sec-Fetch-Mode"),
          .token = request.header("X-Lab-Token"),
          .peer = request.peer,
          .local = request.local};
}

bool sameSecret(std::string_view one, std::string_view other) {
  unsigned difference = one.size() == other.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(one.size(), other.size()); ++i) {
    difference |= static_cast<unsigned>(static_cast<unsigned char>(one[i]) ^
                                        static_cast<unsigned char>(other[i]));
  }
  return difference == 0;
}

Decision mayRead(const GuardRules& rules, const RequestFacts& facts) {
  if (facts.target.size() > kMaxTarget) {
    return {Refusal::kOversized, 414,
            fmt::format("the address has {} characters, expected at most {}", facts.target.size(),
                        kMaxTarget)};
  }
  if (!isOurHost(rules, facts)) {
    return {Refusal::kHost, 403,
            fmt::format("this server does not have the requested host name; use http://{}:{}/",
                        hostForm(withoutMappedPrefix(facts.local)), rules.port)};
  }
  if (isForeign(facts)) {
    return {Refusal::kOrigin, 403,
            "the request comes from a page of another site; open this page directly"};
  }
  if (isSuspicious(facts.target)) {
    return {Refusal::kPath, 404, "there is no such path; docs/dashboard.md lists all paths"};
  }
  const bool control = std::ranges::find(kControlPaths, facts.target) != kControlPaths.end();
  const bool reads = facts.method == "GET" || facts.method == "HEAD";
  if (control ? facts.method != "POST" : !reads) {
    return {Refusal::kPath, 405,
            fmt::format("{} accepts only {}", control ? facts.target : "this path",
                        control ? "POST" : "GET and HEAD")};
  }
  return {};
}

Decision checkBody(const HttpRequest& request) {
  for (const char* name : {"Host", "Content-Length", "Content-Type", "X-Lab-Token", "Origin"}) {
    if (request.headerCount(name) > 1) {
      return {Refusal::kMalformed, 400, fmt::format("found {} twice, expected it once", name)};
    }
  }
  if (request.headerCount("Transfer-Encoding") + request.headerCount("Content-Encoding") > 0) {
    return {Refusal::kMalformed, 400, "expected a body without encoding, with a Content-Length"};
  }
  const std::string length(request.header("Content-Length"));
  const bool post = request.method == "POST";
  const std::size_t limit = post ? kMaxRequestBody : 0;
  if (length.empty() && !post) return {};
  if (length.empty()) return {Refusal::kMalformed, 411, "expected a Content-Length"};
  if (length.find_first_not_of("0123456789") != std::string::npos) {
    return {Refusal::kMalformed, 400, "Content-Length: expected a number"};
  }
  if (length.size() > 9 || std::stoul(length) > limit) {
    return {Refusal::kOversized, 413,
            fmt::format("found a body of {} bytes, expected at most {}", length, limit)};
  }
  if (post && !request.header("Content-Type").starts_with("application/json")) {
    return {Refusal::kMalformed, 415, "Content-Type: expected application/json"};
  }
  return {};
}

Decision mayControl(const GuardRules& rules, const RequestFacts& facts) {
  if (rules.token.empty()) {
    return {Refusal::kToken, 403,
            "this server was started without a token, so nobody may control the lab"};
  }
  if (!rules.control_from_elsewhere && !isLoopback(facts.peer)) {
    return {Refusal::kToken, 403,
            "from another host the page is read-only; [dashboard] control_from_elsewhere = true "
            "changes that"};
  }
  if (facts.token.empty()) {
    return {Refusal::kToken, 403,
            "the token is missing: open the complete address that the lab printed, including the "
            "part after #"};
  }
  if (!sameSecret(facts.token, rules.token)) {
    return {Refusal::kToken, 403,
            "the token belongs to another server: open the address that the lab printed last"};
  }
  return {};
}

}  // namespace lab::dashboard
