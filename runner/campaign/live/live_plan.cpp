#include "runner/campaign/live/live_plan.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <ctime>

#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign {
namespace {

constexpr std::int64_t kDay_us = 86'400'000'000;
constexpr std::int64_t kMicroseconds = 1'000'000;

}  // namespace

KnownRule parseKnownRule(const std::string& text) {
  const std::size_t equals = text.find('=');
  const UserError error(fmt::format(
      "--known {}: expected QUANTITY=PERCENT with more than 0 %, as D_r_rad2_s=2%", text));
  if (equals == std::string::npos || equals == 0 || !text.ends_with('%')) throw error;
  double percent = 0;
  const char* const end = text.data() + text.size() - 1;
  const auto read = std::from_chars(text.data() + equals + 1, end, percent);
  if (read.ec != std::errc() || read.ptr != end || !(percent > 0) || !std::isfinite(percent)) {
    throw error;
  }
  return {text.substr(0, equals), percent / 100};
}

std::string knownRuleText(const KnownRule& rule) {
  return fmt::format("{}={}%", rule.quantity, rule.relative * 100);
}

std::int64_t parseUntil(const std::string& text, std::int64_t now_us) {
  const std::time_t now = now_us / kMicroseconds;
  std::tm local{};
  localtime_r(&now, &local);
  local.tm_sec = 0;
  local.tm_isdst = -1;
  const char* const day_end = strptime(text.c_str(), "%H:%M", &local);
  const bool time_of_day = day_end != nullptr && *day_end == '\0';
  if (!time_of_day) {
    std::tm date{};
    date.tm_isdst = -1;
    const char* const end = strptime(text.c_str(), "%Y-%m-%dT%H:%M", &date);
    if (end == nullptr || *end != '\0') {
      throw UserError(fmt::format(
          "--until {}: expected a time as 07:30 or a date as 2026-01-31T07:30, local time", text));
    }
    local = date;
  }
  std::int64_t until_us = static_cast<std::int64_t>(std::mktime(&local)) * kMicroseconds;
  if (time_of_day && until_us <= now_us) until_us += kDay_us;
  if (until_us <= now_us) throw UserError(fmt::format("--until {}: this time is past", text));
  return until_us;
}

}  // namespace lab::runner::campaign
