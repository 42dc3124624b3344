/// Non-blocking exchange of JSON objects, one per line.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace lab::runner {

/// Reads from one file descriptor and writes to another. Makes both non-blocking; does not close
/// them.
class JsonLines {
 public:
  JsonLines(int input, int output);

  /// Writes as much as possible without blocking; the next send() or flush() writes the rest.
  void send(const nlohmann::json& message);
  void flush();

  /// Calls `take` with every complete line that has arrived. Calls `noise` with lines that are not
  /// JSON objects and with those for which `take` throws a json::exception.
  /// @param most lines of one call; the others stay for the next one
  void receive(const std::function<void(const nlohmann::json&)>& take,
               const std::function<void(const std::string&)>& noise,
               std::size_t most = std::numeric_limits<std::size_t>::max());

  /// Whether a complete line has stayed for the next call of receive().
  [[nodiscard]] bool hasLine() const { return in_.find('\n') != std::string::npos; }

  /// Whether the other side has closed one of the descriptors.
  [[nodiscard]] bool closed() const { return closed_; }

  /// Number of bytes that are not written yet.
  [[nodiscard]] std::size_t waiting() const { return out_.size(); }

 private:
  int input_;
  int output_;
  std::string in_;
  std::string out_;
  bool closed_ = false;
};

/// Base64 (RFC 4648). decodedBytes() stops at the first character that is not a digit.
[[nodiscard]] std::string encodedBytes(std::string_view bytes);
[[nodiscard]] std::string decodedBytes(std::string_view text);

}  // namespace lab::runner
