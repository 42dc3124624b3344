#include "dashboard/web/camera_picture.hpp"

#include <httplib.h>

#include <atomic>
#include <thread>

namespace lab::dashboard {
namespace {

using namespace std::chrono_literals;

/// As the tracker's debug view.
class PictureServer {
 public:
  PictureServer() {
    server_.Get("/frame.jpg", [this](const httplib::Request&, httplib::Response& response) {
      response.set_content(good ? "\xff\xd8picture" : "no picture", "image/jpeg");
    });
    port = server_.bind_to_any_port("127.0.0.1");
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::sleep_for(1ms);
  }
  ~PictureServer() {
    server_.stop();
    thread_.join();
  }

  int port = 0;
  std::atomic<bool> good = true;

 private:
  httplib::Server server_;
  std::thread thread_;
};

TEST(CameraPicture, IsThePictureThatTheTrackerShows) {
  PictureServer tracker;
  CameraPicture picture(tracker.port);
  const CameraPicture::Text first = picture.newest();
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(*first, "\xff\xd8picture");
  tracker.good = false;  // what is no JPEG is not passed on
  while (picture.newest() != nullptr) std::this_thread::sleep_for(5ms);
  tracker.good = true;
  while (picture.newest() == nullptr) std::this_thread::sleep_for(5ms);
}

TEST(CameraPicture, IsNoneWhereNobodyListens) {
  int port = 0;
  {
    const PictureServer gone;
    port = gone.port;
  }
  EXPECT_EQ(CameraPicture(port).newest(), nullptr);
}

}  // namespace
}  // namespace lab::dashboard
