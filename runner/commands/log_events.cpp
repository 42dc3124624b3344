#include "runner/commands/log_events.hpp"

#include <algorithm>
#include <lab/robot_status_t.hpp>
#include <lab/service_status_t.hpp>
#include <lab/tracked_frame_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/math/units.hpp"

namespace lab::runner {

bool isPlaybackChannel(std::string_view channel) {
  return channel == channels::kExperimentStatus || channel == channels::kExperimentCommand;
}

std::vector<LogEvent> selectEvents(const std::vector<std::filesystem::path>& files,
                                   const LogSelection& selection) {
  std::vector<LogEvent> events;
  std::optional<std::int64_t> first;
  readLog(files, [&](const Packet& packet) {
    if (!first) first = packet.received_utime;
    const double time = units::seconds(packet.received_utime - *first);
    if (time < selection.from || (selection.to && time > *selection.to)) return;
    if (isPlaybackChannel(packet.channel)) return;
    std::string channel(packet.channel);
    if (!selection.channels.empty() && !selection.channels.contains(channel)) return;
    events.push_back(
        {std::move(channel), {packet.data.begin(), packet.data.end()}, packet.received_utime});
  });
  std::stable_sort(events.begin(), events.end(),
                   [](const LogEvent& a, const LogEvent& b) { return a.utime < b.utime; });
  return events;
}

std::vector<std::uint8_t> asReplay(const std::string& channel, Bytes data) {
  if (channel == channels::kRobotStatus) {
    robot_status_t status{};
    if (decode(data, status)) {
      for (robot_state_t& robot : status.robots) robot.origin = robot_state_t::REPLAY;
      return encode(status);
    }
  } else if (channel == channels::kTrackedFrame) {
    tracked_frame_t frame{};
    if (decode(data, frame)) {
      frame.origin = robot_state_t::REPLAY;
      return encode(frame);
    }
  } else if (channel == channels::kServiceStatus) {
    service_status_t status{};
    if (decode(data, status)) {
      status.origin = robot_state_t::REPLAY;
      return encode(status);
    }
  }
  return {data.begin(), data.end()};
}

void ReplayClock::pause(std::int64_t now) {
  log_anchor_ = logTime(now);
  wall_anchor_ = now;
  paused_ = true;
}

void ReplayClock::resume(std::int64_t now) {
  wall_anchor_ = now;
  paused_ = false;
}

std::int64_t ReplayClock::logTime(std::int64_t now) const {
  if (paused_) return log_anchor_;
  return log_anchor_ + static_cast<std::int64_t>(static_cast<double>(now - wall_anchor_) * speed_);
}

}  // namespace lab::runner
