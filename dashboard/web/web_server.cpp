#include "dashboard/web/web_server.hpp"

#include <fmt/format.h>
#include <httplib.h>
#include <sys/random.h>

#include <array>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "dashboard/control/json_object_reader.hpp"
#include "dashboard/control/operator_request_reader.hpp"
#include "dashboard/library/library_routes.hpp"
#include "dashboard/web/camera_picture.hpp"
#include "dashboard/web/client_stream.hpp"
#include "dashboard/web/connection_acceptor.hpp"
#include "dashboard/web/event_stream.hpp"
#include "dashboard/web/http_guard.hpp"
#include "dashboard/web/http_response.hpp"
#include "dashboard/web/page_files.hpp"
#include "dashboard/web/refusal_count.hpp"

namespace lab::dashboard {
namespace {

constexpr std::size_t kMostBody = 64 * 1024;  // bytes
constexpr int kMostViewers = 32;

/// The client that this thread serves: cpp-httplib does not tell its handlers.
thread_local ClientStream* client = nullptr;

RequestFacts factsOf(const httplib::Request& request) {
  const auto header = [&request](const char* name) -> std::string_view {
    const auto place = request.headers.find(name);
    return place == request.headers.end() ? std::string_view() : place->second;
  };
  return {.method = request.method,
          .target = request.target,
          .host = header("Host"),
          .origin = header("Origin"),
          .fetch_site = header("Sec-Fetch-Site"),
          .fetch_mode = header("Sec-Fetch-Mode"),
          .token = header("X-Lab-Token"),
          .peer = request.remote_addr,
          .local = request.local_addr};
}

/// What is wrong with the headers of a body, before it is read.
Decision mayBring(const httplib::Request& request) {
  for (const char* once : {"Host", "Content-Length", "Content-Type", "X-Lab-Token", "Origin"}) {
    if (request.get_header_value_count(once) > 1) {
      return {Refusal::kMalformed, 400, fmt::format("found {} twice, expected it once", once)};
    }
  }
  if (request.has_header("Transfer-Encoding") || request.has_header("Content-Encoding")) {
    return {Refusal::kMalformed, 400, "expected a body as it is, with its Content-Length"};
  }
  const std::string length = request.get_header_value("Content-Length");
  const bool post = request.method == "POST";
  if (length.empty() && !post) return {};
  if (length.empty()) return {Refusal::kMalformed, 411, "expected a Content-Length"};
  if (length.find_first_not_of("0123456789") != std::string::npos) {
    return {Refusal::kMalformed, 400, "Content-Length: expected a number"};
  }
  if (length.size() > 9 || std::stoul(length) > (post ? kMostBody : 0)) {
    return {
        Refusal::kOversized, 413,
        fmt::format("found a body of {} bytes, expected at most {}", length, post ? kMostBody : 0)};
  }
  const std::string type = request.get_header_value("Content-Type");
  if (post && !type.starts_with("application/json")) {
    return {Refusal::kMalformed, 415, "Content-Type: expected application/json"};
  }
  return {};
}

/// Of the content: changes when it does.
std::string entityTag(std::string_view content) {
  std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a
  for (const char byte : content) {
    hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3;
  }
  return fmt::format("\"{:016x}\"", hash);
}

}  // namespace

struct WebServer::Server final : httplib::Server {
  Server(const WebOptions& the_options, Hub& the_hub, LabRequestHandler& the_lab);
  ~Server() override;

  void serve(int socket, bool room);
  void answerClient(ClientStream& stream);
  HandlerResponse route(const httplib::Request& request, httplib::Response& response);
  void refuse(httplib::Response& response, const Decision& decision);
  void get(const httplib::Request& request, httplib::Response& response);
  void page(const std::string& name, const httplib::Request& request, httplib::Response& response);
  void stream(httplib::Response& response);
  void me(const httplib::Request& request, httplib::Response& response);
  void ask(const httplib::Request& request, httplib::Response& response);
  void light(httplib::Response& response);
  void camera(httplib::Response& response);
  void post(const httplib::Request& request, httplib::Response& response);
  void wish(const httplib::Request& request, httplib::Response& response);
  void explain(httplib::Response& response);

  WebOptions options;
  Hub& hub;
  LabRequestHandler& lab;
  std::map<std::string, std::string, std::less<>> tags;  ///< of the page's files
  LibraryRoutes library;
  CameraPicture picture;
  ConnectionAcceptor acceptor;
  GuardRules rules;
  RefusalCount refused;
  std::atomic<int> viewers = 0;
  std::atomic<bool> closing = false;
};

WebServer::Server::Server(const WebOptions& the_options, Hub& the_hub, LabRequestHandler& the_lab)
    : options(the_options),
      hub(the_hub),
      lab(the_lab),
      library({.programs = options.programs,
               .experiments = options.experiments,
               .runs = options.runs,
               .own = std::filesystem::current_path()}),
      picture(options.camera_port),
      acceptor(options.address, options.port),
      rules{options.address, acceptor.port(), options.token, options.control_from_elsewhere} {
  for (const PageFile& file : pageFiles()) tags.emplace(file.name, entityTag(file.content));
  svr_sock_ = 0;  // to the library: not shutting down
  set_default_headers(commonHeaders());
  set_payload_max_length(kMostBody);
  set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
    return route(request, response);
  });
  Post("/api/[a-z]+", [this](const httplib::Request& request, httplib::Response& response) {
    post(request, response);
  });
  set_error_handler(
      Handler([this](const httplib::Request&, httplib::Response& response) { explain(response); }));
  set_exception_handler(
      [](const httplib::Request&, httplib::Response& response, const std::exception_ptr&) {
        respondError(response, 500, "the server failed at this; its log says more");
      });
  acceptor.open([this](int socket, bool room) { serve(socket, room); });
}

WebServer::Server::~Server() {
  closing = true;
  library.close();
  acceptor.close();
}

void WebServer::Server::serve(int socket, bool room) {
  try {
    ClientStream stream(socket);
    if (room) {
      answerClient(stream);
    } else {
      refused.add(Refusal::kCrowded);
      stream.Stream::write(
          "HTTP/1.1 503 Service Unavailable\r\nContent-Length: 0\r\nConnection: close\r\n\r\n");
    }
    if (stream.wrote()) stream.finish();
  } catch (const std::exception&) {
    // No memory, say: this client goes, the others stay.
  }
}

void WebServer::Server::answerClient(ClientStream& stream) {
  client = &stream;
  bool closed = false;
  // One request a connection: what a refused client sends after it is never taken for another.
  process_request(stream, true, closed, [](httplib::Request& request) {
    request.ranges.clear();
    request.headers.erase("Range");
    request.headers.erase("Accept-Encoding");
    request.headers.erase("Expect");
  });
  client = nullptr;
  if (!stream.wrote() && stream.heard() && !closing) {
    refused.add(stream.exhausted() ? Refusal::kOversized : Refusal::kMalformed);
    stream.Stream::write(fmt::format(
        "HTTP/1.1 {}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n",
        stream.exhausted() ? "431 Request Header Fields Too Large" : "400 Bad Request"));
  }
}

void WebServer::Server::refuse(httplib::Response& response, const Decision& decision) {
  refused.add(decision.refusal);
  respondError(response, decision.status, decision.why);
}

/// What the library answers by itself.
void WebServer::Server::explain(httplib::Response& response) {
  if (!response.body.empty()) return;
  const bool large = response.status == 413 || response.status == 414 ||
                     (client != nullptr && client->exhausted());
  refuse(response,
         large ? Decision{Refusal::kOversized, response.status == 400 ? 431 : response.status,
                          "the request is larger than what is read"}
               : Decision{Refusal::kMalformed, response.status, "this is no request"});
}

httplib::Server::HandlerResponse WebServer::Server::route(const httplib::Request& request,
                                                          httplib::Response& response) {
  const RequestFacts facts = factsOf(request);
  Decision decision = mayRead(rules, facts);
  if (decision.yes()) decision = mayBring(request);
  if (decision.yes() && request.method == "POST") decision = mayControl(rules, facts);
  if (!decision.yes()) {
    refuse(response, decision);
  } else if (request.method == "POST") {
    client->allow(kMostBody);
    return HandlerResponse::Unhandled;
  } else {
    acceptor.settled(client->socket());
    get(request, response);
  }
  return HandlerResponse::Handled;
}

void WebServer::Server::get(const httplib::Request& request, httplib::Response& response) {
  constexpr std::string_view kPage = "/page/";
  const std::string& path = request.path;
  if (path == "/") return page("index.html", request, response);
  if (path.starts_with(kPage)) return page(path.substr(kPage.size()), request, response);
  if (path == "/api/stream") return stream(response);
  if (path == "/api/me") return me(request, response);
  if (path == "/api/light") return light(response);
  if (path == "/api/camera.jpg") return camera(response);
  if (path.starts_with("/api/ask/")) return ask(request, response);
  const bool control = mayControl(rules, factsOf(request)).yes();
  const Decision decision = library.get(request, control, response);
  if (!decision.yes()) refuse(response, decision);
}

void WebServer::Server::page(const std::string& name, const httplib::Request& request,
                             httplib::Response& response) {
  for (const PageFile& file : pageFiles()) {
    if (file.name != name) continue;
    const std::string& tag = tags.find(name)->second;
    replaceHeader(response, "Cache-Control", "no-cache");
    response.set_header("ETag", tag);
    if (request.get_header_value("If-None-Match") == tag) {
      response.status = 304;
      return;
    }
    response.set_content(file.content.data(), file.content.size(), contentType(name));
    return;
  }
  refuse(response, {Refusal::kPath, 404, "the page has no such file"});
}

void WebServer::Server::stream(httplib::Response& response) {
  if (++viewers > kMostViewers) {
    --viewers;
    return refuse(response, {Refusal::kCrowded, 503,
                             fmt::format("{} look already; close another page", kMostViewers)});
  }
  response.set_content_provider(
      "text/event-stream",
      [this, events = std::make_shared<EventStream>(hub)](std::size_t, httplib::DataSink& sink) {
        if (closing || hub.closed() || !sink.is_writable()) return false;
        const std::string text = events->next();
        return text.empty() || sink.write(text.data(), text.size());
      },
      [this](bool) { --viewers; });
}

void WebServer::Server::me(const httplib::Request& request, httplib::Response& response) {
  const Decision decision = mayControl(rules, factsOf(request));
  const nlohmann::json json{{"control", decision.yes()}, {"why", decision.why}};
  respondJson(response, json.dump());
}

void WebServer::Server::ask(const httplib::Request& request, httplib::Response& response) {
  const std::string what = request.path.substr(std::string_view("/api/ask/").size());
  const std::string which = request.get_param_value("which");
  if (auto json = lab.ask(what, which)) return respondJson(response, std::move(*json));
  respondError(response, 404, "there is no such thing, or the lab does not answer");
}

void WebServer::Server::light(httplib::Response& response) {
  const Hub::Text raster = hub.newest(".light");
  if (!raster) return respondError(response, 404, "no light is known yet");
  response.set_content(*raster, "application/octet-stream");
}

void WebServer::Server::camera(httplib::Response& response) {
  if (options.camera_port == 0) return respondError(response, 404, "the tracker shows no picture");
  const CameraPicture::Text jpeg = picture.newest();
  if (!jpeg) return respondError(response, 503, "no picture comes from the tracker");
  response.set_content(*jpeg, "image/jpeg");
}

void WebServer::Server::post(const httplib::Request& request, httplib::Response& response) {
  acceptor.settled(client->socket());
  try {
    if (request.path == "/api/wish") return wish(request, response);
    library.post(request, response);
  } catch (const JsonObjectError& error) {
    refuse(response, {Refusal::kMalformed, 400, error.what()});
  }
}

void WebServer::Server::wish(const httplib::Request& request, httplib::Response& response) {
  const std::variant<OperatorRequest, InvalidRequest> read = readOperatorRequest(request.body);
  if (const auto* bad = std::get_if<InvalidRequest>(&read)) {
    return refuse(response, {Refusal::kMalformed, 400, bad->why});
  }
  const std::string refusal = lab.wish(std::get<OperatorRequest>(read));
  if (refusal.empty()) return respondJson(response, "{}", 202);
  respondError(response, 409, refusal);
}

WebServer::WebServer(const WebOptions& options, Hub& hub, LabRequestHandler& lab)
    : server_(std::make_unique<Server>(options, hub, lab)) {}

WebServer::~WebServer() = default;

int WebServer::port() const { return server_->acceptor.port(); }

std::string WebServer::address() const {
  // Who listens everywhere is told of the way from this machine.
  const std::string& listened = server_->options.address;
  const bool six = listened.find(':') != std::string::npos;
  std::string host = six ? fmt::format("[{}]", listened) : listened;
  if (listened == "0.0.0.0" || listened == "::") host = "127.0.0.1";
  return fmt::format("http://{}:{}/#token={}", host, port(), server_->options.token);
}

Refusals WebServer::refusals() const { return server_->refused.all(); }

int WebServer::viewers() const { return server_->viewers; }

std::string newToken() {
  std::array<unsigned char, 16> bits{};
  if (getrandom(bits.data(), bits.size(), 0) != static_cast<ssize_t>(bits.size())) {
    throw std::runtime_error("dashboard: the system gives no random numbers");
  }
  std::string text;
  for (const unsigned char byte : bits) text += fmt::format("{:02x}", byte);
  return text;
}

}  // namespace lab::dashboard
