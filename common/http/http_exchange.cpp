// The only source that includes Boost.Beast, which takes seconds to compile.
#include "common/http/http_exchange.hpp"

#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/status.hpp>
#include <boost/beast/http/string_body.hpp>
#include <cerrno>
#include <cstdint>
#include <limits>

#include "common/http/ip_address.hpp"

namespace lab {
namespace {

namespace http = boost::beast::http;

/// The string_view of Boost is another type in each version.
template <typename Text>
std::string toString(const Text& text) {
  return {text.data(), text.size()};
}

/// Feeds a parser of Beast from a stream. What the parser does not consume is offered to it again
/// together with the bytes that follow.
template <bool is_request>
class MessageReader {
 public:
  using Parser = http::parser<is_request, http::string_body>;

  MessageReader() {
    parser_.header_limit(ClientStream::kMaxHead);
    // The callers limit the body. boost::none would be refused by Beast of Boost 1.74 as soon as
    // there is a Content-Length.
    parser_.body_limit(std::numeric_limits<std::uint64_t>::max());
    parser_.eager(false);  // stop behind the headers
  }

  [[nodiscard]] const Parser& parser() const { return parser_; }

  bool readHead(ClientStream& stream) {
    while (!parser_.is_header_done()) {
      if (parseMore()) continue;
      if (error_ || !receive(stream)) return false;
    }
    return true;
  }

  bool readBody(ClientStream& stream, std::size_t limit) {
    while (!parser_.is_done()) {
      const bool progress = parseMore();
      if (parser_.get().body().size() > limit) error_ = http::error::body_limit;
      if (error_) return false;
      if (progress || receive(stream)) continue;
      // Without a Content-Length, a response ends with the connection.
      if (!parser_.need_eof() || stream.limitReached()) return false;
      parser_.put_eof(error_);
      return !error_;
    }
    return true;
  }

  [[nodiscard]] bool isTooLarge() const {
    return error_ == http::error::header_limit || error_ == http::error::body_limit;
  }

 private:
  /// @return whether the parser got further with what was received
  bool parseMore() {
    if (unread_.empty()) return false;
    const std::size_t used = parser_.put(boost::asio::buffer(unread_), error_);
    unread_.erase(0, used);
    if (error_ == http::error::need_more) {
      error_ = {};
      return false;
    }
    return !error_ && used > 0;
  }

  bool receive(ClientStream& stream) {
    std::array<char, 4096> piece{};
    const std::size_t count = stream.read(piece);
    unread_.append(piece.data(), count);
    return count > 0;
  }

  Parser parser_;
  boost::beast::error_code error_;
  std::string unread_;
};

}  // namespace

struct HttpExchange::Parser : MessageReader<true> {};

HttpExchange::HttpExchange(ClientStream& stream)
    : stream_(stream), parser_(std::make_unique<Parser>()) {}

HttpExchange::~HttpExchange() = default;

HttpExchange::Result HttpExchange::readHead() {
  if (!parser_->readHead(stream_)) return failure();
  const auto& message = parser_->parser().get();
  request_.method = toString(message.method_string());
  request_.target = toString(message.target());
  for (const auto& field : message) {
    request_.headers.emplace_back(toString(field.name_string()), toString(field.value()));
  }
  request_.peer = peerAddress(stream_.socket()).ip;
  request_.local = localAddress(stream_.socket()).ip;
  return Result::kOk;
}

HttpExchange::Result HttpExchange::readBody(std::size_t limit) {
  if (parser_->parser().content_length().value_or(0) > limit) return Result::kTooLarge;
  stream_.allow(limit);
  if (!parser_->readBody(stream_, limit)) return failure();
  request_.body = parser_->parser().get().body();
  return Result::kOk;
}

HttpExchange::Result HttpExchange::failure() const {
  if (parser_->isTooLarge() || stream_.limitReached()) return Result::kTooLarge;
  return stream_.hasRead() ? Result::kMalformed : Result::kNoRequest;
}

void HttpExchange::respond(const HttpResponse& response) {
  const bool has_body = response.status != 304 && response.status != 204;
  std::string head = fmt::format(
      "HTTP/1.1 {} {}\r\n", response.status,
      toString(http::obsolete_reason(http::int_to_status(static_cast<unsigned>(response.status)))));
  for (const auto& [name, value] : response.headers) head += fmt::format("{}: {}\r\n", name, value);
  if (has_body && !response.source) {
    head += fmt::format("Content-Length: {}\r\n", response.body.size());
  } else if (has_body && response.source_length) {
    head += fmt::format("Content-Length: {}\r\n", *response.source_length);
  }
  head += "Connection: close\r\n\r\n";
  if (!stream_.write(head) || !has_body || request_.method == "HEAD") return;
  if (!response.source) {
    stream_.write(response.body);
    return;
  }
  while (response.source(stream_)) {
  }
}

std::optional<std::string> httpGet(int port_on_loopback, std::string_view target,
                                   std::chrono::milliseconds timeout, std::size_t limit) {
  struct Socket {
    int number = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    ~Socket() {
      if (number >= 0) ::close(number);
    }
  };
  const Socket socket;
  sockaddr_in endpoint{};
  endpoint.sin_family = AF_INET;
  endpoint.sin_port = htons(static_cast<std::uint16_t>(port_on_loopback));
  endpoint.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const auto deadline = ClientStream::Clock::now() + timeout;
  if (connect(socket.number, reinterpret_cast<const sockaddr*>(&endpoint), sizeof endpoint) != 0 &&
      (errno != EINPROGRESS || !waitForSocket(socket.number, POLLOUT, deadline))) {
    return std::nullopt;
  }
  ClientStream stream(socket.number, limit, deadline - ClientStream::Clock::now());
  MessageReader<false> reader;
  if (!stream.write(
          fmt::format("GET {} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nConnection: close\r\n\r\n", target,
                      port_on_loopback)) ||
      !reader.readHead(stream) || reader.parser().get().result_int() != 200 ||
      !reader.readBody(stream, limit)) {
    return std::nullopt;
  }
  return reader.parser().get().body();
}

}  // namespace lab
