#include "common/text/format.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "common/math/saturated.hpp"

namespace lab {
namespace {

constexpr const char* kNone = "–";

struct UnitRow {
  std::string_view si;
  std::string_view text;
  std::string_view key;
  double factor;
};

constexpr std::array kUnits{UnitRow{"m", "cm", "cm", 1e2},
                            UnitRow{"m^2", "cm²", "cm2", 1e4},
                            UnitRow{"m/s", "cm/s", "cm_s", 1e2},
                            UnitRow{"m^2/s", "cm²/s", "cm2_s", 1e4},
                            UnitRow{"m^2/s^2", "cm²/s²", "cm2_s2", 1e4},
                            UnitRow{"rad", "rad", "rad", 1},
                            UnitRow{"rad^2", "rad²", "rad2", 1},
                            UnitRow{"rad/s", "rad/s", "rad_s", 1},
                            UnitRow{"rad^2/s", "rad²/s", "rad2_s", 1},
                            UnitRow{"1/s", "1/s", "per_s", 1},
                            UnitRow{"s", "s", "s", 1},
                            UnitRow{"1", "", "", 1},
                            UnitRow{"", "", "", 1}};

/// A unit of metres, seconds and others in centimetres: "1/(m s^2)" as "1/(cm s²)".
DisplayUnit inCentimetres(const std::string& si_unit) {
  constexpr std::string_view kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789";
  DisplayUnit unit;
  int sign = 1;
  for (std::size_t at = 0; at < si_unit.size();) {
    if (kLetters.find(si_unit[at]) == std::string_view::npos) {
      if (si_unit[at] == '/') {
        sign = -1;
        unit.key = unit.key == "1" ? "per" : unit.key;
      }
      unit.text += si_unit[at++];
      continue;
    }
    const std::size_t end = std::min(si_unit.find_first_not_of(kLetters, at), si_unit.size());
    std::string word = si_unit.substr(at, end - at);
    at = end;
    int exponent = 1;
    if (at + 1 < si_unit.size() && si_unit[at] == '^' && si_unit[at + 1] >= '2' &&
        si_unit[at + 1] <= '9') {
      exponent = si_unit[at + 1] - '0';
      at += 2;
    }
    if (word == "m") {
      word = "cm";
      unit.factor *= std::pow(100.0, sign * exponent);
    }
    unit.text += word;
    unit.key += (unit.key.empty() ? "" : "_") + word;
    if (exponent > 1) {
      unit.text += exponent == 2 ? "²" : exponent == 3 ? "³" : "^" + std::to_string(exponent);
      unit.key += std::to_string(exponent);
    }
  }
  return unit;
}

std::string withoutTrailingZeros(std::string text) {
  if (text.find('.') == std::string::npos || text.find('e') != std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

/// The number of decimals that shows `figures` significant figures of a number of this size.
int decimalsFor(double size, int figures) {
  return saturated<int>(std::clamp(figures - 1 - std::floor(std::log10(size)), 0.0, 12.0));
}

bool isPlain(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
         (letter >= '0' && letter <= '9') || letter == '-' || letter == '_';
}

}  // namespace

DisplayUnit displayUnit(const std::string& si_unit) {
  for (const UnitRow& row : kUnits) {
    if (row.si == si_unit) return {std::string(row.text), std::string(row.key), row.factor};
  }
  if (si_unit.find_first_of("/^") == std::string::npos) {
    return {si_unit, sanitizedFileName(si_unit), 1};
  }
  return inCentimetres(si_unit);
}

std::string quantityText(double value, const std::string& si_unit, int digits) {
  const DisplayUnit unit = displayUnit(si_unit);
  const std::string number = fmt::format("{:.{}g}", value * unit.factor, digits);
  return unit.text.empty() ? number : number + " " + unit.text;
}

std::string valueText(double value, double error) {
  if (!std::isfinite(value)) return kNone;
  if (!std::isfinite(error) || error <= 0) return shortText(value);
  return fmt::format("{:.{}f}", value, decimalsFor(error, 2));
}

std::string shortText(double value) {
  if (!std::isfinite(value)) return kNone;
  const double size = std::abs(value);
  if (size == 0) return "0";
  if (size < 1e-4 || size >= 1e6) return fmt::format("{:.3e}", value);
  return withoutTrailingZeros(fmt::format("{:.{}f}", value, decimalsFor(size, 4)));
}

std::string durationText(double seconds) {
  if (!std::isfinite(seconds)) return kNone;
  if (seconds < 0) return fmt::format("-{}", durationText(-seconds));
  if (seconds < 99.95) return withoutTrailingZeros(fmt::format("{:.1f}", seconds)) + " s";
  const auto whole = saturated<std::int64_t>(std::round(seconds));
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::string countText(std::int64_t count, std::string_view noun) {
  return fmt::format("{} {}{}", groupedText(count), noun, count == 1 ? "" : "s");
}

std::string groupedText(std::int64_t count) {
  const auto size = static_cast<std::uint64_t>(count);
  const std::string digits = std::to_string(count < 0 ? 0 - size : size);
  std::string text;
  if (count < 0) text += '-';
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += "\u202f";
    text += digits[i];
  }
  return text;
}

std::string utcText(std::int64_t utime) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC",
                     fmt::gmtime(static_cast<std::time_t>(utime / 1'000'000)));
}

std::string symbolHtml(const std::string& name) {
  const std::size_t bar = name.find('_');
  std::string letter = name.substr(0, bar);
  if (letter == "gamma") letter = "γ";
  if (letter == "tau") letter = "τ";
  if (letter == "epsilon") letter = "ε";
  if (letter == "eta") letter = "η";
  if (letter == "omega") letter = "ω";
  const std::string index = bar == std::string::npos ? "" : name.substr(bar + 1);
  return fmt::format("<i>{}</i>{}", escapeHtml(letter),
                     index.empty() ? "" : fmt::format("<sub>{}</sub>", escapeHtml(index)));
}

std::string escapeHtml(std::string_view text) {
  std::string html;
  html.reserve(text.size());
  for (const char letter : text) {
    switch (letter) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      case '\'':
        html += "&#39;";
        break;
      default:
        if (static_cast<unsigned char>(letter) >= 0x20 || letter == '\n') html += letter;
    }
  }
  return html;
}

std::string sanitizedFileName(std::string_view text) {
  std::string word;
  for (const char letter : text) {
    if (isPlain(letter)) word += letter;
    if (letter == ' ') word += '_';
  }
  return word.empty() ? "program" : word;
}

bool isSpreadsheetFormula(std::string_view text) { return text.find_first_of("=+-@\t\r") == 0; }

}  // namespace lab
