#include "dashboard/web/camera_picture.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "common/http/http_server.hpp"

namespace lab::dashboard {
namespace {

using namespace std::chrono_literals;

/// Stands in for the tracker's debug view.
class PictureServer {
 public:
  PictureServer() {
    server_.open(
        [this](HttpExchange& exchange) {
          HttpResponse response;
          if (exchange.request().path() != "/frame.jpg") response.status = 404;
          response.setBody("image/jpeg", good ? "\xff\xd8picture" : "no picture");
          exchange.respond(response);
        },
        [](RequestFault) { return HttpResponse(); });
  }

  [[nodiscard]] int port() const { return server_.port(); }

  std::atomic<bool> good = true;

 private:
  HttpServer server_{{.owner = "test", .address = "127.0.0.1"}};
};

TEST(CameraPicture, FetchesTheTrackersPicture) {
  PictureServer tracker;
  CameraPicture picture(tracker.port());
  const CameraPicture::Text first = picture.newest();
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(*first, "\xff\xd8picture");
  tracker.good = false;  // then the body is not a JPEG
  while (picture.newest() != nullptr) std::this_thread::sleep_for(5ms);
  tracker.good = true;
  while (picture.newest() == nullptr) std::this_thread::sleep_for(5ms);
}

TEST(CameraPicture, IsNullWithoutATracker) {
  int port = 0;
  {
    const PictureServer gone;
    port = gone.port();
  }
  EXPECT_EQ(CameraPicture(port).newest(), nullptr);
}

}  // namespace
}  // namespace lab::dashboard
