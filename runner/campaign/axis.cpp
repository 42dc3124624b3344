#include "runner/campaign/axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <set>

#include "common/files/file_values.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {
namespace {

constexpr std::size_t kMostValues = 100'000;
constexpr int kRangeDigits = 12;  // of the values of a range, so that 0.1:0.9:9 gives 0.3

constexpr const char* kForms =
    "key=1,2,3 or key=0.1:0.9:9 (low:high:count, also with :log, :whole or :round=0.01 at the end) "
    "or, with --random, key=0.1:0.9";

/// @param text the option with its value
[[noreturn]] void refuse(std::string_view text, const std::string& why) {
  throw UserError(fmt::format("{}: {}", text, why));
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Splits at `separator` where it is outside of brackets and quotes.
std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  std::size_t begin = 0;
  int depth = 0;
  char quote = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char letter = text[i];
    if (quote != 0) {
      if (letter == quote) quote = 0;
    } else if (letter == '"' || letter == '\'') {
      quote = letter;
    } else if (letter == '[' || letter == '{') {
      ++depth;
    } else if (letter == ']' || letter == '}') {
      --depth;
    } else if (letter == separator && depth == 0) {
      parts.push_back(trimmed(text.substr(begin, i - begin)));
      begin = i + 1;
    }
  }
  parts.push_back(trimmed(text.substr(begin)));
  return parts;
}

/// Takes ":log", ":whole" and ":round=STEP" from the end.
/// @return whether it was one of them
bool takeOption(std::string_view part, DrawnRange& range, std::string_view whole) {
  constexpr std::string_view kRound = "round=";
  if (part == "log") {
    range.logarithmic = true;
  } else if (part == "whole") {
    range.step = 1;
  } else if (part.starts_with(kRound)) {
    const auto step = numberIn(part.substr(kRound.size()));
    if (!step || !(*step > 0)) {
      refuse(whole, fmt::format("found {}, expected a positive number after round=", part));
    }
    range.step = *step;
  } else {
    return false;
  }
  return true;
}

/// low:high[:count][:log][:whole]; nothing if the text has another form.
std::optional<Axis> rangeIn(std::string_view text, const std::string& key, std::string_view whole) {
  std::vector<std::string_view> parts = split(text, ':');
  if (parts.size() < 2) return {};
  DrawnRange range;
  while (parts.size() > 2 && takeOption(parts.back(), range, whole)) parts.pop_back();
  const auto low = numberIn(parts[0]);
  const auto high = numberIn(parts[1]);
  if (parts.size() > 3 || !low || !high) return {};
  range.low = *low;
  range.high = *high;
  if (!(range.low < range.high)) {
    refuse(whole,
           fmt::format("found a range from {} to {}, expected one that rises", parts[0], parts[1]));
  }
  if (range.logarithmic && !(range.low > 0)) {
    refuse(whole, fmt::format("found {} with :log, expected a positive number", parts[0]));
  }
  Axis axis{key, {}, range};
  if (parts.size() == 2) return axis;
  const auto count = numberIn(parts[2]);
  if (!count || *count != std::floor(*count) || !(*count >= 2) ||
      !(*count <= static_cast<double>(kMostValues))) {
    refuse(whole, fmt::format("found the count {}, expected 2 to {}", parts[2], kMostValues));
  }
  axis.range.reset();
  const auto steps = static_cast<std::size_t>(*count) - 1;
  for (std::size_t i = 0; i <= steps; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(steps);
    const double value = range.logarithmic ? range.low * std::pow(range.high / range.low, share)
                                           : range.low + (range.high - range.low) * share;
    axis.values.push_back(rangeValue(range, value));
  }
  return axis;
}

void requireDifferent(const Axis& axis, std::string_view text) {
  std::set<std::string> seen;
  for (const std::string& value : axis.values) {
    if (!seen.insert(value).second) {
      refuse(text, fmt::format("found {} twice, expected different values", value));
    }
  }
}

/// Keys that decide a run's random numbers or its name.
void requireSweepable(const std::string& key, std::string_view text) {
  if (key == "seed") refuse(text, "each run has its own seed; for several runs a point: --seeds N");
  if (key == "fileversion" || key == "name" || key.starts_with("sweep")) {
    refuse(text, key + " cannot be swept");
  }
}

std::string lastPart(const std::string& key) {
  const std::size_t dot = key.find_last_of('.');
  return dot == std::string::npos ? key : key.substr(dot + 1);
}

}  // namespace

bool Axis::isNumeric() const {
  return range.has_value() ||
         std::ranges::all_of(values, [](const std::string& v) { return numberIn(v).has_value(); });
}

std::string Axis::symbol() const {
  std::string name = lastPart(key);
  const std::string_view suffix = keys::unitOf(name).suffix;
  if (!suffix.empty() && name.ends_with(suffix)) name.erase(name.size() - suffix.size());
  return name;
}

std::string Axis::unit() const { return std::string(keys::unitOf(lastPart(key)).text); }

std::string rangeValue(const DrawnRange& range, double value) {
  const double rounded = range.step > 0 ? std::round(value / range.step) * range.step : value;
  return keys::numberText(keys::roundedToDigits(rounded, kRangeDigits));
}

std::optional<double> numberIn(std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const char* begin = text.data();
  if (text.starts_with('+')) ++begin;
  const auto read = std::from_chars(begin, end, value);
  if (read.ec != std::errc() || read.ptr != end || !std::isfinite(value)) return {};
  return value;
}

Axis parseAxis(std::string_view text, std::string_view option) {
  const std::string quoted = fmt::format("{} {}", option, text);
  const std::size_t equals = text.find('=');
  const std::string key(trimmed(text.substr(0, std::min(equals, text.size()))));
  if (equals == std::string_view::npos || key.empty()) {
    refuse(quoted, fmt::format("found no key with values, expected {}", kForms));
  }
  requireSweepable(key, quoted);
  const std::string_view values = trimmed(text.substr(equals + 1));
  if (auto range = rangeIn(values, key, quoted)) {
    requireDifferent(*range, quoted);
    return *range;
  }
  Axis axis{key, {}, {}};
  for (const std::string_view value : split(values, ',')) {
    if (value.empty()) refuse(quoted, fmt::format("found an empty value, expected {}", kForms));
    axis.values.emplace_back(value);
  }
  if (axis.values.size() > kMostValues) {
    refuse(quoted, fmt::format("found {} values, allowed {}", axis.values.size(), kMostValues));
  }
  requireDifferent(axis, quoted);
  return axis;
}

std::vector<Axis> parseAxes(const std::vector<std::string>& texts, std::string_view option) {
  std::vector<Axis> axes;
  for (const std::string& text : texts) {
    Axis axis = parseAxis(text, option);
    const bool twice =
        std::ranges::any_of(axes, [&](const Axis& other) { return other.key == axis.key; });
    if (twice) {
      refuse(fmt::format("{} {}", option, text), "found the key twice, expected each key once");
    }
    axes.push_back(std::move(axis));
  }
  return axes;
}

}  // namespace lab::runner::campaign
