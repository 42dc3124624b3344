#include "tracker_svc/views/debug_view.hpp"

#include <gtest/gtest.h>

#include <asio.hpp>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/support/wait_until.hpp"

namespace lab::tracker {
namespace {

using asio::ip::tcp;

/// A browser, of sorts.
class Browser {
 public:
  Browser(int port, const std::string& request) {
    socket_.open(tcp::v4());
    socket_.set_option(asio::socket_base::receive_buffer_size(4096));
    socket_.connect({asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(port)});
    asio::write(socket_, asio::buffer(request));
  }

  /// Everything until the server closes.
  std::string all() {
    std::error_code end;
    asio::read(socket_, asio::dynamic_buffer(text_), end);
    return text_;
  }

  /// Up to and with `mark`, which is taken out of what is still to read.
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

/// Whether the view comes to want a picture. (A minute is for machines that stand still.)
bool becomesWanted(const DebugView& view) {
  return waitUntil([&] { return view.wanted(); }, std::chrono::minutes(1));
}

RgbImage flat(int width, int height) { return {width, height}; }

/// A picture that cannot be compressed well.
RgbImage grain(int width, int height) {
  RgbImage image(width, height);
  std::uint32_t state = 1;
  for (std::uint8_t& value : image.pixels) {
    state = state * 1664525U + 1013904223U;
    value = static_cast<std::uint8_t>(state >> 24U);
  }
  return image;
}

TEST(DebugView, ServesItsPage) {
  const DebugView view(0);
  Browser browser(view.port(), get("/"));

  const std::string answer = browser.all();

  EXPECT_EQ(answer.substr(0, 15), "HTTP/1.1 200 OK");
  EXPECT_NE(answer.find("/stream.mjpg"), std::string::npos);
}

TEST(DebugView, WantsNothingWhileNobodyLooks) {
  DebugView view(0);
  Browser browser(view.port(), get("/"));
  (void)browser.all();
  bool painted = false;

  view.show([&painted] {
    painted = true;
    return flat(4, 4);
  });

  EXPECT_FALSE(view.wanted());
  EXPECT_FALSE(painted);
}

TEST(DebugView, GivesOnePngToWhoAsksForAFrame) {
  DebugView view(0);
  Browser browser(view.port(), get("/frame.png?now"));
  ASSERT_TRUE(becomesWanted(view));

  view.show([] { return flat(40, 30); });

  const std::string answer = browser.all();
  EXPECT_NE(answer.find("Content-Type: image/png"), std::string::npos);
  EXPECT_NE(answer.find("\r\n\r\n\x89PNG"), std::string::npos);
}

TEST(DebugView, GivesOneJpegToWhoAsksForThat) {
  DebugView view(0);
  Browser browser(view.port(), get("/frame.jpg"));
  ASSERT_TRUE(becomesWanted(view));

  view.show([] { return flat(40, 30); });

  const std::string answer = browser.all();
  EXPECT_NE(answer.find("Content-Type: image/jpeg"), std::string::npos);
  EXPECT_NE(answer.find("\r\n\r\n\xff\xd8"), std::string::npos);
}

TEST(DebugView, StreamsOnePictureAfterTheOther) {
  DebugView view(0);
  Browser browser(view.port(), get("/stream.mjpg"));
  EXPECT_NE(browser.until("\r\n\r\n").find("multipart/x-mixed-replace"), std::string::npos);

  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(becomesWanted(view));
    view.show([] { return flat(40, 30); });
    (void)browser.until("Content-Type: image/jpeg");
    EXPECT_EQ(browser.until("\r\n--picture\r\n").substr(0, 18), "\r\nContent-Length: ");
  }
}

TEST(DebugView, AsksForOnePictureOnly) {
  DebugView view(0);
  const Browser browser(view.port(), get("/frame.png"));
  ASSERT_TRUE(becomesWanted(view));

  view.show([] { return flat(4, 4); });

  EXPECT_FALSE(view.wanted());
}

TEST(DebugView, IsNotHeldUpByAViewerWhoDoesNotRead) {
  DebugView view(0);
  const Browser frozen(view.port(), get("/stream.mjpg"));
  ASSERT_TRUE(becomesWanted(view));
  view.show([] { return grain(2400, 2000); });  // far more than the sockets between hold

  for (int i = 0; i < 3; ++i) {
    Browser other(view.port(), get("/frame.png"));
    ASSERT_TRUE(becomesWanted(view));
    view.show([] { return flat(8, 8); });
    EXPECT_NE(other.all().find("PNG"), std::string::npos);
  }
}

TEST(DebugView, RefusesWhatItDoesNotHave) {
  const DebugView view(0);

  EXPECT_NE(Browser(view.port(), get("/etc/passwd")).all().find("404"), std::string::npos);
  EXPECT_NE(Browser(view.port(), "POST / HTTP/1.1\r\n\r\n").all().find("405"), std::string::npos);
  for (const char* ours : {"127.0.0.1", "localhost", "localhost:9000"}) {
    EXPECT_NE(Browser(view.port(), get("/", ours)).all().find("200 OK"), std::string::npos);
  }
  EXPECT_NE(Browser(view.port(), "GET / HTTP/1.0\r\n\r\n").all().find("200 OK"), std::string::npos);
  // A name that somebody else's name server leads here.
  for (const char* foreign : {"evil.example", "localhost.evil.example", "evil.example:8080"}) {
    EXPECT_NE(Browser(view.port(), get("/frame.png", foreign)).all().find("403"),
              std::string::npos);
  }
}

TEST(DebugView, SaysThatItsPortIsTaken) {
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

TEST(DebugView, EndsWhileSomebodyLooks) {
  auto view = std::make_unique<DebugView>(0);
  Browser browser(view->port(), get("/stream.mjpg"));
  (void)browser.until("\r\n\r\n");

  view.reset();

  EXPECT_EQ(browser.all().find("image/jpeg"), std::string::npos);
}

}  // namespace
}  // namespace lab::tracker
