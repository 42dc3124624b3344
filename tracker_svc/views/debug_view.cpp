#include "tracker_svc/views/debug_view.hpp"

#include <fmt/format.h>

#include <chrono>
#include <string>
#include <string_view>
#include <utility>

#include "common/http/http_server.hpp"
#include "tracker_svc/views/frame_broker.hpp"

namespace lab::tracker {
namespace {

using namespace std::chrono_literals;

constexpr auto kStillTimeout = 3s;  // for a picture to come
constexpr std::string_view kPlainText = "text/plain";

constexpr std::string_view kPage =
    "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Tracker</title>\n"
    "<style>body{margin:0;background:#111;color:#ccc;font:14px sans-serif}img{max-width:100%;"
    "display:block}p{margin:8px}a{color:#8cf}</style></head><body>\n"
    "<img src=\"/stream.mjpg\" alt=\"Camera picture with detections\">\n"
    "<p>Green: both circles were measured. Blue: a light edge crosses a circle. Orange: measured "
    "from one circle and the rim. Grey: expected there, but not detected. Red: rejected, with the "
    "reason and found/allowed. <a href=\"/frame.png\">One picture as PNG</a></p>\n"
    "</body></html>\n";

ListenOptions listenOptions(int port) {
  return {.owner = "debug view",
          .address = "127.0.0.1",
          .port = port,
          .ports_tried = 1,
          .max_connections = 8,
          .max_remote = 0,
          .send_buffer = 0};
}

HttpResponse response(int status, std::string_view type, std::string body) {
  HttpResponse made;
  made.status = status;
  made.setHeader("Cache-Control", "no-store");
  // Pages of other sites show none of this, not even in a frame.
  made.setHeader("Cross-Origin-Resource-Policy", "same-origin");
  made.setHeader("Content-Security-Policy", "frame-ancestors 'none'");
  made.setBody(type, std::move(body));
  return made;
}

HttpResponse faultResponse(RequestFault fault) {
  const bool full = fault == RequestFault::kNoPlace;
  return response(statusOf(fault), kPlainText, full ? "too many viewers\n" : "invalid request\n");
}

/// Whether the Host header names this host. With DNS rebinding, a page of another site can send
/// requests here, but it names its own host. Clients without the header are no browsers.
bool isOwnHost(const HttpRequest& request) {
  if (request.headerCount("Host") == 0) return true;
  std::string_view host = request.header("Host");
  host = host.substr(0, host.find(':'));  // a tunnel may have another port
  return host == "127.0.0.1" || host == "localhost";
}

/// Whether a page of another site, or of another port, makes the browser send the request. The user
/// may follow a link from there to the page. Programs send no such header; the dashboard, which
/// fetches pictures for its page, is one of them.
bool isForeign(const HttpRequest& request, std::string_view path) {
  const std::string_view site = request.header("Sec-Fetch-Site");
  if (site.empty() || site == "none" || site == "same-origin") return false;
  return path != "/" || request.header("Sec-Fetch-Mode") != "navigate";
}

}  // namespace

struct DebugView::Server {
  explicit Server(int port) : http(listenOptions(port)) {
    http.open([this](HttpExchange& exchange) { serve(exchange); }, faultResponse);
  }
  ~Server() {
    broker.close();
    http.close();
  }

  void serve(HttpExchange& exchange);
  HttpResponse still(FrameBroker::Format format);
  HttpResponse stream();

  FrameBroker broker;
  HttpServer http;
};

void DebugView::Server::serve(HttpExchange& exchange) {
  const HttpRequest& request = exchange.request();
  const std::string path = request.path();
  if (request.method != "GET") {
    exchange.respond(response(405, kPlainText, "only GET is supported\n"));
    return;
  }
  if (!isOwnHost(request)) {
    exchange.respond(response(403, kPlainText, "use the host name localhost or 127.0.0.1\n"));
    return;
  }
  if (isForeign(request, path)) {
    exchange.respond(response(403, kPlainText, "a page of another site asks; open this address\n"));
    return;
  }
  http.identify(exchange);
  if (path == "/") {
    exchange.respond(response(200, "text/html; charset=utf-8", std::string(kPage)));
  } else if (path == "/frame.png") {
    exchange.respond(still(FrameBroker::Format::kPng));
  } else if (path == "/frame.jpg") {
    exchange.respond(still(FrameBroker::Format::kJpeg));
  } else if (path == "/stream.mjpg") {
    exchange.respond(stream());
  } else {
    exchange.respond(
        response(404, kPlainText, "there are only /, /frame.png, /frame.jpg and /stream.mjpg\n"));
  }
}

HttpResponse DebugView::Server::still(FrameBroker::Format format) {
  const FrameBroker::Picture picture =
      broker.next(format, FrameBroker::Clock::now() + kStillTimeout, [] { return true; });
  if (!picture) return response(503, kPlainText, "no picture comes from the camera\n");
  return response(200, format == FrameBroker::Format::kJpeg ? "image/jpeg" : "image/png", *picture);
}

HttpResponse DebugView::Server::stream() {
  HttpResponse made = response(200, "multipart/x-mixed-replace; boundary=picture", {});
  made.source = [this, first = true](ClientStream& client) mutable {
    if (std::exchange(first, false)) return client.write("--picture\r\n");
    const FrameBroker::Picture picture =
        broker.next(FrameBroker::Format::kJpeg, FrameBroker::Clock::time_point::max(),
                    [&client] { return client.isOpen(); });
    return picture &&
           client.write(fmt::format("Content-Type: image/jpeg\r\nContent-Length: {}\r\n\r\n",
                                    picture->size())) &&
           client.write(*picture) && client.write("\r\n--picture\r\n");
  };
  return made;
}

DebugView::DebugView(int port) : server_(std::make_unique<Server>(port)) {}

DebugView::~DebugView() = default;

int DebugView::port() const { return server_->http.port(); }

bool DebugView::wanted() const { return server_->broker.wanted(); }

void DebugView::show(std::function<optics::RgbImage()> paint) {
  server_->broker.show(std::move(paint));
}

}  // namespace lab::tracker
