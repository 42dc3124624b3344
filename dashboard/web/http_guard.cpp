#include "dashboard/web/http_guard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace lab::dashboard {
namespace {

constexpr std::size_t kLongestTarget = 2048;
constexpr std::array<std::string_view, 3> kControls{"/api/wish", "/api/check", "/api/start"};

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

/// An address as Host writes it.
std::string hostForm(std::string_view address) {
  return has(address, ":") ? fmt::format("[{}]", address) : std::string(address);
}

/// IPv4 on a socket of IPv6, as IPv4.
std::string_view unmapped(std::string_view address) {
  constexpr std::string_view kMapped = "::ffff:";
  if (address.starts_with(kMapped) && has(address, ".")) address.remove_prefix(kMapped.size());
  return address;
}

bool isOurHost(const GuardRules& rules, const RequestFacts& facts) {
  const std::string host = lowerCase(facts.host);
  // The address that was reached is no name, so that no foreign name server can have led here.
  const std::array<std::string, 5> ours{"127.0.0.1", "localhost", "[::1]", hostForm(rules.address),
                                        hostForm(unmapped(facts.local))};
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
  // Somebody followed a link to the page: it is shown to them, not to the page they came from.
  return facts.method != "GET" || facts.target != "/" || facts.fetch_mode != "navigate";
}

bool hasTricks(std::string_view target) {
  if (!target.starts_with('/') || has(target, "//")) return true;
  const std::string path = lowerCase(target.substr(0, target.find('?')));
  for (const std::string_view trick : {"%2e", "%2f", "%5c", "%25", "%00", "\\", "/../", "/./"}) {
    if (has(path, trick)) return true;
  }
  if (path.ends_with("/..") || path.ends_with("/.")) return true;
  return std::ranges::any_of(target, [](unsigned char sign) { return sign <= ' ' || sign > '~'; });
}

}  // namespace

bool isLoopback(std::string_view address) {
  address = unmapped(address);
  return address.starts_with("127.") || address == "::1";
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
  if (facts.target.size() > kLongestTarget) {
    return {Refusal::kOversized, 414,
            fmt::format("the address has {} characters, {} are read", facts.target.size(),
                        kLongestTarget)};
  }
  if (!isOurHost(rules, facts)) {
    return {Refusal::kHost, 403,
            fmt::format("this is not the host that was asked for; use http://{}:{}/",
                        hostForm(unmapped(facts.local)), rules.port)};
  }
  if (isForeign(facts)) {
    return {Refusal::kOrigin, 403, "another site's page asks; open this page itself"};
  }
  if (hasTricks(facts.target)) {
    return {Refusal::kPath, 404, "there is no such path; docs/dashboard.md lists all"};
  }
  const bool control = std::ranges::find(kControls, facts.target) != kControls.end();
  const bool looks = facts.method == "GET" || facts.method == "HEAD";
  if (control ? facts.method != "POST" : !looks) {
    return {Refusal::kPath, 405,
            fmt::format("{} takes {} alone", control ? facts.target : "this",
                        control ? "POST" : "GET and HEAD")};
  }
  return {};
}

Decision mayControl(const GuardRules& rules, const RequestFacts& facts) {
  if (rules.token.empty()) {
    return {Refusal::kToken, 403, "this server was started without a token: nobody may"};
  }
  if (!rules.control_from_elsewhere && !isLoopback(facts.peer)) {
    return {Refusal::kToken, 403,
            "from another machine the page is read-only; [dashboard] control_from_elsewhere = true "
            "changes that"};
  }
  if (facts.token.empty()) {
    return {Refusal::kToken, 403,
            "the token is missing: open the whole address that the lab printed, with what stands "
            "behind #"};
  }
  if (!sameSecret(facts.token, rules.token)) {
    return {Refusal::kToken, 403,
            "the token is another server's: open the address that the lab printed last"};
  }
  return {};
}

}  // namespace lab::dashboard
