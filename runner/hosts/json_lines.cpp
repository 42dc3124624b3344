#include "runner/hosts/json_lines.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "common/text/json_text.hpp"

namespace lab::runner {
namespace {

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::size_t kLongestLine = 4'000'000;  // [byte] above: not from an agent

void unblock(int descriptor) {
  fcntl(descriptor, F_SETFL, fcntl(descriptor, F_GETFL) | O_NONBLOCK);
}

}  // namespace

JsonLines::JsonLines(int input, int output) : input_(input), output_(output) {
  unblock(input);
  unblock(output);
}

void JsonLines::send(const nlohmann::json& message) {
  if (closed_) return;
  out_ += message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  out_ += '\n';
  flush();
}

void JsonLines::flush() {
  std::size_t sent = 0;
  while (!closed_ && sent < out_.size()) {
    const ssize_t written = write(output_, out_.data() + sent, out_.size() - sent);
    if (written > 0) {
      sent += static_cast<std::size_t>(written);
    } else if (errno != EINTR) {
      closed_ = errno != EAGAIN && errno != EWOULDBLOCK;
      break;
    }
  }
  out_.erase(0, sent);
}

void JsonLines::receive(const std::function<void(const nlohmann::json&)>& take,
                        const std::function<void(const std::string&)>& noise, std::size_t most) {
  std::array<char, 65536> buffer;
  while (in_.size() <= kLongestLine) {
    const ssize_t got = read(input_, buffer.data(), buffer.size());
    if (got > 0) {
      in_.append(buffer.data(), static_cast<std::size_t>(got));
    } else {
      if (got < 0 && errno == EINTR) continue;
      closed_ = closed_ || got == 0 || (errno != EAGAIN && errno != EWOULDBLOCK);
      break;
    }
  }
  // Removed before the handlers run, so that an exception does not cause a line to be read twice.
  std::size_t size = 0;
  for (std::size_t count = 0; count < most; ++count) {
    const std::size_t last = in_.find('\n', size);
    if (last == std::string::npos) break;
    size = last + 1;
  }
  const std::string lines = in_.substr(0, size);
  in_.erase(0, size);
  if (in_.size() > kLongestLine && !hasLine()) in_.clear();
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = lines.find('\n', begin)) != std::string::npos; begin = end + 1) {
    const std::string line = lines.substr(begin, end - begin);
    const auto json = parseJsonText(line);
    if (!json.is_object()) {
      noise(line);
      continue;
    }
    try {
      take(json);
    } catch (const nlohmann::json::exception&) {  // a value of an unexpected type
      noise(line);
    }
  }
}

std::string encodedBytes(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : kDigits[three >> (18 - 6 * k) & 63U];
    }
  }
  return text;
}

std::string decodedBytes(std::string_view text) {
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char digit : text) {
    const std::size_t value = kDigits.find(digit);
    if (value == std::string_view::npos) break;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    if ((count += 6) >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 255U);
  }
  return bytes;
}

}  // namespace lab::runner
