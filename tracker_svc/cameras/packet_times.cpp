#include "tracker_svc/cameras/packet_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>
#include <utility>

#include "common/bus/value_checker.hpp"
#include "common/camera/run_film.hpp"

namespace lab::cameras {
namespace {

constexpr double kLatest = static_cast<double>(ValueChecker::kLatestUtime) * 1e-6;
constexpr double kEarliest = -static_cast<double>(kLongestFilm_us) * 1e-6;

/// The value of an entry, as "0.040000" of "pts_time=0.040000|flags=K_"; empty if it has none.
std::string_view entryOf(std::string_view line, std::string_view key) {
  while (!line.empty()) {
    const std::string_view entry = line.substr(0, line.find('|'));
    line.remove_prefix(std::min(line.size(), entry.size() + 1));
    if (entry.starts_with(key) && entry.substr(key.size()).starts_with('=')) {
      return entry.substr(key.size() + 1);
    }
  }
  return {};
}

/// [s]; nothing for "N/A"
std::optional<double> timeOf(std::string_view text) {
  double time = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), time);
  if (error == std::errc::result_out_of_range) return HUGE_VAL;
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return std::isnan(time) ? HUGE_VAL : time;
}

}  // namespace

bool PacketTimes::add(std::string_view line) {
  const std::string_view shown = entryOf(line, "pts_time");
  const std::string_view decoded = entryOf(line, "dts_time");
  if (shown.empty() && decoded.empty()) return true;
  if (utimes_.size() + static_cast<std::size_t>(never_shown_) == most_) return false;
  if (entryOf(line, "flags").find('D') != std::string_view::npos) {
    ++never_shown_;
    return true;
  }
  const double time = timeOf(shown).value_or(timeOf(decoded).value_or(0));
  const bool first = utimes_.empty();
  earliest_ = first ? time : std::min(earliest_, time);
  latest_ = first ? time : std::max(latest_, time);
  utimes_.push_back(std::llround(std::clamp(time, kEarliest, kLatest) * 1e6));
  return true;
}

std::vector<std::int64_t> PacketTimes::take() {
  std::vector<std::int64_t> utimes = std::exchange(utimes_, {});
  std::sort(utimes.begin(), utimes.end());
  const auto gap = std::adjacent_find(
      utimes.begin(), utimes.end(),
      [](std::int64_t one, std::int64_t next) { return next - one > kLongestFilm_us; });
  problem_.clear();
  if (earliest_ < kEarliest || latest_ > kLatest) {
    problem_ = fmt::format("found a frame at {:g} s, expected {:g} s to {:g} s (the year 2100)",
                           latest_ > kLatest ? latest_ : earliest_, kEarliest, kLatest);
  } else if (gap != utimes.end()) {
    problem_ = fmt::format("found {:g} s between two frames, expected at most {:g} s (11 days)",
                           static_cast<double>(*(gap + 1) - *gap) * 1e-6, -kEarliest);
  }
  if (utimes.empty()) return utimes;
  const std::int64_t first = utimes.front();
  for (std::int64_t& utime : utimes) utime -= first;
  return utimes;
}

}  // namespace lab::cameras
