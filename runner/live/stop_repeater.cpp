#include "runner/live/stop_repeater.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "common/bus/channels.hpp"
#include "common/math/units.hpp"

namespace lab::runner {
namespace {

// Far above what operators and programs need.
constexpr int kMostRecorded = 200;  // in kRecordPeriod_us
constexpr std::int64_t kRecordPeriod_us = 10'000'000;

}  // namespace

StopRepeater::StopRepeater(Node& node, Loop& loop, const Experiment& experiment,
                           ExperimentRecord& record)
    : node_(node),
      loop_(loop),
      record_(record),
      latch_(experiment),
      recorded_(kMostRecorded, kRecordPeriod_us) {}

void StopRepeater::take(const robot_stop_t& stop) {
  if (!latch_.take(stop)) return;
  if (latch_.refused()) {
    record_.limitReached(fmt::format(
        "more than {} robots that are not of this run were told to stop; further ones are not "
        "stopped again when they restart",
        StopLatch::kMostOthers));
  }
  if (!recorded_.allows(loop_.now())) {
    record_.limitReached(
        fmt::format("more than {} stops in {} s: they hold, but not each is recorded",
                    kMostRecorded, kRecordPeriod_us / units::kSecond_us));
    return;
  }
  record_.markRequest(
      std::string(stop.clear != 0 ? "stop released by " : "robots stopped by ") + stop.sender +
          (stop.reason.empty() ? "" : ": " + stop.reason),
      stop.clear != 0 ? "" : "lab stop --clear, or release on the page, lets them go on");
}

void StopRepeater::repeat() {
  for (robot_stop_t& stop : latch_.inForce(loop_.now())) {
    node_.publishCommand(channels::kRobotStop, stop);
  }
}

void StopRepeater::stopAll(const std::string& why) {
  robot_stop_t stop{};
  stop.seq = loop_.now();
  stop.utime = stop.seq;
  stop.reason = why;
  latch_.set(stop);
  node_.publishCommand(channels::kRobotStop, stop);
}

}  // namespace lab::runner
