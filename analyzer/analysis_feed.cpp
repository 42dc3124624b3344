#include "analyzer/analysis_feed.hpp"

#include <algorithm>
#include <cmath>

#include "common/experiment/light_messages.hpp"
#include "common/experiment/program_messages.hpp"
#include "common/files/experiment_error.hpp"
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

RobotBody bodyOf(const RobotHardware& hardware) {
  return {.wheel_base = hardware.diameter,
          .max_wheel_speed = hardware.max_wheel_speed,
          .pwm_steps = hardware.pwm_steps,
          .clock_error = hardware.clock_error,
          .sensor_period = hardware.sensor_period};
}

AnalysisConfig analysisConfig(const Experiment& experiment) {
  AnalysisConfig config;
  config.max_lag = experiment.analysis.max_lag;
  config.stitcher.wheel_base = experiment.hardware.diameter;
  config.stitcher.max_wheel_speed = experiment.hardware.max_wheel_speed * kWheelSpeedMargin;
  return config;
}

AnalysisFeed::AnalysisFeed(const Experiment& experiment)
    : body_(bodyOf(experiment.hardware)), analysis_(analysisConfig(experiment)) {
  for (const auto& [name, program] : experiment.programs) define(program);
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
    const std::int64_t boot = bootOf(status, state);
    analysis_.addTelemetry(state.robot_id, lawOfProgram(state.program), telemetry(state, boot));
  }
}

void AnalysisFeed::take(const light_status_t& status) {
  analysis_.setSpatialLight(!light::isUniform(toField(status)));
}

void AnalysisFeed::take(const robot_command_t& command) {
  for (const robot_order_t& order : command.orders) {
    for (const light_band_t& band : order.bands) {
      if (definitions_.contains(band.program.id.hash)) continue;
      try {
        define(toProgram(band.program));
      } catch (const ExperimentError&) {
        // The robot refuses it too: it does not run.
      }
    }
  }
}

void AnalysisFeed::define(const Program& program) {
  if (program.hash == 0 || definitions_.size() >= ProgramKeys::kMost) return;
  if (definitions_.try_emplace(program.hash, program).second) laws_.erase(program.hash);
}

const ProgramLaw& AnalysisFeed::lawOfProgram(const program_id_t& program) {
  static const ProgramLaw none;
  // The host sets the wheel speeds: that has no law, and each speed would count as a program.
  if (program.hash == 0) return none;
  const auto known = laws_.find(program.hash);
  if (known != laws_.end()) return known->second;
  if (laws_.size() >= Analysis::kMostPrograms) return none;
  const auto definition = definitions_.find(program.hash);
  return laws_[program.hash] = definition != definitions_.end()
                                   ? lawOf(definition->second, body_)
                                   : lawOfUnknown(static_cast<std::uint32_t>(program.hash),
                                                  program.name, body_.wheel_base);
}

std::int64_t AnalysisFeed::bootOf(const robot_status_t& status, const robot_state_t& state) {
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
  program_keys_.key(state.program);
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
  telemetry.contact_robot = has(state, robot_state_t::FLAG_CONTACT_ROBOT);
  telemetry.contact_wall = has(state, robot_state_t::FLAG_CONTACT_WALL);
  telemetry.contact = telemetry.contact_robot || telemetry.contact_wall;
  telemetry.light_front = state.light_front;
  telemetry.light_back = state.light_back;
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
        sink(robot, idOf(law), piece);
      });
}

program_id_t AnalysisFeed::idOf(const ProgramLaw& law) const {
  for (const program_id_t& program : program_keys_.programs()) {
    if (program.hash == law.program()) return program;
  }
  return {};
}

std::vector<FeedResult> AnalysisFeed::results(Depth depth,
                                              const std::function<void()>& meanwhile) const {
  std::vector<FeedResult> results;
  for (ProgramResult& result : analysis_.results(depth, meanwhile)) {
    FeedResult one;
    one.program = idOf(result.law);
    const auto known = definitions_.find(one.program.hash);
    if (known != definitions_.end()) one.definition = known->second;
    one.result = std::move(result);
    results.push_back(std::move(one));
  }
  return results;
}

}  // namespace lab::analysis
