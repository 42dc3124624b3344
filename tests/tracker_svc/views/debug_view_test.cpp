#include "tracker_svc/views/debug_view.hpp"

#include <gtest/gtest.h>

#include <asio.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/support/wait_until.hpp"

namespace lab::tracker {
namespace {

using asio::ip::tcp;

/// An HTTP client.
class Client {
 public:
  Client(int port, const std::string& request) {
    socket_.open(tcp::v4());
    socket_.set_option(asio::socket_base::receive_buffer_size(4096));
    socket_.connect({asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(port)});
    asio::write(socket_, asio::buffer(request));
  }

  /// Everything until the server closes the connection.
  std::string all() {
    std::error_code end;
    asio::read(socket_, asio::dynamic_buffer(text_), end);
    return text_;
  }

  /// Reads up to and including `mark` and removes that part from the buffer.
  std::string until(const std::string& mark) {
    const std::size_t length = asio::read_until(socket_, asio::dynamic_buffer(text_), mark);
    std::string part = text_.substr(0, length);
    text_.erase(0, length);
    return part;
  }

 private:
  asio::io_context io_;
  tcp::socket socket_{io_};
  std::string text_;
};

std::string get(const std::string& path, const std::string& host = "localhost:8080") {
  return "GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\n\r\n";
}

/// Waits until the view wants a picture. The timeout is long for slow machines.
bool becomesWanted(const DebugView& view) {
  return waitUntil([&] { return view.wanted(); }, std::chrono::minutes(1));
}

optics::RgbImage flat(int width, int height) { return {width, height}; }

/// A noisy picture, which cannot be compressed well.
optics::RgbImage grain(int width, int height) {
  optics::RgbImage image(width, height);
  std::uint32_t state = 1;
  for (std::uint8_t& value : image.pixels) {
    state = state * 1664525U + 1013904223U;
    value = static_cast<std::uint8_t>(state >> 24U);
  }
  return image;
}

TEST(DebugView, ServesItsPage) {
  const DebugView view(0);
  Client client(view.port(), get("/"));

  const std::string answer = client.all();

  EXPECT_EQ(answer.substr(0, 15), "HTTP/1.1 200 OK");
  EXPECT_NE(answer.find("/stream.mjpg"), std::string::npos);
}

TEST(DebugView, WantsNoPictureWithoutViewers) {
  DebugView view(0);
  Client client(view.port(), get("/"));
  (void)client.all();
  bool painted = false;

  view.show([&painted] {
    painted = true;
    return flat(4, 4);
  });

  EXPECT_FALSE(view.wanted());
  EXPECT_FALSE(painted);
}

TEST(DebugView, SendsOnePngPerRequest) {
  DebugView view(0);
  Client client(view.port(), get("/frame.png?now"));
  ASSERT_TRUE(becomesWanted(view));

  view.show([] { return flat(40, 30); });

  const std::string answer = client.all();
  EXPECT_NE(answer.find("Content-Type: image/png"), std::string::npos);
  EXPECT_NE(answer.find("\r\n\r\n\x89PNG"), std::string::npos);
}

TEST(DebugView, SendsOneJpegPerRequest) {
  DebugView view(0);
  Client client(view.port(), get("/frame.jpg"));
  ASSERT_TRUE(becomesWanted(view));

  view.show([] { return flat(40, 30); });

  const std::string answer = client.all();
  EXPECT_NE(answer.find("Content-Type: image/jpeg"), std::string::npos);
  EXPECT_NE(answer.find("\r\n\r\n\xff\xd8"), std::string::npos);
}

TEST(DebugView, StreamsOnePictureAfterTheOther) {
  DebugView view(0);
  Client client(view.port(), get("/stream.mjpg"));
  EXPECT_NE(client.until("\r\n\r\n").find("multipart/x-mixed-replace"), std::string::npos);

  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(becomesWanted(view));
    view.show([] { return flat(40, 30); });
    (void)client.until("Content-Type: image/jpeg");
    EXPECT_EQ(client.until("\r\n--picture\r\n").substr(0, 18), "\r\nContent-Length: ");
  }
}

TEST(DebugView, WantsOnlyOnePicturePerStill) {
  DebugView view(0);
  const Client client(view.port(), get("/frame.png"));
  ASSERT_TRUE(becomesWanted(view));

  view.show([] { return flat(4, 4); });

  EXPECT_FALSE(view.wanted());
}

TEST(DebugView, IsNotDelayedByAViewerThatDoesNotRead) {
  DebugView view(0);
  Client frozen(view.port(), get("/stream.mjpg"));
  ASSERT_TRUE(becomesWanted(view));
  view.show([] { return grain(2400, 2000); });  // much larger than the buffers of the sockets
  // It does not read on. A viewer that comes earlier would get this picture, too, or none if the
  // encoding takes long.
  (void)frozen.until("Content-Type: image/jpeg");

  for (int i = 0; i < 3; ++i) {
    Client other(view.port(), get("/frame.png"));
    ASSERT_TRUE(becomesWanted(view));
    view.show([] { return flat(8, 8); });
    EXPECT_NE(other.all().find("PNG"), std::string::npos);
  }
}

TEST(DebugView, RefusesUnknownPathsMethodsAndHosts) {
  const DebugView view(0);

  EXPECT_NE(Client(view.port(), get("/etc/passwd")).all().find("404"), std::string::npos);
  EXPECT_NE(Client(view.port(), "POST / HTTP/1.1\r\n\r\n").all().find("405"), std::string::npos);
  for (const char* ours : {"127.0.0.1", "localhost", "localhost:9000"}) {
    EXPECT_NE(Client(view.port(), get("/", ours)).all().find("200 OK"), std::string::npos);
  }
  EXPECT_NE(Client(view.port(), "GET / HTTP/1.0\r\n\r\n").all().find("200 OK"), std::string::npos);
  // Host names with which DNS rebinding could lead here.
  for (const char* foreign : {"evil.example", "localhost.evil.example", "evil.example:8080"}) {
    EXPECT_NE(Client(view.port(), get("/frame.png", foreign)).all().find("403"), std::string::npos);
  }
}

/// As a browser sends it.
std::string fetched(const std::string& path, const std::string& site, const std::string& mode) {
  return "GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1:8081\r\nSec-Fetch-Site: " + site +
         "\r\nSec-Fetch-Mode: " + mode + "\r\n\r\n";
}

TEST(DebugView, ShowsNothingToPagesOfOtherSites) {
  DebugView view(0);

  for (const char* site : {"cross-site", "same-site"}) {
    for (const char* path : {"/frame.jpg", "/frame.png", "/stream.mjpg", "/"}) {
      EXPECT_EQ(Client(view.port(), fetched(path, site, "no-cors")).all().substr(9, 3), "403")
          << path << " for " << site;
    }
    EXPECT_EQ(Client(view.port(), fetched("/frame.png", site, "navigate")).all().substr(9, 3),
              "403");
    // The user follows a link.
    EXPECT_EQ(Client(view.port(), fetched("/", site, "navigate")).all().substr(9, 3), "200");
  }
  EXPECT_FALSE(view.wanted());
  const std::string page = Client(view.port(), fetched("/", "none", "navigate")).all();
  EXPECT_EQ(page.substr(9, 3), "200");
  EXPECT_NE(page.find("Cross-Origin-Resource-Policy: same-origin\r\n"), std::string::npos);
  EXPECT_NE(page.find("Content-Security-Policy: frame-ancestors 'none'\r\n"), std::string::npos);
}

TEST(DebugView, ShowsItsOwnPageThePictures) {
  DebugView view(0);
  Client client(view.port(), fetched("/frame.jpg", "same-origin", "no-cors"));
  ASSERT_TRUE(becomesWanted(view));

  view.show([] { return flat(40, 30); });

  const std::string answer = client.all();
  EXPECT_EQ(answer.substr(9, 3), "200");
  EXPECT_NE(answer.find("Cross-Origin-Resource-Policy: same-origin\r\n"), std::string::npos);
}

TEST(DebugView, ThrowsIfItsPortIsTaken) {
  const DebugView first(0);
  try {
    const DebugView second(first.port());
    FAIL() << "two servers on one port";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("127.0.0.1:" + std::to_string(first.port())),
              std::string::npos)
        << error.what();
  }
}

TEST(DebugView, EndsWhileAViewerIsConnected) {
  auto view = std::make_unique<DebugView>(0);
  Client client(view->port(), get("/stream.mjpg"));
  (void)client.until("\r\n\r\n");

  view.reset();

  EXPECT_EQ(client.all().find("image/jpeg"), std::string::npos);
}

}  // namespace
}  // namespace lab::tracker
