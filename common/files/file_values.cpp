#include "common/files/file_values.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace lab::keys {
namespace {

constexpr int kMostDigits = std::numeric_limits<double>::max_digits10;
constexpr double kPi = std::numbers::pi;

// Longer suffixes come before the suffixes that they end in.
constexpr std::array<FileUnit, 14> kUnits = {{
    {"_cm_sqrt_s", "cm/sqrt(s)", 1, 100},
    {"_deg_sqrt_s", "deg/sqrt(s)", kPi, 180},
    {"_cm2_s", "cm^2/s", 1, 10000},
    {"_cm_s", "cm/s", 1, 100},
    {"_deg_s", "deg/s", kPi, 180},
    {"_rad_s", "rad/s", 1, 1},
    {"_per_s", "1/s", 1, 1},
    {"_ms", "ms", 1, 1000},
    {"_s", "s", 1, 1},
    {"_cm", "cm", 1, 100},
    {"_deg", "deg", kPi, 180},
    {"_hz", "1/s", 1, 1},
    {"_percent", "%", 1, 100},
    {"", "", 1, 1},
}};

std::optional<double> shortestThatGives(double si, double near, const FileUnit& unit) {
  for (int digits = 1; digits <= kMostDigits; ++digits) {
    const double candidate = roundedToDigits(near, digits);
    if (toSi(candidate, unit) == si) return candidate;
  }
  return {};
}

/// The shortest number that converts to exactly `si`, if there is one.
std::optional<double> numberFor(double si, const FileUnit& unit) {
  const double near = si * unit.divide / unit.multiply;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double start :
       {near, std::nextafter(near, -kInfinity), std::nextafter(near, kInfinity)}) {
    if (const auto found = shortestThatGives(si, start, unit)) return found;
  }
  return {};
}

}  // namespace

const FileUnit& unitOf(std::string_view key) {
  for (const FileUnit& unit : kUnits) {
    if (key.ends_with(unit.suffix)) return unit;
  }
  return kUnits.back();
}

double toSi(double file_value, const FileUnit& unit) {
  return file_value * unit.multiply / unit.divide;
}

double roundedToDigits(double value, int digits) {
  std::array<char, 64> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value,
                                     std::chars_format::scientific, digits - 1);
  double rounded = value;
  std::from_chars(text.data(), written.ptr, rounded);
  return rounded;
}

std::string numberText(double value) {
  if (value == 0) return "0";
  const double size = std::abs(value);
  std::array<char, 64> text{};
  const auto format =
      size >= 1e-5 && size < 1e15 ? std::chars_format::fixed : std::chars_format::scientific;
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value, format);
  return {text.data(), written.ptr};
}

std::string fileText(double si, const FileUnit& unit) {
  if (!std::isfinite(si)) return numberText(si);
  if (const auto found = numberFor(si, unit)) return numberText(*found);
  const double near = si * unit.divide / unit.multiply;
  return numberText(numberFor(toSi(near, unit), unit).value_or(near));
}

std::string centimetreText(double metre) {
  constexpr double kDigits = 1e9;
  return numberText(std::round(metre * 100 * kDigits) / kDigits);
}

bool isBareName(std::string_view text, std::size_t most, std::string_view signs) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789";
  return !text.empty() && text.size() <= most && letters.find(text.front()) != std::string::npos &&
         text.find_first_not_of(letters + std::string(signs)) == std::string_view::npos;
}

std::string tomlString(std::string_view text) {
  std::string result = "\"";
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    if (letter == '"' || letter == '\\') {
      result += std::string("\\") + letter;
    } else if (letter == '\n') {
      result += "\\n";
    } else if (code < ' ' || code == 0x7f) {
      constexpr std::string_view kDigits = "0123456789ABCDEF";
      result += "\\u00";
      result += kDigits[code / 16];
      result += kDigits[code % 16];
    } else {
      result += letter;
    }
  }
  return result + '"';
}

}  // namespace lab::keys
