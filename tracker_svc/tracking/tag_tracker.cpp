#include "tracker_svc/tracking/tag_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lab::tracker {

TagTracker::TagTracker(double max_speed, std::vector<std::int32_t> robot_ids)
    : max_speed_(max_speed), robot_ids_(std::move(robot_ids)) {}

const std::vector<detector::Expected>& TagTracker::expect(double time) {
  constexpr double kFaster = 1.1;     // [1] times the speed: gain errors, pushes
  constexpr double kSlack = 0.005;    // [m]
  constexpr double kFarthest = 0.15;  // [m]
  expected_.clear();
  for (const Track& track : tracks_) {
    const double elapsed = std::max(0.0, time - known_.at(track.pose.tag).last);
    expected_.push_back({track.pose.x, track.pose.y, track.pose.theta,
                         std::min(kFarthest, kFaster * max_speed_ * elapsed + kSlack),
                         std::numbers::pi});
  }
  return expected_;
}

const std::vector<Track>& TagTracker::update(double time,
                                             std::span<const detector::Detection> detections) {
  for (auto& [tag, known] : known_) {
    known.track.detected = false;
    known.track.pose.quality = 0;
    known.track.pose.used = 0;
    known.track.since_detection = time - known.last;
  }
  for (const detector::Detection& detection : detections) {
    if (!(detection.quality > 0) || detection.tag < 0 || !std::isfinite(detection.x) ||
        !std::isfinite(detection.y) || !std::isfinite(detection.theta)) {
      continue;
    }
    const auto [at, is_new] = known_.try_emplace(detection.tag);
    Track& track = at->second.track;
    const bool is_robot =
        std::find(robot_ids_.begin(), robot_ids_.end(), detection.tag) != robot_ids_.end();
    if (is_new && is_robot) ++counts_.bound;
    track = {detection.tag + std::int64_t{1}, is_robot ? detection.tag : -1, detection, true, 0};
    at->second.last = time;
  }
  counts_.lost += static_cast<std::int64_t>(
      std::erase_if(known_, [&](const auto& entry) { return time - entry.second.last > kGiveUp; }));
  tracks_.clear();
  for (const auto& [tag, known] : known_) tracks_.push_back(known.track);
  return tracks_;
}

}  // namespace lab::tracker
