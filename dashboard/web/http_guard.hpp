/// Who may ask for what: decided from a request's own words, before anything else looks at it.
#pragma once

#include <string>
#include <string_view>

namespace lab::dashboard {

/// What a request says of itself. A header that is absent is empty.
struct RequestFacts {
  std::string_view method;
  std::string_view target;  ///< as sent, undecoded: "/api/runs/x?y=z"
  std::string_view host;
  std::string_view origin;
  std::string_view fetch_site;  ///< Sec-Fetch-Site
  std::string_view fetch_mode;  ///< Sec-Fetch-Mode
  std::string_view token;       ///< X-Lab-Token
  std::string_view peer;        ///< numeric address of who asks
  std::string_view local;       ///< numeric address that was reached
};

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
  std::string why;   ///< for people: what was found, what to do

  [[nodiscard]] bool yes() const { return refusal == Refusal::kNone; }
};

/// Whether the request is served at all: a Host that is this server's (else it may be a page that
/// was loaded under another name: DNS rebinding), no other site's page behind it, a method that the
/// path takes, a path without tricks.
[[nodiscard]] Decision mayRead(const GuardRules& rules, const RequestFacts& facts);

/// Whether it may change anything; to be asked after mayRead().
[[nodiscard]] Decision mayControl(const GuardRules& rules, const RequestFacts& facts);

/// 127.0.0.0/8, ::1.
[[nodiscard]] bool isLoopback(std::string_view address);

/// Equal, in a time that depends on the lengths alone.
[[nodiscard]] bool sameSecret(std::string_view one, std::string_view other);

}  // namespace lab::dashboard
