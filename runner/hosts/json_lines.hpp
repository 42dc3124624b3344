/// A conversation in JSON, one object a line, that never waits.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace lab::runner {

/// Reads and writes a pair of descriptors, which it makes non-blocking and which stay their
/// owner's.
class JsonLines {
 public:
  JsonLines(int input, int output);

  /// Sends as much as can be sent now; the rest goes with the next send() or flush().
  void send(const nlohmann::json& message);
  void flush();

  /// Hands over every whole line that has come. What is no JSON object, or one that `take` throws a
  /// json::exception at, is handed to `noise`.
  void receive(const std::function<void(const nlohmann::json&)>& take,
               const std::function<void(const std::string&)>& noise);

  /// Whether the other side has closed, in either direction.
  [[nodiscard]] bool closed() const { return closed_; }

  /// What waits to be sent [byte].
  [[nodiscard]] std::size_t waiting() const { return out_.size(); }

 private:
  int input_;
  int output_;
  std::string in_;
  std::string out_;
  bool closed_ = false;
};

/// Bytes as text that JSON carries, and back. decoded() of what is no such text is short.
[[nodiscard]] std::string encodedBytes(std::string_view bytes);
[[nodiscard]] std::string decodedBytes(std::string_view text);

}  // namespace lab::runner
