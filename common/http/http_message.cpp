#include "common/http/http_message.hpp"

#include <strings.h>

#include <algorithm>
#include <charconv>

namespace lab {
namespace {

bool isSameHeader(std::string_view a, std::string_view b) {
  return a.size() == b.size() && strncasecmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace

std::string percentDecoded(std::string_view text, bool plus_is_space) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size()) {
      unsigned char byte = 0;
      const char* const digits = text.data() + i + 1;
      const auto [end, error] = std::from_chars(digits, digits + 2, byte, 16);
      if (error == std::errc() && end == digits + 2) {
        decoded.push_back(static_cast<char>(byte));
        i += 2;
        continue;
      }
    }
    decoded.push_back(plus_is_space && text[i] == '+' ? ' ' : text[i]);
  }
  return decoded;
}

std::string HttpRequest::path() const {
  return percentDecoded(std::string_view(target).substr(0, target.find_first_of("?#")), false);
}

std::string HttpRequest::query(std::string_view key) const {
  std::string_view rest(target);
  rest = rest.substr(0, rest.find('#'));
  const std::size_t mark = rest.find('?');
  rest = mark == std::string_view::npos ? std::string_view() : rest.substr(mark + 1);
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(rest.size(), pair.size() + 1));
    const std::size_t equals = pair.find('=');
    if (percentDecoded(pair.substr(0, equals), true) != key) continue;
    if (equals == std::string_view::npos) return {};
    return percentDecoded(pair.substr(equals + 1), true);
  }
  return {};
}

std::string_view HttpRequest::header(std::string_view name) const {
  for (const auto& [key, value] : headers) {
    if (isSameHeader(key, name)) return value;
  }
  return {};
}

std::size_t HttpRequest::headerCount(std::string_view name) const {
  return static_cast<std::size_t>(std::ranges::count_if(
      headers, [name](const auto& header) { return isSameHeader(header.first, name); }));
}

void HttpResponse::setHeader(std::string_view name, std::string_view value) {
  for (auto& [key, old] : headers) {
    if (!isSameHeader(key, name)) continue;
    old = value;
    return;
  }
  headers.emplace_back(name, value);
}

void HttpResponse::setBody(std::string_view type, std::string text) {
  setHeader("Content-Type", type);
  body = std::move(text);
}

}  // namespace lab
