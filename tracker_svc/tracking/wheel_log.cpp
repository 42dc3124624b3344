#include "tracker_svc/tracking/wheel_log.hpp"

#include <algorithm>
#include <cmath>

namespace lab::tracker {
namespace {

double square(double x) { return x * x; }

}  // namespace

void WheelLog::add(double time, double left, double right) {
  if (!std::isfinite(time) || !std::isfinite(left) || !std::isfinite(right)) return;
  auto place = reports_.end();
  while (place != reports_.begin() && (place - 1)->time >= time) --place;
  if (place != reports_.end() && place->time == time) return;
  reports_.insert(place, {time, left, right});
}

void WheelLog::forgetBefore(double time) {
  // In chunks, because erasing at the front moves all elements.
  if (reports_.size() < 64 || reports_[reports_.size() / 2].time > time) return;
  reports_.erase(reports_.begin(),
                 reports_.begin() + static_cast<std::ptrdiff_t>(reports_.size() / 2));
}

void WheelLog::segments(double begin, double end, std::vector<WheelSegment>& out) const {
  out.clear();
  if (reports_.size() < 2 || end <= begin) return;
  auto next =
      std::upper_bound(reports_.begin(), reports_.end(), begin,
                       [](double time, const Report& report) { return time < report.time; });
  if (next == reports_.begin()) ++next;
  for (; next != reports_.end() && (next - 1)->time < end; ++next) {
    const Report& before = *(next - 1);
    const double gap = next->time - before.time;
    if (gap > kLongestGap) continue;
    WheelSegment stretch;
    stretch.begin = std::max(begin, before.time);
    stretch.end = std::min(end, next->time);
    // The speed changed at an unknown instant between the two reports, uniformly distributed.
    const double share = ((stretch.begin + stretch.end) / 2 - before.time) / gap;
    stretch.left_from = before.left;
    stretch.right_from = before.right;
    stretch.left_step = next->left - before.left;
    stretch.right_step = next->right - before.right;
    stretch.left = before.left + share * stretch.left_step;
    stretch.right = before.right + share * stretch.right_step;
    out.push_back(stretch);
  }
}

WheelPath WheelLog::path(double begin, double end) const {
  static thread_local std::vector<WheelSegment> parts;
  // Changes shortly before and after contribute through the error of their times.
  segments(begin - kTimeError, end + kTimeError, parts);
  WheelPath path;
  double covered = 0;
  for (const WheelSegment& part : parts) {
    const double inside = std::max(0.0, std::min(part.end, end) - std::max(part.begin, begin));
    const double when = square(part.end - part.begin) / 12 + square(kTimeError);
    covered += inside;
    path.changed = path.changed || std::abs(part.left_step) > kSpeedStep ||
                   std::abs(part.right_step) > kSpeedStep;
    path.left += part.left * inside;
    path.right += part.right * inside;
    path.left_variance += square(part.left_step) * when;
    path.right_variance += square(part.right_step) * when;
  }
  const double time = end - begin;
  path.known = time > 0 && covered > 0.999 * time;
  path.left_variance += randomVariance(path.left, time);
  path.right_variance += randomVariance(path.right, time);
  if (!parts.empty()) {
    const WheelSegment& first = parts.front();
    const WheelSegment& last = parts.back();
    path.first_left = first.left_from * time;
    path.first_right = first.right_from * time;
    path.last_left = (last.left_from + last.left_step) * time;
    path.last_right = (last.right_from + last.right_step) * time;
  }
  return path;
}

}  // namespace lab::tracker
