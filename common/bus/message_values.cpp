#include "common/bus/message_values.hpp"

#include <cstdint>
#include <lab/analysis_t.hpp>
#include <lab/collective_t.hpp>
#include <lab/experiment_event_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <lab/light_delivery_t.hpp>
#include <lab/light_seen_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/link_status_t.hpp>
#include <lab/robot_calibration_t.hpp>
#include <lab/robot_senses_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/robot_steps_t.hpp>
#include <lab/service_status_t.hpp>
#include <lab/sim_truth_t.hpp>
#include <lab/tracked_details_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <lab/tracker_status_t.hpp>
#include <limits>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/count_limits.hpp"

namespace lab {
namespace {

constexpr double kFarthest = 1e3;      // [m] as the dashboard shows
constexpr double kFastest = 100;       // [m/s]
constexpr double kLongestTime = 1e10;  // [s]
constexpr double kMostTurns = 1e6;     // [rad]
constexpr double kLargest = 1e12;      // of numbers in the sender's own units
constexpr std::int64_t kMostOrders = std::int64_t{1}
                                     << 62;  // a program may number by its clock in ns
constexpr std::int64_t kMost32 = std::numeric_limits<std::int32_t>::max();

}  // namespace

void checkHeader(ValueChecker& check, std::int64_t utime, std::int64_t seq) {
  check.time("utime", utime);
  check.whole("seq", seq, 0, kMostOrders);
}

std::optional<std::string> impossibleHeader(std::string_view channel, std::int64_t utime,
                                            std::int64_t seq) {
  if (channel == channels::kRobotStop) return std::nullopt;
  ValueChecker check;
  checkHeader(check, utime, seq);
  return check.problem();
}

static void checkValues(ValueChecker& check, const program_id_t& program) {
  check.whole("hash", program.hash, 0, std::numeric_limits<std::uint32_t>::max());
}

static void checkValues(ValueChecker& check, const robot_state_t& state) {
  check.time("utime", state.utime);
  check.time("program_start_utime", state.program_start_utime);
  check.time("reversal_start_utime", state.reversal_start_utime);
  check.time("reversal_end_utime", state.reversal_end_utime);
  check.part("program", state.program);
  check.time("senses_utime", state.senses_utime);
  check.time("senses_since_utime", state.senses_since_utime);
  check.whole("phase", state.phase, 0, std::numeric_limits<std::int8_t>::max());
  check.whole("program_epoch", state.program_epoch, 0, kMost32);
  check.whole("reversal_count", state.reversal_count, 0, kMost32);
  check.whole("tumble_count", state.tumble_count, 0, kMost32);
  check.whole("link_errors", state.link_errors, 0, kMost32);
  check.number("wheel_left", state.wheel_left, -kFastest, kFastest);
  check.number("wheel_right", state.wheel_right, -kFastest, kFastest);
  check.number("program_left", state.program_left, -kFastest, kFastest);
  check.number("program_right", state.program_right, -kFastest, kFastest);
  check.number("light_front", state.light_front, -kLargest, kLargest);
  check.number("light_back", state.light_back, -kLargest, kLargest);
  check.number("run_time", state.run_time, 0, kLongestTime);
}

static void checkValues(ValueChecker& check, const sense_values_t& senses) {
  for (const float value : senses.values) {
    check.number("values", static_cast<double>(value), -kLargest, kLargest);
  }
}

void checkValues(ValueChecker& check, const robot_senses_t& senses) {
  check.list("robots", senses.robots);
}

void checkValues(ValueChecker& check, const robot_status_t& status) {
  check.list("robots", status.robots);
}

static void checkValues(ValueChecker& check, const tracked_pose_t& pose) {
  check.number("x", pose.x, -kFarthest, kFarthest);
  check.number("y", pose.y, -kFarthest, kFarthest);
  check.number("theta", pose.theta, -kMostTurns, kMostTurns);
  for (const double value : pose.covariance) {
    check.number("covariance", value, -kLargest, kLargest);
  }
  check.number("confidence", pose.confidence, 0, 1);
}

void checkValues(ValueChecker& check, const tracked_frame_t& frame) {
  check.whole("frame", frame.frame, -1, kMostCounted);
  check.number("frame_period", frame.frame_period, 0, kLongestTime);
  check.list("robots", frame.robots);
  check.list("unidentified", frame.unidentified);
}

void checkValues(ValueChecker& check, const tracker_status_t& status) {
  for (const std::int64_t count :
       {status.frames, status.dropped, status.dark, status.saturated, status.bindings,
        status.unbindings, status.flips, status.lost, status.spacings}) {
    check.whole("count", count, 0, kMostCounted);
  }
}

static void checkValues(ValueChecker& check, const cap_detail_t& cap) {
  check.number("spacing", cap.spacing, -kFarthest, kFarthest);
  check.number("white", cap.white, -kLargest, kLargest);
  check.number("u", cap.u, -kLargest, kLargest);
  check.number("v", cap.v, -kLargest, kLargest);
}

void checkValues(ValueChecker& check, const tracked_details_t& details) {
  check.whole("frame", details.frame, -1, kMostCounted);
  check.list("caps", details.caps);
}

void checkValues(ValueChecker& check, const light_seen_t& seen) {
  check.whole("frame", seen.frame, -1, kMostCounted);
  // Other light in the patch may be far brighter than the patch.
  constexpr double kBrightest = static_cast<double>(std::numeric_limits<float>::max());
  check.number("level", seen.level, -kBrightest, kBrightest);
  check.whole("sync", seen.sync, -1, 1);
}

static void checkValues(ValueChecker& check, const light_layer_t& layer) {
  for (const double value : {layer.x, layer.y, layer.angle, layer.size, layer.inner, layer.softness,
                             layer.intensity, layer.intensity2, layer.phase}) {
    check.number("number", value, -kLargest, kLargest);
  }
}

void checkValues(ValueChecker& check, const light_status_t& status) {
  check.whole("frame", status.frame, -1, kMostCounted);
  check.number("frame_period", status.frame_period, 0, kLongestTime);
  check.number("latency", status.latency, -kLongestTime, kLongestTime);
  check.time("first_shown_utime", status.first_shown_utime);
  check.number("mix", status.mix, 0, 1);
  check.list("previous", status.previous);
  check.list("layers", status.layers);
}

static void checkValues(ValueChecker& check, const light_delay_t& delay) {
  check.whole("count", delay.count, 0, kMost32);
}

void checkValues(ValueChecker& check, const light_delivery_t& delivery) {
  check.whole("steps", delivery.steps, 0, kMost32);
  check.list("delays", delivery.delays);
}

static void checkValues(ValueChecker& check, const robot_step_t& step) {
  check.time("utime", step.utime);
  check.number("wheel_left", step.wheel_left, -kFastest, kFastest);
  check.number("wheel_right", step.wheel_right, -kFastest, kFastest);
  check.number("duration", step.duration, -1, kLongestTime);
}

void checkValues(ValueChecker& check, const robot_steps_t& steps) {
  check.list("steps", steps.steps);
}

static void checkValues(ValueChecker& check, const true_pose_t& pose) {
  check.number("x", pose.x, -kFarthest, kFarthest);
  check.number("y", pose.y, -kFarthest, kFarthest);
  check.number("theta", pose.theta, -kLargest, kLargest);
}

void checkValues(ValueChecker& check, const sim_truth_t& truth) {
  check.list("robots", truth.robots);
}

static void checkValues(ValueChecker& check, const motor_calibration_t& motors) {
  check.number("gain_left", motors.gain_left, 0, kFastest);
  check.number("gain_right", motors.gain_right, 0, kFastest);
  check.number("dead_band_left", motors.dead_band_left, 0, 1);
  check.number("dead_band_right", motors.dead_band_right, 0, 1);
  check.number("wheel_base", motors.wheel_base, 0, kFarthest);
}

void checkValues(ValueChecker& check, const robot_calibration_t& calibration) {
  check.list("robots", calibration.robots);
}

void checkValues(ValueChecker& check, const experiment_event_t& event) {
  check.whole("step", event.step, -1, kMost32 - 1);
  check.time("commanded_utime", event.commanded_utime);
  check.time("presented_utime", event.presented_utime);
  check.time("seen_utime", event.seen_utime);
  check.time("first_acted_utime", event.first_acted_utime);
  check.time("last_acted_utime", event.last_acted_utime);
}

// The simulator computes the begin of the script from it. The other numbers are only shown.
void checkValues(ValueChecker& check, const experiment_status_t& status) {
  check.number("elapsed", status.elapsed, -kLongestTime, kLongestTime);
}

static void checkValues(ValueChecker& check, const link_peer_t& peer) {
  check.time("heard_utime", peer.heard_utime);
  for (const std::int64_t count :
       {peer.sent, peer.received, peer.lost, peer.repeated, peer.stale, peer.clashing}) {
    check.whole("count", count, 0, kMostOnLink);
  }
}

void checkValues(ValueChecker& check, const link_status_t& status) {
  check.whole("foreign", status.foreign, 0, kMostOnLink);
  check.whole("timeouts", status.timeouts, 0, kMostOnLink);
  check.list("peers", status.peers);
}

static void checkValues(ValueChecker& check, const channel_count_t& count) {
  check.whole("messages", count.messages, 0, kMostCounted);
}

static void checkValues(ValueChecker& check, const stream_count_t& count) {
  check.whole("received", count.received, 0, kMostCounted);
  check.whole("lost", count.lost, -kMostCounted, kMostCounted);
  check.whole("decode_errors", count.decode_errors, 0, kMostCounted);
}

void checkValues(ValueChecker& check, const service_status_t& status) {
  check.time("start_utime", status.start_utime);
  check.list("sent", status.sent);
  check.list("received", status.received);
}

static void checkValues(ValueChecker& check, const curve_t& curve) {
  for (const float lag : curve.lag) check.number("lag", lag, 0, kLongestTime);
  check.results("value", curve.value);
  check.results("sigma", curve.sigma, 0);
  check.results("exact", curve.exact);
  check.results("paper", curve.paper);
  for (const std::int32_t windows : curve.windows) check.whole("windows", windows, 0, kMost32);
  for (const std::int8_t biased : curve.biased) check.whole("biased", biased, 0, 1);
}

/// The analyzer's intervals are open (infinite) if there is too little data, and D and L_s are
/// infinite, in theory and as measured, if a robot does not turn. Such a value has no error.
static void checkValues(ValueChecker& check, const estimate_t& estimate) {
  check.result("sigma", estimate.sigma, 0);
  if (estimate.sigma > 0) check.result("value", estimate.value);
}

void checkValues(ValueChecker& check, const analysis_t& analysis) {
  check.whole("robot_id", analysis.robot_id, analysis_t::POOL, kMost32);
  check.part("program", analysis.program);
  check.result("observed", analysis.observed, 0);
  check.whole("segments", analysis.segments, 0, kMost32);
  check.whole("reversals", analysis.reversals, 0, kMost32);
  check.number("contact_share", analysis.contact_share, 0, 1);
  check.whole("verdict", analysis.verdict, analysis_t::UNDECIDED, analysis_t::DISAGREES);
  check.result("max_z", analysis.max_z, 0);
  check.list("curves", analysis.curves);
  check.list("estimates", analysis.estimates);
}

static void checkValues(ValueChecker& check, const observable_t& observable) {
  check.result("now", observable.now);
  check.result("mean", observable.mean);
  check.result("sigma", observable.sigma, 0);
  check.result("low", observable.low);
  check.result("high", observable.high);
}

static void checkValues(ValueChecker& check, const observable_curve_t& curve) {
  for (const float x : curve.x) check.number("x", x, -kLargest, kLargest);
  check.results("value", curve.value);
  check.results("low", curve.low);
  check.results("high", curve.high);
}

static void checkValues(ValueChecker& check, const crowd_member_t& member) {
  check.whole("cluster", member.cluster, 0, std::numeric_limits<std::int16_t>::max());
  check.result("density", static_cast<double>(member.density), 0);
  check.result("hexatic", static_cast<double>(member.hexatic), 0);
}

void checkValues(ValueChecker& check, const collective_t& crowd) {
  check.part("program", crowd.program);
  check.result("observed", crowd.observed, 0);
  check.number("robots", crowd.robots, 0, kLargest);
  check.list("observables", crowd.observables);
  check.list("curves", crowd.curves);
  check.list("members", crowd.members);
}

/// @param size the field with the length of the list, which LCM's encoder trusts
template <class Part>
static std::int64_t removeFrom(std::vector<Part>& parts, std::int32_t& size) {
  const auto removed = std::erase_if(parts, [](const Part& part) {
    ValueChecker check;
    checkValues(check, part);
    return check.problem().has_value();
  });
  size = static_cast<std::int32_t>(parts.size());
  return static_cast<std::int64_t>(removed);
}

std::int64_t removeImpossibleParts(robot_status_t& status) {
  const std::int64_t removed = removeFrom(status.robots, status.num_robots);
  return status.robots.empty() ? 0 : removed;
}

std::int64_t removeImpossibleParts(tracked_frame_t& frame) {
  const std::int64_t removed = removeFrom(frame.robots, frame.num_robots) +
                               removeFrom(frame.unidentified, frame.num_unidentified);
  return frame.robots.empty() && frame.unidentified.empty() ? 0 : removed;
}

}  // namespace lab
