#include "dashboard/web/web_server.hpp"

#include <fmt/format.h>
#include <sys/random.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <variant>

#include "common/http/http_server.hpp"
#include "common/text/fnv1a.hpp"
#include "dashboard/control/json_object_reader.hpp"
#include "dashboard/control/operator_request_reader.hpp"
#include "dashboard/library/library_routes.hpp"
#include "dashboard/web/camera_picture.hpp"
#include "dashboard/web/event_stream.hpp"
#include "dashboard/web/http_response.hpp"
#include "dashboard/web/json.hpp"
#include "dashboard/web/page_files.hpp"

namespace lab::dashboard {
namespace {

constexpr int kMaxViewers = 32;

ListenOptions listenOptions(const WebOptions& options) {
  return {.owner = "dashboard",
          .address = options.address,
          .port = options.port,
          .ports_tried = 100,
          .max_connections = 64,
          .max_remote = 40,
          // A client that reads slowly would otherwise receive old states from the kernel's buffer.
          .send_buffer = 128 * 1024};
}

/// A hash of the content, for the ETag header.
std::string entityTag(std::string_view content) {
  return fmt::format("\"{:016x}\"", fnv1a(content));
}

}  // namespace

struct WebServer::Server {
  Server(const WebOptions& the_options, Hub& the_hub, LabRequestHandler& the_lab);
  ~Server();

  void serve(HttpExchange& exchange);
  void route(HttpExchange& exchange, HttpResponse& response);
  void refuse(HttpResponse& response, const Decision& decision);
  HttpResponse refuseFault(RequestFault fault);
  void get(const HttpRequest& request, HttpResponse& response);
  void post(const HttpRequest& request, HttpResponse& response);
  void sendPage(const std::string& name, const HttpRequest& request, HttpResponse& response);
  void sendStream(HttpResponse& response);
  void sendPermissions(const HttpRequest& request, HttpResponse& response);
  void sendQuery(const HttpRequest& request, HttpResponse& response);
  void sendLight(HttpResponse& response);
  void sendCamera(HttpResponse& response);
  void takeRequest(const HttpRequest& request, HttpResponse& response);

  WebOptions options;
  Hub& hub;
  LabRequestHandler& lab;
  std::map<std::string, std::string, std::less<>> tags;  ///< entity tags of the page's files
  LibraryRoutes library;
  CameraPicture picture;
  RefusalCount refused;
  std::atomic<int> viewers = 0;
  std::atomic<bool> closing = false;
  HttpServer server;
  GuardRules rules;
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
      server(listenOptions(options)),
      rules{options.address, server.port(), options.token, options.control_from_elsewhere} {
  for (const PageFile& file : pageFiles()) tags.emplace(file.name, entityTag(file.content));
  server.open([this](HttpExchange& exchange) { serve(exchange); },
              [this](RequestFault fault) { return refuseFault(fault); });
}

WebServer::Server::~Server() {
  closing = true;
  library.close();
  server.close();
}

void WebServer::Server::serve(HttpExchange& exchange) {
  HttpResponse response = emptyResponse();
  try {
    route(exchange, response);
  } catch (const std::exception&) {
    response = emptyResponse();
    respondError(response, 500, "the server failed to serve this request");
  }
  exchange.respond(response);
}

void WebServer::Server::route(HttpExchange& exchange, HttpResponse& response) {
  const HttpRequest& request = exchange.request();
  const bool is_post = request.method == "POST";
  const RequestFacts facts = factsOf(request);
  Decision decision = mayRead(rules, facts);
  if (decision.yes()) decision = checkBody(request);
  if (decision.yes() && is_post) decision = mayControl(rules, facts);
  if (decision.yes() && is_post &&
      exchange.readBody(kMaxRequestBody) != HttpExchange::Result::kOk) {
    decision = {Refusal::kMalformed, 400, "the body ends before its Content-Length"};
  }
  if (!decision.yes()) return refuse(response, decision);
  server.identify(exchange);
  if (is_post) {
    post(request, response);
  } else {
    get(request, response);
  }
}

void WebServer::Server::refuse(HttpResponse& response, const Decision& decision) {
  refused.add(decision.refusal);
  respondError(response, decision.status, decision.why);
}

HttpResponse WebServer::Server::refuseFault(RequestFault fault) {
  HttpResponse response = emptyResponse();
  switch (fault) {
    case RequestFault::kMalformed:
      refuse(response, {Refusal::kMalformed, statusOf(fault), "this is not an HTTP request"});
      break;
    case RequestFault::kTooLarge:
      refuse(response, {Refusal::kOversized, statusOf(fault),
                        fmt::format("the head of the request is larger than {} bytes",
                                    ClientStream::kMaxHead)});
      break;
    case RequestFault::kNoPlace:
      refuse(response, {Refusal::kCrowded, statusOf(fault), "too many clients are connected"});
      break;
  }
  return response;
}

void WebServer::Server::get(const HttpRequest& request, HttpResponse& response) {
  constexpr std::string_view kPage = "/page/";
  const std::string path = request.path();
  if (path == "/") return sendPage("index.html", request, response);
  if (path.starts_with(kPage)) return sendPage(path.substr(kPage.size()), request, response);
  if (path == "/api/stream") return sendStream(response);
  if (path == "/api/me") return sendPermissions(request, response);
  if (path == "/api/light") return sendLight(response);
  if (path == "/api/camera.jpg") return sendCamera(response);
  if (path.starts_with("/api/ask/")) return sendQuery(request, response);
  const bool control = mayControl(rules, factsOf(request)).yes();
  const Decision decision = library.get(request, control, response);
  if (!decision.yes()) refuse(response, decision);
}

void WebServer::Server::sendPage(const std::string& name, const HttpRequest& request,
                                 HttpResponse& response) {
  for (const PageFile& file : pageFiles()) {
    if (file.name != name) continue;
    const std::string& tag = tags.find(name)->second;
    response.setHeader("Cache-Control", "no-cache");
    response.setHeader("ETag", tag);
    if (request.header("If-None-Match") == tag) {
      response.status = 304;
      return;
    }
    response.setBody(contentType(name), std::string(file.content));
    return;
  }
  refuse(response, {Refusal::kPath, 404, "the page has no such file"});
}

void WebServer::Server::sendStream(HttpResponse& response) {
  if (++viewers > kMaxViewers) {
    --viewers;
    return refuse(response,
                  {Refusal::kCrowded, 503,
                   fmt::format("{} pages are open already; close one of them", kMaxViewers)});
  }
  const std::shared_ptr<void> viewer(nullptr, [this](void*) { --viewers; });
  response.setHeader("Content-Type", "text/event-stream");
  response.source = [this, viewer,
                     events = std::make_shared<EventStream>(hub)](ClientStream& client) {
    if (closing || hub.closed() || !client.isOpen()) return false;
    const std::string text = events->next();
    return text.empty() || client.write(text);
  };
}

void WebServer::Server::sendPermissions(const HttpRequest& request, HttpResponse& response) {
  const Decision decision = mayControl(rules, factsOf(request));
  respondJson(response, toText({{"control", decision.yes()}, {"why", decision.why}}));
}

void WebServer::Server::sendQuery(const HttpRequest& request, HttpResponse& response) {
  const std::string what = request.path().substr(std::string_view("/api/ask/").size());
  if (auto json = lab.query(what, request.query("which"))) {
    return respondJson(response, std::move(*json));
  }
  respondError(response, 404, "there is no such thing, or the lab does not answer");
}

void WebServer::Server::sendLight(HttpResponse& response) {
  const Hub::Text raster = hub.newest(".light");
  if (!raster) return respondError(response, 404, "no light is known yet");
  response.setBody("application/octet-stream", *raster);
}

void WebServer::Server::sendCamera(HttpResponse& response) {
  if (options.camera_port == 0) return respondError(response, 404, "the tracker shows no picture");
  const CameraPicture::Text jpeg = picture.newest();
  if (!jpeg) return respondError(response, 503, "no picture comes from the tracker");
  response.setBody("image/jpeg", *jpeg);
}

void WebServer::Server::post(const HttpRequest& request, HttpResponse& response) {
  try {
    // "/api/wish" is the former path: a page that was loaded from an older server can still stop.
    if (request.path() == "/api/request" || request.path() == "/api/wish") {
      return takeRequest(request, response);
    }
    library.post(request, response);
  } catch (const JsonObjectError& error) {
    refuse(response, {Refusal::kMalformed, 400, error.what()});
  }
}

void WebServer::Server::takeRequest(const HttpRequest& request, HttpResponse& response) {
  const std::variant<OperatorRequest, InvalidRequest> read = readOperatorRequest(request.body);
  if (const auto* invalid = std::get_if<InvalidRequest>(&read)) {
    return refuse(response, {Refusal::kMalformed, 400, invalid->why});
  }
  const std::string refusal = lab.request(std::get<OperatorRequest>(read));
  if (refusal.empty()) return respondJson(response, "{}", 202);
  respondError(response, 409, refusal);
}

WebServer::WebServer(const WebOptions& options, Hub& hub, LabRequestHandler& lab)
    : server_(std::make_unique<Server>(options, hub, lab)) {}

WebServer::~WebServer() = default;

int WebServer::port() const { return server_->server.port(); }

std::string WebServer::address() const {
  // If the server listens on all addresses, the loopback address is the one that always works.
  const std::string& listened = server_->options.address;
  const bool is_ipv6 = listened.find(':') != std::string::npos;
  std::string host = is_ipv6 ? fmt::format("[{}]", listened) : listened;
  if (listened == "0.0.0.0" || listened == "::") host = "127.0.0.1";
  return fmt::format("http://{}:{}/#token={}", host, port(), server_->options.token);
}

Refusals WebServer::refusals() const { return server_->refused.all(); }

int WebServer::viewers() const { return server_->viewers; }

std::string newToken() {
  std::array<unsigned char, 16> bits{};
  if (getrandom(bits.data(), bits.size(), 0) != static_cast<ssize_t>(bits.size())) {
    throw std::runtime_error("dashboard: the system provides no random numbers");
  }
  std::string text;
  for (const unsigned char byte : bits) text += fmt::format("{:02x}", byte);
  return text;
}

}  // namespace lab::dashboard
