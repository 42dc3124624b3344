#include "common/http/http_server.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>

#include "tests/support/raw_http_client.hpp"

namespace lab::http_server_test {
namespace {

using dashboard::exchange;
using dashboard::RawClient;
using dashboard::statusOf;
using namespace std::chrono_literals;

/// A server that returns the body of each request.
class EchoServer {
 public:
  EchoServer() {
    server_.open(
        [this](HttpExchange& exchange) {
          if (exchange.request().path() == "/throw") throw std::runtime_error("test");
          server_.identify(exchange);
          HttpResponse response;
          if (exchange.readBody(100) != HttpExchange::Result::kOk) response.status = 413;
          response.setBody("text/plain", exchange.request().body);
          exchange.respond(response);
        },
        [](RequestFault fault) {
          HttpResponse response;
          response.status = lab::statusOf(fault);
          return response;
        });
  }

  [[nodiscard]] int port() const { return server_.port(); }

 private:
  HttpServer server_{{.owner = "test", .address = "127.0.0.1"}};
};

TEST(HttpServer, ReadsBodiesWithLengthAndInChunks) {
  const EchoServer server;

  const std::string plain =
      exchange(server.port(), "POST / HTTP/1.1\r\nContent-Length: 5\r\n\r\nhello");
  const std::string chunked = exchange(server.port(),
                                       "POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n"
                                       "3\r\nhel\r\n2\r\nlo\r\n0\r\n\r\n");

  EXPECT_TRUE(plain.ends_with("\r\n\r\nhello")) << plain;
  EXPECT_TRUE(chunked.ends_with("\r\n\r\nhello")) << chunked;
}

TEST(HttpServer, RefusesBodiesAboveTheLimit) {
  const EchoServer server;

  EXPECT_EQ(statusOf(exchange(server.port(), "POST / HTTP/1.1\r\nContent-Length: 101\r\n\r\n")),
            "413");
  EXPECT_EQ(statusOf(exchange(server.port(),
                              "POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n65\r\n" +
                                  std::string(101, 'x') + "\r\n0\r\n\r\n")),
            "413");
}

TEST(HttpServer, AcceptsARequestInSmallPieces) {
  const EchoServer server;
  RawClient client(server.port());

  for (const char letter : std::string("POST / HTTP/1.1\r\nContent-Length: 2\r\n\r\nab")) {
    client.send({&letter, 1});
  }

  EXPECT_TRUE(client.receiveAll().ends_with("\r\n\r\nab"));
}

TEST(HttpServer, RespondsWith500AfterAnException) {
  const EchoServer server;
  EXPECT_EQ(statusOf(exchange(server.port(), "GET /throw HTTP/1.1\r\n\r\n")), "500");
}

TEST(HttpGet, ReturnsTheBodyAndNothingOnErrors) {
  int port = 0;
  {
    const EchoServer server;
    port = server.port();
    EXPECT_EQ(httpGet(port, "/", 5s, 1000), "");
    EXPECT_EQ(httpGet(port, "/throw", 5s, 1000), std::nullopt);
    EXPECT_EQ(httpGet(port, "/", 5s, 10), std::nullopt) << "the response is longer than the limit";
  }
  EXPECT_EQ(httpGet(port, "/", 1s, 1000), std::nullopt) << "nothing listens there";
}

TEST(HttpRequest, DecodesPathAndQuery) {
  HttpRequest request;
  request.target = "/a%20b+c%zz?x=1&name=a%2Cb+c&empty&x=2#end";

  EXPECT_EQ(request.path(), "/a b+c%zz");
  EXPECT_EQ(request.query("name"), "a,b c");
  EXPECT_EQ(request.query("x"), "1");
  EXPECT_EQ(request.query("empty"), "");
  EXPECT_EQ(request.query("none"), "");
}

TEST(HttpRequest, FindsHeadersInUpperAndLowerCase) {
  HttpRequest request;
  request.headers = {{"Host", "a"}, {"HOST", "b"}};

  EXPECT_EQ(request.header("host"), "a");
  EXPECT_EQ(request.headerCount("Host"), 2U);
  EXPECT_EQ(request.header("Origin"), "");
}

}  // namespace
}  // namespace lab::http_server_test
