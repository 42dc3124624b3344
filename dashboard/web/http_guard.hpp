/// Decides from a request's head alone whether it is served, before anything else looks at it.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/http/http_message.hpp"

namespace lab::dashboard {

constexpr std::size_t kMaxRequestBody = 64 * 1024;  // [byte]

/// What the decisions depend on. A header that is absent is empty.
struct RequestFacts {
  std::string_view method;
  std::string_view target;  ///< as sent, undecoded: "/api/runs/x?y=z"
  std::string_view host;
  std::string_view origin;
  std::string_view fetch_site;  ///< Sec-Fetch-Site
  std::string_view fetch_mode;  ///< Sec-Fetch-Mode
  std::string_view token;       ///< X-Lab-Token
  std::string_view peer;        ///< numeric address of the client
  std::string_view local;       ///< numeric address that the client connected to
};

/// The result points into `request`.
[[nodiscard]] RequestFacts factsOf(const HttpRequest& request);

struct GuardRules {
  std::string address;  ///< listened on
  int port = 0;
  std::string token;
  bool control_from_elsewhere = false;
};

enum class Refusal { kNone, kHost, kOrigin, kToken, kPath, kMalformed, kOversized, kCrowded };

struct Decision {
  Refusal refusal = Refusal::kNone;
  int status = 200;  ///< of HTTP
  std::string why;   ///< for the user: what was found, what to do

  [[nodiscard]] bool yes() const { return refusal == Refusal::kNone; }
};

/// Whether the request is served at all. Refuses a Host that is not this server's (it may be a page
/// that was loaded under another name: DNS rebinding), requests from pages of other sites, methods
/// that the path does not support, and paths with traversal or encoded separators.
[[nodiscard]] Decision mayRead(const GuardRules& rules, const RequestFacts& facts);

/// Whether the request may have a body of this length and type. Call it after mayRead(), before the
/// body is read.
[[nodiscard]] Decision checkBody(const HttpRequest& request);

/// Whether the client may control the lab. Call it after mayRead().
[[nodiscard]] Decision mayControl(const GuardRules& rules, const RequestFacts& facts);

/// Compares two texts in a time that depends on their lengths alone.
[[nodiscard]] bool sameSecret(std::string_view one, std::string_view other);

/// Numbers of refused requests since the start.
struct Refusals {
  std::int64_t host = 0;       ///< a Host that is not this server's: DNS rebinding
  std::int64_t origin = 0;     ///< a page of another site
  std::int64_t token = 0;      ///< missing or wrong token where one is required
  std::int64_t path = 0;       ///< nothing is served there
  std::int64_t malformed = 0;  ///< invalid HTTP, JSON or operator request
  std::int64_t oversized = 0;
  std::int64_t crowded = 0;  ///< more clients than are served at once
};

/// Counts refusals, from any thread.
class RefusalCount {
 public:
  void add(Refusal refusal) { counts_.at(static_cast<std::size_t>(refusal)) += 1; }

  [[nodiscard]] Refusals all() const {
    return {of(Refusal::kHost),   of(Refusal::kOrigin),    of(Refusal::kToken),
            of(Refusal::kPath),   of(Refusal::kMalformed), of(Refusal::kOversized),
            of(Refusal::kCrowded)};
  }

 private:
  [[nodiscard]] std::int64_t of(Refusal refusal) const {
    return counts_.at(static_cast<std::size_t>(refusal));
  }

  std::array<std::atomic<std::int64_t>, 8> counts_{};
};

}  // namespace lab::dashboard
