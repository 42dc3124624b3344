#include "sim_svc/bodies/replay_robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <lab/experiment_event_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/bus/arrival_clock.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/codec.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/message_values.hpp"
#include "common/math/angle.hpp"
#include "common/math/units.hpp"
#include "common/programs/program.hpp"
#include "common/text/utf8.hpp"

namespace lab::sim {
namespace {

constexpr const char* kLogOfARun = "log.lcmlog";
/// A gap between frames of more than this many periods is a drop-out.
constexpr double kDropOut = 1.5;

/// Collects all messages about some robots from a log.
class Collector {
 public:
  /// @param recordings by robot; they are filled
  explicit Collector(std::map<std::int32_t, Recording*> recordings)
      : recordings_(std::move(recordings)) {}

  void take(const Packet& packet) {
    if (packet.channel == channels::kTrackedFrame) {
      takeFrame(packet);
    } else if (packet.channel == channels::kRobotStatus) {
      takeStatus(packet);
    } else if (packet.channel == channels::kExperimentEvent) {
      experiment_event_t event{};
      const bool first_step = decode(packet.data, event) && !impossibleValue(event) &&
                              event.kind == experiment_event_t::STEP && event.step == 0;
      if (first_step) script_start = event.commanded_utime;
    }
  }

  std::set<std::int32_t> seen;
  std::int64_t script_start = 0;

 private:
  [[nodiscard]] Recording* recordingOf(std::int32_t robot_id) const {
    const auto found = recordings_.find(robot_id);
    return found != recordings_.end() ? found->second : nullptr;
  }

  /// Decodes a message. @return whether it can be one of the recorded lab
  template <class Message>
  static bool isPossible(const Packet& packet, Message& message, ArrivalClock& clock) {
    if (!decode(packet.data, message)) return false;
    const auto found = removeImpossible(message);
    return (!found || found->usable) &&
           clock.accepts(message.sender, message.instance, message.utime, packet.received_utime);
  }

  void takeFrame(const Packet& packet) {
    tracked_frame_t frame{};
    if (!isPossible(packet, frame, frame_clock_)) return;
    for (const tracked_pose_t& pose : frame.robots) {
      seen.insert(pose.robot_id);
      Recording* const recording = recordingOf(pose.robot_id);
      if (recording == nullptr) continue;
      recording->frames.push_back({frame.utime, pose});
      recording->frame_period = frame.frame_period;
    }
  }

  void takeStatus(const Packet& packet) {
    robot_status_t status{};
    if (!isPossible(packet, status, status_clock_)) return;
    for (robot_state_t& state : status.robots) {
      Recording* const recording = recordingOf(state.robot_id);
      if (recording == nullptr) continue;
      // Each report of the replayed robot repeats it.
      std::string& name = state.program.name;
      if (name.size() > kLongestProgramName) {
        name = std::string(utf8Prefix(name, kLongestProgramName));
      }
      recording->states.push_back(std::move(state));
    }
  }

  std::map<std::int32_t, Recording*> recordings_;
  ArrivalClock frame_clock_;
  ArrivalClock status_clock_;
};

/// Sorts items by time, removes duplicates, and drops items before `begin`.
template <class Item>
void order(std::vector<Item>& items, std::int64_t begin) {
  const auto earlier = [](const Item& a, const Item& b) { return a.utime < b.utime; };
  std::stable_sort(items.begin(), items.end(), earlier);
  const auto same = [](const Item& a, const Item& b) { return a.utime == b.utime; };
  items.erase(std::unique(items.begin(), items.end(), same), items.end());
  std::erase_if(items, [begin](const Item& item) { return item.utime < begin; });
}

/// The last item at or before a time.
template <class Item>
const Item* lastBefore(const std::vector<Item>& items, std::int64_t utime) {
  const auto after =
      std::upper_bound(items.begin(), items.end(), utime,
                       [](std::int64_t time, const Item& item) { return time < item.utime; });
  return after == items.begin() ? nullptr : &*(after - 1);
}

}  // namespace

RecordedLog::RecordedLog(const std::filesystem::path& path,
                         const std::vector<std::int32_t>& robot_ids) {
  namespace fs = std::filesystem;
  const fs::path log = fs::is_directory(path) ? path / kLogOfARun : path;
  if (!fs::is_regular_file(log)) {
    throw std::runtime_error(log.string() + ": there is no log; give a log or the folder of a run");
  }
  name_ = log.string();
  for (const std::int32_t id : robot_ids) ++robots_[id].uses;
  std::map<std::int32_t, Recording*> recordings;
  for (auto& [id, robot] : robots_) recordings[id] = &robot.recording;
  Collector collector(std::move(recordings));
  readLog(logSeries(log), [&collector](const Packet& packet) { collector.take(packet); });
  seen_ = std::move(collector.seen);
  script_start_ = collector.script_start;
}

Recording RecordedLog::take(std::int32_t robot_id, double from) {
  Robot& robot = robots_.at(robot_id);
  // Only a robot that is replayed several times has its messages in memory several times.
  Recording recording = --robot.uses > 0 ? robot.recording : std::move(robot.recording);
  if (recording.frames.empty()) {
    throw std::runtime_error(
        fmt::format("{}: no camera frame has robot {}; it has {}", name_, robot_id,
                    seen_.empty() ? "no robots" : fmt::format("{}", fmt::join(seen_, ", "))));
  }
  order(recording.frames, 0);
  const std::int64_t script_start =
      script_start_ != 0 ? script_start_ : recording.frames.front().utime;
  const double length = units::seconds(recording.frames.back().utime - script_start);
  const std::int64_t begin = script_start + units::microseconds(from);
  order(recording.frames, begin);
  order(recording.states, begin);
  if (recording.frames.size() < 2) {
    throw std::runtime_error(fmt::format(
        "{}: robot {} was last seen {:.1f} s after the start, so nothing is left from {:.1f} s on; "
        "give a smaller from_s",
        name_, robot_id, length, from));
  }
  return recording;
}

ReplayRobot::ReplayRobot(Recording recording, std::int32_t id, std::int64_t start_utime)
    : recording_(std::move(recording)),
      id_(id),
      shift_us_(start_utime - recording_.frames.front().utime),
      end_utime_(recording_.frames.back().utime + shift_us_) {}

tracked_pose_t ReplayRobot::named(tracked_pose_t pose) const {
  pose.robot_id = id_;
  return pose;
}

std::optional<tracked_pose_t> ReplayRobot::lastPose(std::int64_t utime) const {
  const Recording::Frame* last = lastBefore(recording_.frames, utime - shift_us_);
  if (last == nullptr || isOver(utime)) return std::nullopt;
  return named(last->pose);
}

std::optional<tracked_pose_t> ReplayRobot::trackedPose(std::int64_t utime) const {
  const std::int64_t recorded = utime - shift_us_;
  const Recording::Frame* last = lastBefore(recording_.frames, recorded);
  if (last == nullptr || isOver(utime)) return std::nullopt;
  if (last->utime == recorded) return named(last->pose);
  const Recording::Frame& next = *(last + 1);  // exists because isOver() is false
  const double gap = units::seconds(next.utime - last->utime);
  if (gap > kDropOut * recording_.frame_period) return std::nullopt;
  const double share = units::seconds(recorded - last->utime) / gap;
  tracked_pose_t pose = last->pose;
  pose.x += share * (next.pose.x - pose.x);
  pose.y += share * (next.pose.y - pose.y);
  const double turned = wrapAngle(next.pose.theta - pose.theta);
  pose.theta = wrapAngle(pose.theta + share * turned);
  return named(pose);
}

std::optional<robot_state_t> ReplayRobot::state(std::int64_t utime) const {
  const robot_state_t* last = lastBefore(recording_.states, utime - shift_us_);
  if (last == nullptr || isOver(utime)) return std::nullopt;
  robot_state_t state = *last;
  state.robot_id = id_;
  state.origin = robot_state_t::REPLAY;
  for (std::int64_t* time : {&state.utime, &state.program_start_utime, &state.reversal_start_utime,
                             &state.reversal_end_utime}) {
    if (*time != 0) *time += shift_us_;
  }
  state.command_seq = 0;
  state.command_instance = 0;
  state.stop_seq = 0;
  return state;
}

}  // namespace lab::sim
