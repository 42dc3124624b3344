/// One HTTP request and its response, on the server's side and on the client's.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "common/http/client_stream.hpp"
#include "common/http/http_message.hpp"

namespace lab {

/// The server's side. It serves one request per connection. So bytes that follow a refused request
/// are never read as another request. There is no compression and no partial content: the
/// headers Accept-Encoding, Range and Expect are ignored.
class HttpExchange {
 public:
  enum class Result {
    kOk,
    kNoRequest,  ///< the client closed, or was silent until the timeout, before its first byte
    kMalformed,  ///< not HTTP/1.0 or 1.1, or it ended too early
    kTooLarge,   ///< more bytes than the limit
  };

  /// `stream` must outlive the exchange.
  explicit HttpExchange(ClientStream& stream);
  ~HttpExchange();
  HttpExchange(const HttpExchange&) = delete;
  HttpExchange& operator=(const HttpExchange&) = delete;

  /// Reads request line and headers into request().
  [[nodiscard]] Result readHead();

  /// Reads the body into request().body. Call it once, after readHead() returned kOk.
  /// @param limit [byte]
  [[nodiscard]] Result readBody(std::size_t limit);

  [[nodiscard]] const HttpRequest& request() const { return request_; }
  [[nodiscard]] ClientStream& stream() { return stream_; }

  /// Sends the response; to a HEAD request without its body.
  void respond(const HttpResponse& response);

 private:
  struct Parser;

  [[nodiscard]] Result failure() const;

  ClientStream& stream_;
  std::unique_ptr<Parser> parser_;
  HttpRequest request_;
};

/// The client's side: the body of the response to GET `target`.
/// @param target must not contain spaces or line ends
/// @param timeout for everything, from connecting to the last byte
/// @param limit of head and body [byte]
/// @return nothing unless the status is 200 and the response is complete
[[nodiscard]] std::optional<std::string> httpGet(int port_on_loopback, std::string_view target,
                                                 std::chrono::milliseconds timeout,
                                                 std::size_t limit);

}  // namespace lab
