#include "runner/commands/log_events.hpp"

#include <algorithm>
#include <iterator>
#include <lab/robot_status_t.hpp>
#include <lab/service_status_t.hpp>
#include <lab/tracked_frame_t.hpp>

#include "common/bus/bus_error.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/udpm_assembler.hpp"
#include "common/bus/value_checker.hpp"
#include "common/math/units.hpp"

namespace lab::runner {

bool isPlaybackChannel(std::string_view channel) {
  return channel == channels::kExperimentStatus || channel == channels::kExperimentCommand;
}

namespace {

/// Times of arrival as times of a replay: they pass as recorded, but gaps are shortened, and a
/// clock that was set back goes on.
class PlaybackTimeline {
 public:
  explicit PlaybackTimeline(double max_gap) : max_gap_us_(units::microseconds(max_gap)) {}

  /// @return [us since 1970]
  std::int64_t of(std::int64_t log_utime) {
    if (!newest_) newest_ = {log_utime, log_utime};
    const std::int64_t step = log_utime - newest_->log;
    if (step < -kDisorder_us) {
      ++gaps_.steps_back;
      newest_->log = log_utime;
      return newest_->play;
    }
    if (step > max_gap_us_) {
      ++gaps_.gaps;
      gaps_.longest = std::max(gaps_.longest, units::seconds(step));
    }
    // Many gaps of years must not add up beyond what a time can be.
    const std::int64_t play =
        std::min(newest_->play + std::min(step, max_gap_us_), ValueChecker::kLatestUtime);
    if (step > 0) newest_ = {log_utime, play};
    return play;
  }

  [[nodiscard]] const ShortenedGaps& gaps() const { return gaps_; }

 private:
  struct Times {
    std::int64_t log;
    std::int64_t play;
  };
  static constexpr std::int64_t kDisorder_us = 1'000'000;  // of messages in the logger's queue

  std::int64_t max_gap_us_;
  std::optional<Times> newest_;
  ShortenedGaps gaps_;
};

}  // namespace

LogEvents::LogEvents(const std::vector<std::filesystem::path>& files, const LogSelection& selection)
    : messages_(files) {
  std::optional<std::int64_t> first;
  PlaybackTimeline timeline(selection.max_gap);
  LogReader reader(files);
  while (const std::optional<Packet> packet = reader.next()) {
    const std::int64_t utime = timeline.of(packet->received_utime);
    if (!first) first = utime;
    const double time = units::seconds(utime - *first);
    length_ = std::max(length_, time);
    if (isPlaybackChannel(packet->channel)) continue;
    noteChannel(packet->channel);
    if (!selection.channels.empty() && !selection.channels.contains(packet->channel)) continue;
    has_selected_ = true;
    if (time < selection.from || (selection.to && time > *selection.to)) continue;
    if (packet->channel.size() > kLongestChannelName ||
        packet->data.size() > UdpmAssembler::kLongestMessage) {
      ++unsendable_;
      continue;
    }
    const LogPosition& at = reader.position();
    events_.push_back({utime, packet->received_utime, at.offset,
                       static_cast<std::uint32_t>(at.size), static_cast<std::uint32_t>(at.file),
                       indexOf(packet->channel)});
  }
  std::ranges::stable_sort(events_, {}, &LogEvent::utime);
  gaps_ = timeline.gaps();
}

void LogEvents::noteChannel(std::string_view channel) {
  constexpr std::size_t kMostNoted = 100;
  if (found_.contains(channel)) return;
  found_.emplace(channel);
  if (found_.size() > kMostNoted) found_.erase(std::prev(found_.end()));
}

std::uint32_t LogEvents::indexOf(std::string_view channel) {
  const auto known = indices_.find(channel);
  if (known != indices_.end()) return known->second;
  const auto index = static_cast<std::uint32_t>(channels_.size());
  channels_.emplace_back(channel);
  indices_.emplace(channel, index);
  return index;
}

std::vector<std::uint8_t> asReplay(std::string_view channel, Bytes data) {
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
