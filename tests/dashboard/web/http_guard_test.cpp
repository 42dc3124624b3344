#include "dashboard/web/http_guard.hpp"

#include <gtest/gtest.h>

#include "common/http/ip_address.hpp"

namespace lab::dashboard {
namespace {

const GuardRules kRules{"127.0.0.1", 8480, "0123456789abcdef", false};

RequestFacts plain() {
  RequestFacts facts;
  facts.method = "GET";
  facts.target = "/api/runs";
  facts.host = "127.0.0.1:8480";
  facts.peer = "127.0.0.1";
  facts.local = "127.0.0.1";
  return facts;
}

RequestFacts controlRequest() {
  RequestFacts facts = plain();
  facts.method = "POST";
  facts.target = "/api/request";
  facts.origin = "http://127.0.0.1:8480";
  facts.fetch_site = "same-origin";
  facts.token = kRules.token;
  return facts;
}

TEST(HttpGuard, AcceptsItsOwnHostNamesWithAndWithoutPort) {
  for (const char* host : {"127.0.0.1:8480", "127.0.0.1", "localhost:8480", "localhost",
                           "LocalHost", "[::1]:8480", "[::1]"}) {
    RequestFacts facts = plain();
    facts.host = host;
    EXPECT_TRUE(mayRead(kRules, facts).yes()) << host;
  }
}

TEST(HttpGuard, RefusesEveryOtherHost) {
  for (const char* host :
       {"", "evil.example", "evil.example:8480", "127.0.0.1:8481", "127.0.0.1.evil",
        "localhost.evil.example:8480", "localhost:", "127.0.0.1:8480 ", "10.0.0.5",
        "localhost:8480@evil", "::1", "0x7f000001", "2130706433", "localhost:08480"}) {
    RequestFacts facts = plain();
    facts.host = host;
    EXPECT_EQ(mayRead(kRules, facts).refusal, Refusal::kHost) << host;
    EXPECT_EQ(mayRead(kRules, facts).status, 403);
  }
}

TEST(HttpGuard, AcceptsTheReachedAddressWhenListeningOnAllAddresses) {
  GuardRules wide = kRules;
  wide.address = "0.0.0.0";
  RequestFacts facts = plain();
  facts.local = "192.168.1.7";
  facts.peer = "192.168.1.9";
  facts.host = "192.168.1.7:8480";
  EXPECT_TRUE(mayRead(wide, facts).yes());
  facts.host = "192.168.1.8:8480";
  EXPECT_EQ(mayRead(wide, facts).refusal, Refusal::kHost);
  facts.local = "::ffff:192.168.1.7";
  facts.host = "192.168.1.7:8480";
  EXPECT_TRUE(mayRead(wide, facts).yes()) << "an IPv4 address on an IPv6 socket";
  facts.local = "fd00::7";
  facts.host = "[fd00::7]:8480";
  EXPECT_TRUE(mayRead(wide, facts).yes());
}

TEST(HttpGuard, RefusesPagesOfOtherSites) {
  for (const char* origin :
       {"http://evil.example", "null", "https://127.0.0.1:8480", "http://127.0.0.1:8481",
        "http://localhost:8480", "http://127.0.0.1"}) {
    RequestFacts facts = controlRequest();
    facts.origin = origin;
    EXPECT_EQ(mayRead(kRules, facts).refusal, Refusal::kOrigin) << origin;
  }
  for (const char* site : {"cross-site", "same-site", "whatever"}) {
    RequestFacts facts = plain();
    facts.fetch_site = site;
    EXPECT_EQ(mayRead(kRules, facts).refusal, Refusal::kOrigin) << site;
    facts.fetch_mode = "navigate";  // a link to something else than the page
    EXPECT_EQ(mayRead(kRules, facts).refusal, Refusal::kOrigin) << site;
  }
}

TEST(HttpGuard, AcceptsLinksFromOtherSitesToThePageOnly) {
  RequestFacts facts = plain();
  facts.target = "/";
  facts.fetch_site = "cross-site";
  facts.fetch_mode = "navigate";
  EXPECT_TRUE(mayRead(kRules, facts).yes());
  facts.fetch_mode = "no-cors";
  EXPECT_EQ(mayRead(kRules, facts).refusal, Refusal::kOrigin);
  facts.fetch_mode = "navigate";
  facts.method = "POST";
  EXPECT_EQ(mayRead(kRules, facts).refusal, Refusal::kOrigin);
}

TEST(HttpGuard, RefusesTraversalAndEncodedSeparators) {
  const std::string nul("/page/a\0b", 9);
  for (const std::string& target : {std::string("/page/../x"),
                                    std::string("/.."),
                                    std::string("/api/runs/%2e%2e/x"),
                                    std::string("/api/runs/.%2E/x"),
                                    std::string("/api/runs/a%2fb"),
                                    std::string("/a%5cb"),
                                    std::string("/a\\b"),
                                    std::string("/a%00b"),
                                    std::string("/a%252e"),
                                    std::string("//etc"),
                                    std::string("/a//b"),
                                    std::string("etc"),
                                    std::string(),
                                    std::string("http://127.0.0.1/"),
                                    std::string("*"),
                                    std::string("/a b"),
                                    std::string("/\xc3\xa4"),
                                    std::string("/./a"),
                                    std::string("/a/."),
                                    nul}) {
    RequestFacts facts = plain();
    facts.target = target;
    EXPECT_EQ(mayRead(kRules, facts).refusal, Refusal::kPath) << target;
  }
  RequestFacts facts = plain();
  const std::string long_one = "/" + std::string(2048, 'a');
  facts.target = long_one;
  EXPECT_EQ(mayRead(kRules, facts).refusal, Refusal::kOversized);
  facts.target = "/api/compare?runs=a,b%2c..%2f";  // the query may contain encoded separators
  EXPECT_TRUE(mayRead(kRules, facts).yes());
  facts.target = "/api/runs/abp..old/a..svg";
  EXPECT_TRUE(mayRead(kRules, facts).yes());
}

TEST(HttpGuard, ControlNeedsPostAndReadingNeedsGetOrHead) {
  for (const char* method :
       {"GET", "HEAD", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT", "PATCH"}) {
    for (const char* target : {"/api/request", "/api/wish", "/api/check", "/api/start"}) {
      RequestFacts facts = controlRequest();
      facts.method = method;
      facts.target = target;
      EXPECT_EQ(mayRead(kRules, facts).status, 405) << method << target;
    }
  }
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS"}) {
    RequestFacts facts = plain();
    facts.method = method;
    EXPECT_EQ(mayRead(kRules, facts).status, 405) << method;
  }
  RequestFacts facts = controlRequest();
  EXPECT_TRUE(mayRead(kRules, facts).yes());
  facts.target = "/api/request?x";
  EXPECT_FALSE(mayRead(kRules, facts).yes());
  facts = plain();
  facts.method = "HEAD";
  EXPECT_TRUE(mayRead(kRules, facts).yes());
}

TEST(HttpGuard, ControlNeedsTheTokenAndThisHost) {
  EXPECT_TRUE(mayControl(kRules, controlRequest()).yes());
  for (const char* token : {"", "0", "0123456789abcdeg", "0123456789abcdef0", "0123456789ABCDEF"}) {
    RequestFacts facts = controlRequest();
    facts.token = token;
    EXPECT_EQ(mayControl(kRules, facts).refusal, Refusal::kToken) << token;
  }
  RequestFacts elsewhere = controlRequest();
  elsewhere.peer = "192.168.1.9";
  EXPECT_EQ(mayControl(kRules, elsewhere).refusal, Refusal::kToken);
  GuardRules open = kRules;
  open.control_from_elsewhere = true;
  EXPECT_TRUE(mayControl(open, elsewhere).yes());
  elsewhere.token = "";
  EXPECT_FALSE(mayControl(open, elsewhere).yes());
  GuardRules without = kRules;
  without.token.clear();
  RequestFacts empty = controlRequest();
  empty.token = "";
  EXPECT_EQ(mayControl(without, empty).refusal, Refusal::kToken);
}

TEST(HttpGuard, RecognizesLoopbackAddresses) {
  for (const char* address : {"127.0.0.1", "127.9.9.9", "::1", "::ffff:127.0.0.1"}) {
    EXPECT_TRUE(isLoopback(address)) << address;
  }
  for (const char* address : {"", "128.0.0.1", "10.127.0.1", "::2", "fe80::1", "::ffff:10.0.0.1"}) {
    EXPECT_FALSE(isLoopback(address)) << address;
  }
}

}  // namespace
}  // namespace lab::dashboard
