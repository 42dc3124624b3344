#include "common/bus/arrival_clock.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

#include "common/bus/channels.hpp"

namespace lab {
namespace {

constexpr std::size_t kMostStreams = 64;

}  // namespace

bool timesFollowClock(std::string_view channel) {
  return channel == channels::kTrackedFrame || channel == channels::kTrackedDetails ||
         channel == channels::kRobotStatus || channel == channels::kRobotSteps ||
         channel == channels::kLightStatus || channel == channels::kLightSeen ||
         channel == channels::kSimTruth;
}

bool ArrivalClock::continues(const Moment& before, const Moment& after) {
  const std::int64_t step = after.utime - before.utime;
  const std::int64_t passed = after.now - before.now;
  return std::abs(step) <= kWindow_us || std::abs(step - passed) <= kWindow_us;
}

ArrivalClock::Stream* ArrivalClock::streamOf(std::string_view sender, std::int64_t instance) {
  const auto found = std::ranges::find_if(streams_, [&](const Stream& stream) {
    return stream.instance == instance && stream.sender == sender;
  });
  if (found != streams_.end()) return &*found;
  if (streams_.size() >= kMostStreams) return nullptr;
  streams_.push_back({std::string(sender), instance, {}, {}, 0});
  return &streams_.back();
}

bool ArrivalClock::accepts(std::string_view sender, std::int64_t instance, std::int64_t utime,
                           std::int64_t now) {
  const Moment moment{utime, now};
  Stream* const stream = streamOf(sender, instance);
  if (stream == nullptr) {
    const bool fits = !last_ || continues(*last_, moment);
    if (fits) last_ = moment;
    return fits;
  }
  const std::optional<Moment>& before = stream->last ? stream->last : last_;
  if (before && !continues(*before, moment)) {
    const bool agrees = stream->doubt && continues(*stream->doubt, moment);
    stream->agreeing = agrees ? stream->agreeing + 1 : 1;
    stream->doubt = moment;
    if (stream->agreeing < kAgreeing) return false;
  }
  stream->doubt.reset();
  stream->agreeing = 0;
  stream->last = last_ = moment;
  return true;
}

}  // namespace lab
