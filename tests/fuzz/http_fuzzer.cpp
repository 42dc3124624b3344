// HTTP requests to the dashboard: parser, guard, operator requests and the library of runs. The
// first byte says where the client is and whether it knows the token.
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <variant>

#include "common/http/client_stream.hpp"
#include "common/http/http_exchange.hpp"
#include "common/http/http_message.hpp"
#include "dashboard/control/json_object_reader.hpp"
#include "dashboard/control/operator_request_reader.hpp"
#include "dashboard/library/library_routes.hpp"
#include "dashboard/web/http_guard.hpp"
#include "tests/fuzz/input.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::fuzz {
namespace {

namespace fs = std::filesystem;

/// A folder of runs with one run. There are no experiments, so nothing can be started.
class Runs {
 public:
  Runs() {
    fs::create_directories(folder_ / "runs/abp/figures");
    fs::create_directories(folder_ / "none");
    std::ofstream(folder_ / "runs/abp/summary.json") << R"({"programs": []})";
    std::ofstream(folder_ / "runs/abp/report.html") << "<p>";
    std::ofstream(folder_ / "secret.html") << "secret";
  }

  [[nodiscard]] dashboard::RunLauncher::Folders folders() const {
    return {folder_ / "none", folder_ / "none", folder_ / "runs", folder_ / "none"};
  }

 private:
  TemporaryFolder folder_;
};

/// Both ends of a connection; the client has sent everything and closed its direction.
class Connection {
 public:
  explicit Connection(const std::string& sent) {
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends_.data()) != 0 ||
        write(ends_[0], sent.data(), sent.size()) != static_cast<ssize_t>(sent.size())) {
      throw std::runtime_error("no connection");
    }
    shutdown(ends_[0], SHUT_WR);
  }
  ~Connection() {
    for (const int end : ends_) close(end);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  [[nodiscard]] int server() const { return ends_[1]; }

  /// What the server has sent.
  [[nodiscard]] std::string received() const {
    std::string text;
    std::array<char, 4096> piece{};
    for (ssize_t count = 0; (count = read(ends_[0], piece.data(), piece.size())) > 0;) {
      text.append(piece.data(), static_cast<std::size_t>(count));
    }
    return text;
  }

 private:
  std::array<int, 2> ends_{};
};

void require(bool condition) {
  if (!condition) __builtin_trap();
}

/// As WebServer does it.
void route(HttpExchange& exchange, const dashboard::GuardRules& rules, bool remote,
           dashboard::LibraryRoutes& library) {
  using dashboard::Decision;
  HttpRequest request = exchange.request();
  request.local = "127.0.0.1";
  request.peer = remote ? "192.0.2.7" : "127.0.0.1";
  const bool is_post = request.method == "POST";
  const dashboard::RequestFacts facts = dashboard::factsOf(request);
  static_cast<void>(request.query("which"));
  Decision decision = dashboard::mayRead(rules, facts);
  if (decision.yes()) decision = dashboard::checkBody(request);
  if (decision.yes() && is_post) decision = dashboard::mayControl(rules, facts);
  if (!decision.yes()) return;
  if (is_post) {
    require(!remote && facts.token == rules.token);
    if (exchange.readBody(dashboard::kMaxRequestBody) != HttpExchange::Result::kOk) return;
  }
  HttpResponse response;
  if (!is_post) {
    static_cast<void>(library.get(request, false, response));
  } else if (request.path() == "/api/wish") {
    static_cast<void>(dashboard::readOperatorRequest(exchange.request().body));
  } else {
    try {
      library.post(exchange.request(), response);
    } catch (const dashboard::JsonObjectError&) {
    }
    require(response.status != 202);  // nothing was started
  }
  exchange.respond(response);
}

}  // namespace
}  // namespace lab::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace lab;
  static const fuzz::Runs kRuns;
  static dashboard::LibraryRoutes library(kRuns.folders());
  constexpr std::size_t kMostSent = 100'000;  // fits into the buffer of a socket
  fuzz::Input input(bytes, size < kMostSent ? size : kMostSent);
  const auto client = input.number<std::uint8_t>();
  const std::string sent = input.restAsText();
  static_cast<void>(dashboard::readOperatorRequest(sent));
  const dashboard::GuardRules rules{"127.0.0.1", 8480, client % 4 < 2 ? "secret" : "", false};
  const fuzz::Connection connection(sent);
  ClientStream stream(connection.server(), ClientStream::kMaxHead, std::chrono::milliseconds(500));
  HttpExchange exchange(stream);
  if (exchange.readHead() == HttpExchange::Result::kOk) {
    fuzz::route(exchange, rules, client % 2 != 0, library);
  }
  fuzz::require(connection.received().find("\r\n\r\nsecret") == std::string::npos);
  return 0;
}
