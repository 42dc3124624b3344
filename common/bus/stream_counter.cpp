#include "common/bus/stream_counter.hpp"

#include "common/bus/channels.hpp"

namespace lab {

namespace {

constexpr std::int64_t kRecent = 64;  // bits of StreamCount::recent

/// @param seq not below the first of the stream
void track(StreamCount& stream, std::int64_t seq, bool counts_messages) {
  const std::int64_t ahead = seq - stream.last_seq;
  if (ahead > 0) {
    if (counts_messages) stream.lost += ahead - 1;
    stream.recent = ahead < kRecent ? (stream.recent << ahead) | 1U : 1U;
    stream.last_seq = seq;
  } else if (-ahead < kRecent && ((stream.recent >> -ahead) & 1U) == 0) {
    stream.recent |= std::uint64_t{1} << -ahead;
    if (counts_messages) --stream.lost;
  }
}

}  // namespace

bool seqCountsMessages(std::string_view channel) {
  return channel != channels::kRobotCommand && channel != channels::kRobotStop &&
         channel != channels::kLightCommand && channel != channels::kRobotCalibration &&
         channel != channels::kCalibrationStatus && channel != channels::kExperimentCommand;
}

void StreamCounter::count(std::string_view channel, std::string_view sender, std::int64_t instance,
                          std::int64_t seq, std::int64_t utime) {
  if (last_ == nullptr || last_->first.instance != instance || last_->first.channel != channel ||
      last_->first.sender != sender) {
    StreamKey key{std::string(channel), std::string(sender), instance};
    if (streams_.size() >= most_ && !streams_.contains(key)) {
      ++uncounted_;
      return;
    }
    last_ = &*streams_.try_emplace(std::move(key)).first;
  }
  StreamCount& stream = last_->second;
  ++stream.received;
  stream.last_utime = utime;
  if (stream.received == 1) {
    stream.first_seq = stream.last_seq = seq;
  } else if (seq >= stream.first_seq) {
    track(stream, seq, seqCountsMessages(channel));
  }
}

std::int64_t StreamCounter::lost() const {
  std::int64_t sum = 0;
  for (const auto& [key, stream] : streams_) sum += stream.lost;
  return sum;
}

}  // namespace lab
