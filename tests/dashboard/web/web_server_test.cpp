#include "dashboard/web/web_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ifaddrs.h>
#include <net/if.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "tests/dashboard/web/web_fixture.hpp"

namespace lab::dashboard {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

TEST_F(WebTest, ServesThePageWithSecurityHeaders) {
  start();
  const std::string page = send("GET", "/");
  EXPECT_THAT(page, AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("<html")));
  for (const char* header :
       {"Content-Security-Policy: default-src 'self';", "X-Content-Type-Options: nosniff",
        "X-Frame-Options: DENY", "Referrer-Policy: no-referrer",
        "Cross-Origin-Resource-Policy: same-origin", "Content-Type: text/html"}) {
    EXPECT_THAT(page, HasSubstr(header));
  }
  EXPECT_THAT(page, Not(HasSubstr("Access-Control-")));
  EXPECT_THAT(send("GET", "/page/d3.min.js"), HasSubstr("Content-Type: text/javascript"));
  EXPECT_THAT(send("GET", "/page/d3_licence.txt"), HasSubstr("Michael Bostock"));
  EXPECT_EQ(statusOf(send("GET", "/page/none.js")), "404");
  const std::string head = send("HEAD", "/");
  EXPECT_THAT(head, AllOf(StartsWith("HTTP/1.1 200"), EndsWith("\r\n\r\n")));
}

TEST_F(WebTest, SendsAnUnchangedFileOnlyOnce) {
  start();
  const std::string first = send("GET", "/page/d3.min.js");
  const std::size_t at = first.find("ETag: ");
  ASSERT_NE(at, std::string::npos);
  const std::string tag = first.substr(at + 6, first.find('\r', at) - at - 6);
  EXPECT_EQ(statusOf(send("GET", "/page/d3.min.js", "If-None-Match: " + tag + "\r\n")), "304");
  EXPECT_EQ(statusOf(send("GET", "/page/d3.min.js", "If-None-Match: \"0\"\r\n")), "200");
}

TEST_F(WebTest, StreamsAllTopicsFirstAndThenChanges) {
  hub_.publish("lab", "{\"name\":\"abp\"}");
  hub_.publish(".light", "raster");
  start();
  RawClient viewer(server_->port());
  viewer.send(request("GET", "/api/stream"));
  EXPECT_THAT(viewer.receive("abp"), AllOf(HasSubstr("Content-Type: text/event-stream"),
                                           HasSubstr("event: lab\ndata: {\"name\":\"abp\"}\n\n")));
  EXPECT_EQ(server_->viewers(), 1);
  hub_.publish("frame", "two\nlines");
  EXPECT_THAT(viewer.receive("lines\n\n"), HasSubstr("event: frame\ndata: two\ndata: lines\n\n"));
  EXPECT_THAT(viewer.receive("lines\n\n"), Not(HasSubstr("raster")));
  EXPECT_THAT(send("GET", "/api/light"), EndsWith("\r\n\r\nraster"));
}

TEST_F(WebTest, NoticesThatAViewerHasGone) {
  start();
  {
    RawClient viewer(server_->port());
    viewer.send(request("GET", "/api/stream"));
    waitForViewers(1);
  }
  waitForViewers(0);
}

TEST_F(WebTest, PassesRequestsOnAndReturnsRefusals) {
  start();
  EXPECT_EQ(statusOf(control(R"({"request":"stop","reason":"smoke"})")), "202");
  ASSERT_THAT(lab_.requests(), SizeIs(1));
  EXPECT_EQ(std::get<StopRobots>(lab_.requests().front()).reason, "smoke");
  lab_.refuse("no script runs");
  EXPECT_THAT(control(R"({"request":"pause"})"),
              AllOf(StartsWith("HTTP/1.1 409"), EndsWith(R"({"error":"no script runs"})")));
}

TEST_F(WebTest, AcceptsTheFormerPathAndKey) {
  start();
  EXPECT_EQ(statusOf(send("POST", "/api/wish", token(), R"({"wish":"stop","reason":"old page"})")),
            "202");
  ASSERT_THAT(lab_.requests(), SizeIs(1));
  EXPECT_EQ(std::get<StopRobots>(lab_.requests().front()).reason, "old page");
  EXPECT_EQ(statusOf(send("POST", "/api/wish", "", R"({"wish":"release_stop"})")), "403");
}

TEST_F(WebTest, ReportsTheClientsPermissions) {
  start();
  EXPECT_THAT(send("GET", "/api/me", token()), HasSubstr(R"({"control":true,"why":""})"));
  EXPECT_THAT(send("GET", "/api/me"), HasSubstr(R"({"control":false,"why":"the token is missing)"));
  EXPECT_EQ(server_->refusals().token, 0);
}

TEST_F(WebTest, PassesQueriesOn) {
  start();
  EXPECT_THAT(send("GET", "/api/ask/robot?which=a%20b"), EndsWith(R"(["robot","a b"])"));
  EXPECT_EQ(statusOf(send("GET", "/api/ask/nothing")), "404");
}

TEST_F(WebTest, RefusedRequestsDoNotReachTheLab) {
  start();
  const std::string body = R"({"request":"release_stop"})";
  const auto post = [&](const std::string& extra) {
    return send("POST", "/api/request", extra, body);
  };
  EXPECT_EQ(statusOf(post("")), "403");
  EXPECT_EQ(statusOf(post("X-Lab-Token: 0123456789abcdef0123456789abcdee\r\n")), "403");
  EXPECT_EQ(server_->refusals().token, 2);
  EXPECT_EQ(statusOf(post(token() + "Origin: http://evil.example\r\n")), "403");
  EXPECT_EQ(statusOf(post(token() + "Origin: null\r\n")), "403");
  EXPECT_EQ(statusOf(post(token() + "Sec-Fetch-Site: cross-site\r\n")), "403");
  EXPECT_EQ(server_->refusals().origin, 3);
  for (const char* method : {"GET", "HEAD", "OPTIONS", "PUT", "DELETE", "TRACE"}) {
    EXPECT_EQ(statusOf(send(method, "/api/request?request=stop", token())),
              std::string(method) == "GET" || std::string(method) == "HEAD" ? "404" : "405");
    EXPECT_EQ(statusOf(send(method, "/api/request", token())), "405") << method;
  }
  const std::string rebound =
      "POST /api/request HTTP/1.1\r\nHost: evil.example:" + std::to_string(server_->port()) +
      "\r\n" + token() + "Content-Type: application/json\r\nContent-Length: 23\r\n\r\n" + body;
  EXPECT_EQ(statusOf(exchange(server_->port(), rebound)), "403");
  EXPECT_EQ(statusOf(exchange(server_->port(), "GET / HTTP/1.1\r\n\r\n")), "403");
  EXPECT_EQ(server_->refusals().host, 2);
  EXPECT_THAT(lab_.requests(), IsEmpty());
}

TEST_F(WebTest, RefusesEveryFormOfPathTraversal) {
  start();
  const std::vector<std::string> targets{"/page/../../etc/passwd",
                                         "/page/%2e%2e/%2e%2e/etc/passwd",
                                         "/page/..%2f..%2fetc/passwd",
                                         "/page/%252e%252e%252fetc",
                                         "/page/..\\..\\etc",
                                         "/page/..%5c..%5cetc",
                                         "//etc/passwd",
                                         "/api/runs/../../etc/passwd",
                                         "/api/runs/%2e%2e/x.svg",
                                         "/api/runs/a/%00.svg",
                                         "/page//x"};
  for (const std::string& target : targets) {
    EXPECT_EQ(statusOf(send("GET", target)), "404") << target;
  }
  EXPECT_EQ(server_->refusals().path, static_cast<std::int64_t>(targets.size()));
}

TEST_F(WebTest, RefusesLargeRequests) {
  start();
  const auto raw = [&](const std::string& text) {
    return statusOf(exchange(server_->port(), text));
  };
  EXPECT_EQ(statusOf(send("GET", "/" + std::string(5000, 'a'))), "414");
  EXPECT_EQ(raw("GET /" + std::string(100'000, 'a')), "431");
  EXPECT_EQ(statusOf(send("GET", "/", "X: " + std::string(20'000, 'a') + "\r\n")), "431");
  std::string many;
  for (int i = 0; i < 2000; ++i) many += "X-" + std::to_string(i) + ": 1\r\n";
  EXPECT_EQ(statusOf(send("GET", "/", many)), "431");
  EXPECT_EQ(statusOf(control(R"({"request":"mark","text":")" + std::string(70'000, 'a') + "\"}")),
            "413");
  EXPECT_EQ(statusOf(send("GET", "/", "Content-Length: 1\r\n")), "413");
  EXPECT_EQ(server_->refusals().oversized, 6);
  EXPECT_EQ(statusOf(control(R"({"request":"mark","text":")" + std::string(60'000, 'a') + "\"}")),
            "400");
  EXPECT_THAT(lab_.requests(), IsEmpty());
}

TEST_F(WebTest, RefusesMalformedRequests) {
  start();
  const std::string host = "Host: 127.0.0.1\r\n";
  const std::string json = "Content-Type: application/json\r\n";
  const std::string body = R"({"request":"release_stop"})";
  const std::string post = "POST /api/request HTTP/1.1\r\n" + host + token();
  const std::vector<std::string> texts{
      "garbage\r\n\r\n",
      "\r\n\r\n",
      "GET\r\n\r\n",
      "GET / HTTP/9.9\r\n" + host + "\r\n",
      "\x16\x03\x01\x02\r\n\r\n",
      std::string("\0\0\0\r\n\r\n", 7),
      post + json + "\r\n" + body,  // no Content-Length
      post + json + "Content-Length: 23\r\nContent-Length: 23\r\n\r\n" + body,
      post + json + "Content-Length: -1\r\n\r\n" + body,
      post + json + "Content-Length: 0x17\r\n\r\n",
      post + json + "Transfer-Encoding: chunked\r\n\r\n17\r\n" + body + "\r\n0\r\n\r\n",
      post + json + "Content-Encoding: gzip\r\nContent-Length: 23\r\n\r\n" + body,
      post + "Content-Length: 23\r\n\r\n" +
          body,  // no type: an HTML form of another site could send it
      post + "Content-Type: text/plain\r\nContent-Length: 23\r\n\r\n" + body,
      post + json + "Content-Length: 5\r\n\r\n{\"wi\"",
      post + json + "Content-Length: 2\r\n\r\n{}"};
  for (const std::string& text : texts) {
    const std::int64_t before = server_->refusals().malformed;
    EXPECT_EQ(statusOf(exchange(server_->port(), text)).front(), '4') << text;
    EXPECT_EQ(server_->refusals().malformed, before + 1) << text;
  }
  EXPECT_THAT(lab_.requests(), IsEmpty());
}

TEST_F(WebTest, IgnoresASecondRequestOnAConnection) {
  start();
  const std::string hidden =
      request("POST", "/api/request", token(), R"({"request":"release_stop"})");
  const std::string answer = send("POST", "/api/request", "", hidden);
  EXPECT_EQ(statusOf(answer), "403");
  EXPECT_EQ(answer.find("HTTP/1.1", 1), std::string::npos);
  const std::string pair = request("GET", "/api/me") + hidden;
  EXPECT_EQ(exchange(server_->port(), pair).find("HTTP/1.1", 1), std::string::npos);
  EXPECT_THAT(lab_.requests(), IsEmpty());
}

TEST_F(WebTest, SurvivesTruncatedAndCorruptedRequests) {
  start();
  std::uint64_t state = 7;
  const auto random = [&state](std::uint64_t below) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    return (state >> 33) % below;
  };
  const std::string whole =
      request("POST", "/api/request", "Range: bytes=0-1,2-\r\nExpect: 100-continue\r\n",
              R"({"request":"release_stop"})");  // without the token
  for (int i = 0; i < 400; ++i) {
    std::string text = whole.substr(0, i % 3 == 0 ? random(whole.size()) : whole.size());
    for (std::uint64_t changes = random(6); changes > 0 && !text.empty(); --changes) {
      text[random(text.size())] = static_cast<char>(random(256));
    }
    RawClient client(server_->port());
    client.send(text);
    client.endSending();
    client.receiveAll();
  }
  EXPECT_EQ(statusOf(send("GET", "/")), "200");
  EXPECT_THAT(lab_.requests(), IsEmpty());
}

TEST_F(WebTest, SilentClientsDoNotBlockOthers) {
  start();
  std::vector<RawClient> silent;
  for (int i = 0; i < 150; ++i) {
    silent.emplace_back(server_->port());
    silent.back().send(i % 2 == 0 ? "" : "POST /api/request HTTP/1.1\r\nHost: ");
  }
  EXPECT_EQ(statusOf(control(R"({"request":"stop","reason":""})")), "202");
  EXPECT_THAT(lab_.requests(), SizeIs(1));
  EXPECT_EQ(server_->refusals().crowded, 0);
}

TEST_F(WebTest, DownloadsThatNobodyTakesDoNotBlockOthers) {
  std::filesystem::create_directories(options_.runs / "a");
  std::ofstream(options_.runs / "a/experiment.toml") << "";
  std::ofstream(options_.runs / "a/trajectories.csv") << std::string(4 << 20, '1');
  start();
  std::vector<RawClient> stalled;
  for (int i = 0; i < 200; ++i) {
    stalled.emplace_back(server_->port(), 4096);
    stalled.back().send(request("GET", "/api/runs/a/trajectories.csv"));
  }
  // Downloads count as stalled after a second, and end by themselves after ten.
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_TRUE(waitUntil([&] { return statusOf(send("GET", "/api/me")) == "200"; },
                        std::chrono::seconds(30)));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(8));
  // On a loaded machine, downloads that were accepted later are not stalled yet.
  EXPECT_TRUE(
      waitUntil([&] { return statusOf(control(R"({"wish":"stop","reason":""})")) == "202"; },
                std::chrono::seconds(30)));
}

/// A non-loopback address of this host, 0 if there is none.
in_addr_t externalAddress() {
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) return 0;
  in_addr_t found = 0;
  for (const ifaddrs* one = all; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
    if ((one->ifa_flags & IFF_LOOPBACK) != 0 || (one->ifa_flags & IFF_UP) == 0) continue;
    found = reinterpret_cast<const sockaddr_in*>(one->ifa_addr)->sin_addr.s_addr;
  }
  freeifaddrs(all);
  return found;
}

TEST_F(WebTest, OtherHostsLeavePlacesToThisOne) {
  const in_addr_t external = externalAddress();
  if (external == 0) GTEST_SKIP() << "this host has only loopback addresses";
  options_.address = "0.0.0.0";
  start();
  RawClient local(server_->port());
  std::vector<RawClient> others;
  for (int i = 0; i < 32; ++i) {
    others.emplace_back(server_->port(), 0, external);
    others.back().send(request("GET", "/api/stream"));
  }
  waitForViewers(32);
  for (int i = 0; i < 60; ++i) others.emplace_back(server_->port(), 0, external);
  // Connections are accepted in order: when this one is served, all others have been accepted.
  EXPECT_EQ(statusOf(control(R"({"request":"stop","reason":""})")), "202");
  local.send(request("GET", "/api/me"));
  EXPECT_EQ(statusOf(local.receiveAll()), "200");
}

TEST_F(WebTest, ManyStreamsLeaveAPlaceForAStop) {
  start();
  std::vector<RawClient> viewers;
  for (int i = 0; i < 32; ++i) {
    viewers.emplace_back(server_->port());
    viewers.back().send(request("GET", "/api/stream"));
  }
  waitForViewers(32);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(statusOf(send("GET", "/api/stream")), "503");
  EXPECT_EQ(server_->refusals().crowded, 8);
  EXPECT_EQ(statusOf(control(R"({"request":"stop","reason":""})")), "202");
  hub_.publish("stop", "stopping");
  for (RawClient& viewer : viewers) EXPECT_THAT(viewer.receive("stopping"), HasSubstr("stopping"));
  viewers.pop_back();
  waitForViewers(31);
  RawClient next(server_->port());
  next.send(request("GET", "/api/stream"));
  EXPECT_THAT(next.receive("stopping"), HasSubstr("stopping"));
}

TEST_F(WebTest, ASlowReaderSkipsStatesAndDelaysNoOther) {
  start();
  RawClient slow(server_->port(), 4096);
  slow.send(request("GET", "/api/stream"));
  waitForViewers(1);
  RawClient quick(server_->port());
  quick.send(request("GET", "/api/stream"));
  waitForViewers(2);
  const std::string filling(20'000, 'x');
  constexpr int kFrames = 100;
  for (int i = 0; i < kFrames; ++i) {
    const std::string number = "<" + std::to_string(i) + ">";
    hub_.publish("frame", number + filling);
    quick.receive(number);
  }
  const auto frames = [](const std::string& text) {
    int count = 0;
    for (std::size_t at = 0; (at = text.find("event: frame", at)) != std::string::npos; ++at)
      ++count;
    return count;
  };
  EXPECT_EQ(frames(quick.receive("<99>")), kFrames);
  const std::string& text = slow.receive("<99>");
  EXPECT_THAT(text, HasSubstr("<99>"));
  EXPECT_LT(frames(text), kFrames / 2);
}

TEST_F(WebTest, EndsWithStreamsAndSilentClientsOpen) {
  start();
  std::vector<RawClient> clients;
  for (int i = 0; i < 20; ++i) {
    clients.emplace_back(server_->port());
    if (i % 2 == 0) clients.back().send(request("GET", "/api/stream"));
  }
  waitForViewers(10);
  server_.reset();
  for (RawClient& client : clients) client.receiveAll();
}

TEST_F(WebTest, TakesTheNextFreePort) {
  start();
  options_.port = server_->port();
  RecordingLab lab;
  const WebServer second(options_, hub_, lab);
  EXPECT_GT(second.port(), server_->port());
  EXPECT_LT(second.port(), server_->port() + 100);
  EXPECT_EQ(second.address(),
            "http://127.0.0.1:" + std::to_string(second.port()) + "/#token=" + kToken);
}

TEST_F(WebTest, CanUseTheSamePortAgainAtOnce) {
  start();
  EXPECT_EQ(statusOf(send("GET", "/")), "200");
  options_.port = server_->port();
  server_.reset();
  start();
  EXPECT_EQ(server_->port(), options_.port);
}

TEST_F(WebTest, ThrowsIfItCannotListen) {
  for (const char* address : {"localhost", "", "192.0.2.1", "300.1.1.1"}) {
    options_.address = address;
    EXPECT_THROW(start(), std::runtime_error) << address;
  }
}

TEST(NewToken, Has128BitsAndDiffersEachTime) {
  const std::string token = newToken();
  EXPECT_EQ(token.size(), 32U);
  EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(token, newToken());
}

}  // namespace
}  // namespace lab::dashboard
