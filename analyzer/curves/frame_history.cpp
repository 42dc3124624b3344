#include "analyzer/curves/frame_history.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

constexpr int kSearch = 8;  // slots
constexpr double kLost = units::kNan;

}  // namespace

void FrameHistory::shift(std::size_t slots) {
  for (Values* values : {&time_, &x_, &y_, &theta_}) {
    std::copy(values->data() + slots, values->data() + end(), values->data());
  }
}

void FrameHistory::retire() {
  shift(count_);
  first_ += static_cast<std::int64_t>(count_);
  count_ = 0;
}

void FrameHistory::lose(std::int64_t slots) {
  const auto lost = static_cast<std::size_t>(std::min<std::int64_t>(slots, kHistory));
  shift(lost);
  std::fill_n(time_.data() + (kHistory - lost), lost, kLost);
  first_ += slots;
}

void FrameHistory::forget() { time_.fill(kLost); }

std::optional<Fix> FrameHistory::find(std::int64_t slot) const {
  if (slot < first_ - static_cast<std::int64_t>(kHistory) || slot > newest()) return std::nullopt;
  const Fix fix = at(static_cast<std::size_t>(slot - first_ + static_cast<std::int64_t>(kHistory)));
  return std::isnan(fix.time) ? std::nullopt : std::optional<Fix>(fix);
}

std::optional<Fix> FrameHistory::interpolated(double time, std::int64_t guess,
                                              double period) const {
  const std::int64_t oldest = first_ - static_cast<std::int64_t>(kHistory);
  const auto timeAt = [&](std::int64_t slot) {
    return slot < oldest || slot > newest() ? kLost
                                            : time_[static_cast<std::size_t>(slot - oldest)];
  };
  // Every join shifts the slots against free time by a fraction of a period: correct the guess.
  std::int64_t near = guess;
  while (near > guess - kSearch && std::isnan(timeAt(near))) --near;
  if (near == guess - kSearch) return std::nullopt;
  const std::int64_t centre = near - std::lround((timeAt(near) - time) / period);
  std::int64_t after = 0;
  double end = kLost;
  for (std::int64_t slot = centre + kSearch / 2; slot >= centre - kSearch / 2; --slot) {
    const double begin = timeAt(slot);
    if (std::isnan(begin)) continue;
    if (begin > time) {
      after = slot;
      end = begin;
      continue;
    }
    if (!(end - begin <= kBracket * period)) return std::nullopt;
    const Fix from = at(static_cast<std::size_t>(slot - oldest));
    const Fix to = at(static_cast<std::size_t>(after - oldest));
    const double w = (time - begin) / (end - begin);
    return Fix{slot, time, from.x + w * (to.x - from.x), from.y + w * (to.y - from.y),
               from.theta + w * (to.theta - from.theta)};
  }
  return std::nullopt;
}

}  // namespace lab::analysis
