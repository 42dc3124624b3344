#include "tracker_svc/views/debug_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <asio.hpp>
#include <atomic>
#include <cctype>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

namespace lab::tracker {
namespace {

using asio::ip::tcp;
using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

constexpr auto kPace = 50ms;         // between two pictures
constexpr auto kPatience = 10s;      // with a viewer who does not read, or does not ask
constexpr auto kStillPatience = 3s;  // for a picture to come
constexpr std::size_t kMostViewers = 8;
constexpr std::size_t kMostRequest = 8192;  // bytes

constexpr std::string_view kPage =
    "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Tracker</title>\n"
    "<style>body{margin:0;background:#111;color:#ccc;font:14px sans-serif}img{max-width:100%;"
    "display:block}p{margin:8px}a{color:#8cf}</style></head><body>\n"
    "<img src=\"/stream.mjpg\" alt=\"What the tracker sees\">\n"
    "<p>Green: both circles seen. Blue: a light edge crosses a circle. Orange: from one circle and "
    "the rim. Grey: not seen, expected there. Red: refused, with the reason and found/allowed. "
    "<a href=\"/frame.png\">One picture as PNG</a></p>\n</body></html>\n";
constexpr std::string_view kStreamHead =
    "HTTP/1.1 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=picture\r\n"
    "Cache-Control: no-store\r\nConnection: close\r\n\r\n--picture\r\n";

std::string responseHead(std::string_view status, std::string_view type, std::size_t length) {
  return fmt::format(
      "HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n"
      "Connection: close\r\n\r\n",
      status, type, length);
}

/// What is asked for: the path without its query, empty where it is no GET.
std::string pathOf(std::string_view request) {
  constexpr std::string_view kGet = "GET ";
  if (!request.starts_with(kGet)) return {};
  request.remove_prefix(kGet.size());
  return std::string(request.substr(0, request.find_first_of(" ?\r\n")));
}

/// Whether the request names this machine. A page from elsewhere whose name leads here names that.
bool isForUs(std::string_view request) {
  constexpr std::string_view kName = "\r\nhost:";
  const auto found = std::ranges::search(request, kName, [](char letter, char wanted) {
    return std::tolower(static_cast<unsigned char>(letter)) == wanted;
  });
  if (found.empty()) return true;  // HTTP/1.0: no browser
  std::string_view host = request.substr(static_cast<std::size_t>(found.end() - request.begin()));
  host = host.substr(0, host.find("\r\n"));
  host.remove_prefix(std::min(host.find_first_not_of(' '), host.size()));
  host = host.substr(0, host.find_first_of(": "));  // a tunnel may have another port
  return host == "127.0.0.1" || host == "localhost";
}

/// One connection.
struct Viewer {
  explicit Viewer(tcp::socket the_socket)
      : socket(std::move(the_socket)), deadline(socket.get_executor()) {}

  tcp::socket socket;
  asio::steady_timer deadline;
  std::string request;
  std::array<char, 256> ignored{};  ///< what a viewer of the stream still says
  std::string head;                 ///< of the part that is being written
  std::shared_ptr<const Bytes> body;
  bool stream = false;
  bool jpeg = false;   ///< of a still: it is wanted so
  bool ready = false;  ///< waits for a picture
};
using Handle = std::shared_ptr<Viewer>;

}  // namespace

struct DebugView::Server {
  explicit Server(int the_port);
  ~Server();

  void accept();
  void read(const Handle& viewer);
  void answer(const Handle& viewer);
  void say(const Handle& viewer, std::string_view status, std::string_view type,
           std::string_view text);
  void watchForEnd(const Handle& viewer);
  void limit(const Handle& viewer, std::chrono::steady_clock::duration patience);
  void drop(const Handle& viewer);
  void makeReady(const Handle& viewer);
  void refresh();
  void distribute();
  void send(const Handle& viewer, std::shared_ptr<const Bytes> picture);

  asio::io_context io{1};
  tcp::acceptor acceptor{io};
  asio::steady_timer pace{io};
  std::set<Handle> viewers;
  int port = 0;
  std::atomic<bool> wanted = false;
  std::mutex mutex;
  std::function<RgbImage()> newest;  ///< under the mutex
  std::thread thread;
};

DebugView::Server::Server(int the_port) {
  try {
    const tcp::endpoint place(asio::ip::address_v4::loopback(),
                              static_cast<std::uint16_t>(the_port));
    acceptor.open(place.protocol());
    acceptor.set_option(tcp::acceptor::reuse_address(true));
    acceptor.bind(place);
    acceptor.listen();
  } catch (const std::system_error& error) {
    throw std::runtime_error(
        fmt::format("debug view: 127.0.0.1:{} cannot be had ({}); choose another port", the_port,
                    error.code().message()));
  }
  port = acceptor.local_endpoint().port();
  accept();
  thread = std::thread([this] { io.run(); });
}

DebugView::Server::~Server() {
  io.stop();
  thread.join();
}

void DebugView::Server::accept() {
  acceptor.async_accept([this](const std::error_code& error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error) {
      const auto viewer = std::make_shared<Viewer>(std::move(socket));
      const bool full = viewers.size() >= kMostViewers;
      viewers.insert(viewer);
      limit(viewer, kPatience);
      if (full) {
        say(viewer, "503 Service Unavailable", "text/plain", "too many viewers\n");
      } else {
        read(viewer);
      }
      accept();
      return;
    }
    // Out of descriptors, say: not to be asked again at once.
    auto pause = std::make_shared<asio::steady_timer>(io, 1s);
    pause->async_wait([this, pause](const std::error_code& stopped) {
      if (!stopped) accept();
    });
  });
}

void DebugView::Server::read(const Handle& viewer) {
  asio::async_read_until(viewer->socket, asio::dynamic_buffer(viewer->request, kMostRequest),
                         "\r\n\r\n", [this, viewer](const std::error_code& error, std::size_t) {
                           if (error) {
                             drop(viewer);
                           } else {
                             answer(viewer);
                           }
                         });
}

void DebugView::Server::answer(const Handle& viewer) {
  const std::string path = pathOf(viewer->request);
  if (path.empty()) {
    say(viewer, "405 Method Not Allowed", "text/plain", "only GET\n");
  } else if (!isForUs(viewer->request)) {
    say(viewer, "403 Forbidden", "text/plain", "ask for localhost or 127.0.0.1\n");
  } else if (path == "/") {
    say(viewer, "200 OK", "text/html; charset=utf-8", kPage);
  } else if (path == "/frame.png" || path == "/frame.jpg") {
    viewer->jpeg = path == "/frame.jpg";
    limit(viewer, kStillPatience);
    makeReady(viewer);
  } else if (path == "/stream.mjpg") {
    viewer->stream = true;
    watchForEnd(viewer);
    asio::async_write(viewer->socket, asio::buffer(kStreamHead),
                      [this, viewer](const std::error_code& error, std::size_t) {
                        if (error) {
                          drop(viewer);
                        } else {
                          viewer->deadline.cancel();
                          makeReady(viewer);
                        }
                      });
  } else {
    say(viewer, "404 Not Found", "text/plain",
        "there is /, /frame.png, /frame.jpg and /stream.mjpg\n");
  }
}

void DebugView::Server::say(const Handle& viewer, std::string_view status, std::string_view type,
                            std::string_view text) {
  viewer->head = responseHead(status, type, text.size()).append(text);
  asio::async_write(viewer->socket, asio::buffer(viewer->head),
                    [this, viewer](const std::error_code&, std::size_t) { drop(viewer); });
}

void DebugView::Server::watchForEnd(const Handle& viewer) {
  viewer->socket.async_read_some(asio::buffer(viewer->ignored),
                                 [this, viewer](const std::error_code& error, std::size_t) {
                                   if (error) {
                                     drop(viewer);
                                   } else {
                                     watchForEnd(viewer);
                                   }
                                 });
}

void DebugView::Server::limit(const Handle& viewer, std::chrono::steady_clock::duration patience) {
  viewer->deadline.expires_after(patience);
  viewer->deadline.async_wait([this, viewer](const std::error_code& error) {
    if (error) return;
    if (viewer->ready && !viewer->stream) {
      viewer->ready = false;
      limit(viewer, kPatience);
      say(viewer, "503 Service Unavailable", "text/plain", "no picture comes from the camera\n");
    } else {
      drop(viewer);
    }
  });
}

void DebugView::Server::drop(const Handle& viewer) {
  std::error_code ignored;
  viewer->socket.shutdown(tcp::socket::shutdown_both, ignored);
  viewer->socket.close(ignored);
  viewer->deadline.cancel();
  viewer->ready = false;
  viewers.erase(viewer);
  refresh();
}

void DebugView::Server::makeReady(const Handle& viewer) {
  if (!viewers.contains(viewer)) return;
  viewer->ready = true;
  refresh();
}

void DebugView::Server::refresh() {
  const bool paced = std::chrono::steady_clock::now() >= pace.expiry();
  bool waiting = false;
  for (const Handle& viewer : viewers) waiting = waiting || viewer->ready;
  wanted = paced && waiting;
}

void DebugView::Server::distribute() {
  std::function<RgbImage()> paint;
  {
    const std::lock_guard lock(mutex);
    paint = std::exchange(newest, {});
  }
  // Two pictures shown before the first was asked for here: the later one is sent, and this is the
  // call of the other.
  if (!paint) return;
  RgbImage image;
  // Encoded for those who wait, once for each form.
  std::shared_ptr<const Bytes> png;
  std::shared_ptr<const Bytes> jpeg;
  const std::set<Handle> now = viewers;
  for (const Handle& viewer : now) {
    if (!viewer->ready) continue;
    const bool as_jpeg = viewer->stream || viewer->jpeg;
    std::shared_ptr<const Bytes>& picture = as_jpeg ? jpeg : png;
    try {
      if (image.pixels.empty()) image = paint();
      if (!picture) {
        picture = std::make_shared<Bytes>(as_jpeg ? jpegBytes(image) : pngBytes(image));
      }
      send(viewer, picture);
    } catch (const std::exception&) {
      drop(viewer);  // no memory, say: the tracker goes on without being looked at
    }
  }
  pace.expires_after(kPace);
  pace.async_wait([this](const std::error_code& error) {
    if (!error) refresh();
  });
}

void DebugView::Server::send(const Handle& viewer, std::shared_ptr<const Bytes> picture) {
  viewer->ready = false;
  viewer->body = std::move(picture);
  limit(viewer, kPatience);
  std::string_view tail;
  if (viewer->stream) {
    viewer->head =
        fmt::format("Content-Type: image/jpeg\r\nContent-Length: {}\r\n\r\n", viewer->body->size());
    tail = "\r\n--picture\r\n";
  } else {
    viewer->head =
        responseHead("200 OK", viewer->jpeg ? "image/jpeg" : "image/png", viewer->body->size());
  }
  const std::array<asio::const_buffer, 3> parts{asio::buffer(viewer->head),
                                                asio::buffer(*viewer->body), asio::buffer(tail)};
  asio::async_write(viewer->socket, parts,
                    [this, viewer](const std::error_code& error, std::size_t) {
                      if (error || !viewer->stream) {
                        drop(viewer);
                      } else {
                        viewer->deadline.cancel();
                        makeReady(viewer);
                      }
                    });
}

DebugView::DebugView(int port) : server_(std::make_unique<Server>(port)) {}

DebugView::~DebugView() = default;

int DebugView::port() const { return server_->port; }

bool DebugView::wanted() const { return server_->wanted; }

void DebugView::show(std::function<RgbImage()> paint) {
  if (!server_->wanted.exchange(false)) return;
  {
    const std::lock_guard lock(server_->mutex);
    server_->newest = std::move(paint);
  }
  asio::post(server_->io, [server = server_.get()] { server->distribute(); });
}

}  // namespace lab::tracker
