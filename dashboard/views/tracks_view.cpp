#include "dashboard/views/tracks_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "common/math/units.hpp"
#include "dashboard/views/plausible_pose.hpp"
#include "dashboard/web/json.hpp"

namespace lab::dashboard {
namespace {

constexpr float kCm = 100;

}  // namespace

void TracksView::take(const tracked_frame_t& frame) {
  const std::int64_t number = frame.utime / kStep_us;
  if (!steps_.empty() && number <= steps_.back().number) {
    const bool set_back = number + static_cast<std::int64_t>(kSteps) < steps_.back().number;
    if (!set_back) return;
    steps_.clear();
  }
  Step step;
  step.number = number;
  step.utime = frame.utime;
  for (const tracked_pose_t& pose : frame.robots) {
    if (step.places.size() == kMaxRobots) break;
    if (!isPlausiblePose(pose)) continue;
    step.places.push_back({pose.robot_id, static_cast<float>(pose.x), static_cast<float>(pose.y)});
  }
  steps_.push_back(std::move(step));
  while (number - steps_.front().number >= static_cast<std::int64_t>(kSteps)) steps_.pop_front();
}

std::string TracksView::trailsJson() const {
  struct Trail {
    std::string text;
    std::int64_t next = -1;  ///< step that follows the last one written, -1: none yet
  };
  // A trail lasts until the newest step. With ever new ids, all trails would be far larger than the
  // steps. The robots of the newest steps come first.
  std::map<std::int32_t, Trail> trails;
  for (auto step = steps_.rbegin(); step != steps_.rend() && trails.size() < kMaxRobots; ++step) {
    for (const Place& place : step->places) {
      if (trails.size() < kMaxRobots) trails.try_emplace(place.robot);
    }
  }
  const std::int64_t end = steps_.empty() ? 0 : steps_.back().number + 1;
  const auto fill = [](Trail& trail, std::int64_t until) {
    for (; trail.next < until; ++trail.next) trail.text += "null,null,";
  };
  for (const Step& step : steps_) {
    for (const Place& place : step.places) {
      const auto found = trails.find(place.robot);
      if (found == trails.end()) continue;
      Trail& trail = found->second;
      if (trail.next < 0) trail.next = step.number;
      fill(trail, step.number);
      trail.next = step.number + 1;
      fmt::format_to(std::back_inserter(trail.text), "{:.1f},{:.1f},", place.x * kCm,
                     place.y * kCm);
    }
  }
  std::string text =
      fmt::format("{{\"step_s\":{},\"robots\":{{", static_cast<double>(kStep_us) / 1e6);
  for (auto& [robot, trail] : trails) {
    fill(trail, end);
    trail.text.pop_back();
    text += fmt::format("\"{}\":[{}],", robot, trail.text);
  }
  if (!trails.empty()) text.pop_back();
  return text + "}}";
}

std::string TracksView::speedsJson(std::int32_t robot) const {
  Json times = Json::array();
  Json speeds = Json::array();
  const Place* before = nullptr;
  const Step* step_before = nullptr;
  for (const Step& step : steps_) {
    const auto place = std::ranges::find(step.places, robot, &Place::robot);
    if (place == step.places.end()) continue;
    if (before != nullptr && step.number == step_before->number + 1) {
      const double dt = units::seconds(step.utime - step_before->utime);
      const auto way =
          static_cast<double>(std::hypot(place->x - before->x, place->y - before->y) * kCm);
      const std::int64_t middle = (step.utime + step_before->utime) / 2;
      times.push_back(number(units::seconds(middle - steps_.back().utime)));
      speeds.push_back(number(way / dt));
    }
    before = &*place;
    step_before = &step;
  }
  return toText({{"t_s", std::move(times)}, {"speed_cm_s", std::move(speeds)}});
}

}  // namespace lab::dashboard
