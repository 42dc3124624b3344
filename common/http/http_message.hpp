/// HTTP requests and responses as plain data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/http/client_stream.hpp"

namespace lab {

/// Header fields in the order in which they were received or are sent.
using HttpHeaders = std::vector<std::pair<std::string, std::string>>;

struct HttpRequest {
  std::string method;
  std::string target;  ///< as sent, not decoded: "/api/runs/x?y=z"
  HttpHeaders headers;
  std::string body;
  std::string peer;   ///< numeric address of the client
  std::string local;  ///< numeric address that the client connected to

  /// The target without query and fragment, percent-decoded.
  [[nodiscard]] std::string path() const;

  /// The first value of a key of the query, decoded; empty if absent.
  [[nodiscard]] std::string query(std::string_view key) const;

  /// The first header of that name, in upper or lower case; empty if absent.
  [[nodiscard]] std::string_view header(std::string_view name) const;

  /// The number of headers of that name.
  [[nodiscard]] std::size_t headerCount(std::string_view name) const;
};

struct HttpResponse {
  /// Writes the next part of a body. @return whether there are more parts
  using Source = std::function<bool(ClientStream&)>;

  int status = 200;
  HttpHeaders headers{};
  std::string body{};
  Source source{};  ///< if set, it writes the body instead
  /// [byte]; if unknown, the body ends with the connection
  std::optional<std::uint64_t> source_length{};

  /// Sets a header and replaces an earlier one of that name.
  void setHeader(std::string_view name, std::string_view value);

  /// Sets the body and its Content-Type.
  void setBody(std::string_view type, std::string text);
};

/// Decodes %XX, and '+' as a space where `plus_is_space`. Incomplete escapes stay as they are.
[[nodiscard]] std::string percentDecoded(std::string_view text, bool plus_is_space);

}  // namespace lab
