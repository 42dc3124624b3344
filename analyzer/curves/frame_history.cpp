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
  // Every join shifts the slots against free time by a fraction of a period: correct the guess.
  std::optional<Fix> near;
  for (int back = 0; back < kSearch && !near; ++back) {
    near = find(guess - back);
  }
  if (!near) {
    return std::nullopt;
  }
  const std::int64_t centre = near->slot - std::lround((near->time - time) / period);
  std::optional<Fix> after;
  for (std::int64_t slot = centre + kSearch / 2; slot >= centre - kSearch / 2; --slot) {
    const std::optional<Fix> fix = find(slot);
    if (!fix) {
      continue;
    }
    if (fix->time > time) {
      after = fix;
      continue;
    }
    if (!after || after->time - fix->time > kBracket * period) {
      return std::nullopt;
    }
    const double w = (time - fix->time) / (after->time - fix->time);
    return Fix{fix->slot, time, fix->x + w * (after->x - fix->x), fix->y + w * (after->y - fix->y),
               fix->theta + w * (after->theta - fix->theta)};
  }
  return std::nullopt;
}

}  // namespace lab::analysis
