#include "common/text/printable.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "common/text/utf8.hpp"

namespace lab {
namespace {

std::string escape(const char* format, unsigned value) {
  std::array<char, 8> digits{};
  std::snprintf(digits.data(), digits.size(), format, value);
  return digits.data();
}

/// Whether a character changes the direction of text (Unicode bidirectional algorithm, 2).
bool turnsText(unsigned code) {
  return (code >= 0x202A && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069);
}

std::string escaped(std::string text, std::string_view kept) {
  repairUtf8(text);
  const auto byte = [&text](std::size_t i) -> unsigned {
    return i < text.size() ? static_cast<std::uint8_t>(text[i]) : 0;
  };
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool ascii_control = byte(i) < 0x20 || byte(i) == 0x7F;
    const unsigned three =
        (byte(i) & 0xFU) << 12 | (byte(i + 1) & 0x3FU) << 6 | (byte(i + 2) & 0x3FU);
    if (ascii_control && kept.find(text[i]) == std::string_view::npos) {
      result += escape("\\x%02x", byte(i));
    } else if (byte(i) == 0xC2 && byte(i + 1) < 0xA0) {  // U+0080 to U+009F
      result += escape("\\x%02x", byte(++i));
    } else if (byte(i) == 0xE2 && turnsText(three)) {
      result += escape("\\u%04x", three);
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result;
}

}  // namespace

std::string printable(std::string_view text) { return escaped(std::string(text), ""); }

std::string printableLines(std::string_view text) { return escaped(std::string(text), "\n\t"); }

}  // namespace lab
