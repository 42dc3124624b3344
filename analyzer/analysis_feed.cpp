#include "analyzer/analysis_feed.hpp"

#include <algorithm>
#include <cmath>

#include "common/experiment/light_messages.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/math/units.hpp"

namespace lab::analysis {
namespace {

// Poses with a lower confidence are not used.
constexpr float kLeastConfidence = 0.5F;
// Wheels may be a little faster than the data sheet states.
constexpr double kWheelSpeedMargin = 1.1;
constexpr std::int64_t kAhead_us = 5'000'000;
// Offset between the epochs of successive boots: larger than any count of epochs.
constexpr std::int64_t kEpochsPerBoot = std::int64_t{1} << 40;

bool has(const robot_state_t& state, std::int32_t flag) { return (state.flags & flag) != 0; }

FramePose toPose(const tracked_pose_t& pose) {
  constexpr std::size_t kXx = 0;
  constexpr std::size_t kYy = 3;
  constexpr std::size_t kTt = 5;
  return {pose.robot_id,
          pose.x,
          pose.y,
          pose.theta,
          std::sqrt(std::max(0.0, (pose.covariance[kXx] + pose.covariance[kYy]) / 2)),
          std::sqrt(std::max(0.0, pose.covariance[kTt])),
          pose.confidence >= kLeastConfidence};
}

}  // namespace

namespace {

/// The widest limits of any robot: keys robot.max_wheel_speed_cm_s and robot.diameter_cm.
constexpr dynamics::WheelLimits kWidestLimits{5.0, 0.01};

}  // namespace

ProgramLaw lawOf(const program_t& program, double wheel_base) {
  return lawOf(toProgram(program), wheel_base);
}

AnalysisConfig analysisConfig(const Experiment& experiment) {
  AnalysisConfig config;
  config.max_lag = experiment.analysis.max_lag;
  config.stitcher.wheel_base = experiment.hardware.diameter;
  config.stitcher.max_wheel_speed = experiment.hardware.max_wheel_speed * kWheelSpeedMargin;
  return config;
}

AnalysisFeed::AnalysisFeed(const Experiment& experiment)
    : wheel_base_(experiment.hardware.diameter), analysis_(analysisConfig(experiment)) {
  for (const RobotSpec& robot : experiment.robots) {
    if (robot.body == Body::kReplay) replayed_robots_.insert(robot.id);
  }
}

void AnalysisFeed::anchor(std::int64_t utime) {
  if (origin_utime_ == 0) origin_utime_ = utime;
}

double AnalysisFeed::seconds(std::int64_t utime) const {
  return units::seconds(utime - origin_utime_);
}

void AnalysisFeed::take(const tracked_frame_t& frame) {
  anchor(frame.utime);
  last_frame_utime_ = frame.utime;
  frame_.time = seconds(frame.utime);
  frame_.frame = frame.frame;
  frame_.poses.clear();
  for (const tracked_pose_t& pose : frame.robots) frame_.poses.push_back(toPose(pose));
  analysis_.addFrame(frame_);
}

void AnalysisFeed::take(const robot_status_t& status) {
  for (const robot_state_t& state : status.robots) {
    if (replayed_robots_.contains(state.robot_id)) continue;
    // One time in the future would stay the newest one; the times of robots are converted, and
    // live, nothing that a robot reports may hide that it stopped.
    if (status.utime > 0 && state.utime > status.utime + kAhead_us) {
      if (refused_++ == 0) refusal_ = "state of a robot: utime more than 5 s after its message's";
      continue;
    }
    if (boots_.size() >= Analysis::kMostRobots && !boots_.contains(state.robot_id)) continue;
    anchor(state.utime);
    const program_t program = lawful(state);
    const std::int64_t boot = bootOf(status, state, program);
    analysis_.addTelemetry(state.robot_id, lawOf(program, wheel_base_), telemetry(state, boot));
  }
}

void AnalysisFeed::take(const light_status_t& status) {
  analysis_.setSpatialLight(!light::isUniform(toField(status)));
}

program_t AnalysisFeed::lawful(const robot_state_t& state) {
  const bool by_hand = state.band < 0 && state.program.kind == program_t::WHEELS;
  if (by_hand) return {};
  if (!sameProgram(state.program, last_program_)) {
    last_program_ = state.program;
    last_reason_ = dynamics::outOfRange(toProgram(state.program), kWidestLimits);
  }
  if (last_reason_.empty()) return state.program;
  if (refused_++ == 0) refusal_ = "program of a robot: " + last_reason_;
  return {};
}

std::int64_t AnalysisFeed::bootOf(const robot_status_t& status, const robot_state_t& state,
                                  const program_t& program) {
  Boots& boots = boots_[state.robot_id];
  const bool other_sender = boots.instance != status.instance || boots.sender != status.sender;
  // A delayed message also has a smaller count, but it is older than the last one.
  const bool counts_again =
      state.utime > boots.last_utime && state.program_epoch < boots.last_epoch;
  if (other_sender || counts_again) {
    ++boots.number;
    boots.sender = status.sender;
    boots.instance = status.instance;
    boots.last_epoch = state.program_epoch;
  }
  boots.last_utime = std::max(boots.last_utime, state.utime);
  boots.last_epoch = std::max(boots.last_epoch, state.program_epoch);
  program_keys_.key(program);
  return boots.number;
}

RobotTelemetry AnalysisFeed::telemetry(const robot_state_t& state, std::int64_t boot) const {
  RobotTelemetry telemetry;
  telemetry.time = seconds(state.utime);
  telemetry.program_epoch = boot * kEpochsPerBoot + state.program_epoch;
  telemetry.program_start = seconds(state.program_start_utime);
  telemetry.reversal_count = state.reversal_count;
  telemetry.reversal_start = seconds(state.reversal_start_utime);
  telemetry.reversal_end = seconds(state.reversal_end_utime);
  telemetry.reversing = has(state, robot_state_t::FLAG_REVERSING);
  telemetry.v_l = state.program_left;
  telemetry.v_r = state.program_right;
  telemetry.contact =
      has(state, robot_state_t::FLAG_CONTACT_ROBOT) || has(state, robot_state_t::FLAG_CONTACT_WALL);
  telemetry.stopped =
      has(state, robot_state_t::FLAG_STOPPED) || has(state, robot_state_t::FLAG_LEASE_EXPIRED);
  telemetry.tumble_count = state.tumble_count;
  telemetry.run_time = state.run_time;
  return telemetry;
}

void AnalysisFeed::onSample(SampleSink sink) {
  analysis_.onSample([sink = std::move(sink)](int robot, const ProgramLaw& /*law*/,
                                              const Sample& sample) { sink(robot, sample); });
}

void AnalysisFeed::onPiece(PieceSink sink) {
  analysis_.onPiece(
      [this, sink = std::move(sink)](int robot, const ProgramLaw& law, const Piece& piece) {
        sink(robot, programOf(law), piece);
      });
}

program_t AnalysisFeed::programOf(const ProgramLaw& law) const {
  for (const program_t& program : program_keys_.programs()) {
    if (lawOf(program, wheel_base_) == law) return program;
  }
  return {};
}

std::vector<FeedResult> AnalysisFeed::results(Depth depth,
                                              const std::function<void()>& meanwhile) const {
  std::vector<FeedResult> results;
  for (ProgramResult& result : analysis_.results(depth, meanwhile)) {
    FeedResult one;
    one.program = programOf(result.law);
    one.result = std::move(result);
    results.push_back(std::move(one));
  }
  return results;
}

}  // namespace lab::analysis
