#include "common/bus/stream_counter.hpp"

#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/count_limits.hpp"
#include "common/math/saturated.hpp"

namespace lab {

namespace {

constexpr std::int64_t kRecent = 64;  // bits of StreamCount::recent

// A stream may lose its place when it has few messages and has been silent while so many of others
// came: 20 s to a minute in most services. A service of the lab soon has more messages than that.
constexpr std::int64_t kFewMessages = 20;
constexpr std::int64_t kSilentFor = 2000;  // messages of others

/// @param seq not below the first of the stream
void track(StreamCount& stream, std::int64_t seq, bool counts_messages) {
  // A stop is counted, whatever its number is.
  const std::int64_t ahead = saturatedDifference(seq, stream.last_seq);
  if (ahead > 0) {
    if (counts_messages) stream.lost = limitedSum(stream.lost, ahead - 1, kMostCounted);
    stream.recent = ahead < kRecent ? (stream.recent << ahead) | 1U : 1U;
    stream.last_seq = seq;
  } else if (ahead > -kRecent && ((stream.recent >> -ahead) & 1U) == 0) {
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
    if (streams_.size() >= most_ && !streams_.contains(key) && !makePlace()) {
      ++counted_;
      ++uncounted_;
      return;
    }
    last_ = &*streams_.try_emplace(std::move(key)).first;
  }
  StreamCount& stream = last_->second;
  ++stream.received;
  stream.last_counted = ++counted_;
  stream.last_utime = utime;
  if (stream.received == 1) {
    stream.first_seq = stream.last_seq = seq;
  } else if (seq >= stream.first_seq) {
    track(stream, seq, seqCountsMessages(channel));
  }
}

void StreamCounter::countDecodeError(std::string_view channel, std::int64_t count) {
  std::string name(channel);
  const bool has_place = decode_errors_.size() < kMostChannels || decode_errors_.contains(name);
  (has_place ? decode_errors_[std::move(name)] : further_decode_errors_) += count;
}

bool StreamCounter::makePlace() {
  auto oldest = streams_.end();
  for (auto stream = streams_.begin(); stream != streams_.end(); ++stream) {
    const StreamCount& count = stream->second;
    if (count.received >= kFewMessages || counted_ - count.last_counted < kSilentFor) continue;
    if (oldest == streams_.end() || count.last_counted < oldest->second.last_counted) {
      oldest = stream;
    }
  }
  if (oldest == streams_.end()) return false;
  if (last_ == &*oldest) last_ = nullptr;
  streams_.erase(oldest);
  return true;
}

std::int64_t StreamCounter::lost() const {
  std::int64_t sum = 0;
  for (const auto& [key, stream] : streams_) sum = limitedSum(sum, stream.lost, kMostCounted);
  return sum;
}

}  // namespace lab
