#include "runner/calibrate/motor_calibrator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/bus/channels.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "robot_bridge/calibration/motor_message.hpp"
#include "robot_bridge/calibration/track_noise.hpp"

namespace lab::runner {
namespace {

using calibration::Motors;

constexpr std::int64_t kMotorTick_us = 20'000;
constexpr std::int64_t kRequestPeriod_us = 500'000;  // 2 Hz
constexpr std::int64_t kMotorTimeout_us = 5'000'000;
constexpr double kUsableShare = calibration::FitLimits{}.used_share;
constexpr int kPatternTries = 2;                      // attempts at a disturbed pattern
constexpr std::int64_t kLineTimeout_us = 15'000'000;  // for a robot on a serial line

}  // namespace

MotorCalibrator::MotorCalibrator(const ServiceContext& context, ExperimentController& controller,
                                 std::vector<std::int32_t> robots,
                                 std::function<void(const calibration::MotorReport&)> tell,
                                 std::function<void()> done)
    : node_(context.node),
      loop_(context.loop),
      experiment_(context.experiment),
      controller_(controller),
      robots_(std::move(robots)),
      tell_(std::move(tell)),
      done_(std::move(done)) {
  node_.subscribe<tracked_frame_t>(channels::kTrackedFrame, [this](const tracked_frame_t& frame) {
    for (const tracked_pose_t& pose : frame.robots) {
      seen_robots_[pose.robot_id] = {frame.utime, {pose.x, pose.y, pose.theta}};
    }
    if (driver_) driver_->see(frame);
  });
  node_.subscribe<robot_status_t>(channels::kRobotStatus, [this](const robot_status_t& status) {
    if (!driver_) return;
    for (const robot_state_t& robot : status.robots) driver_->hear(robot);
  });
  node_.subscribe<robot_calibration_t>(channels::kCalibrationStatus,
                                       [this](const robot_calibration_t& status) { take(status); });
  controller_.command(standCommand(experiment_));
  loop_.every(kMotorTick_us, loop_.now() + kMotorTick_us, [this] { tick(); });
}

void MotorCalibrator::take(const robot_calibration_t& status) {
  if (status.seq != request_.seq) return;
  for (const motor_calibration_t& robot : status.robots) {
    held_[robot.robot_id] = calibration::fromMessage(robot);
  }
}

std::int64_t MotorCalibrator::timeout() const {
  const bool on_wire = std::ranges::any_of(
      experiment_.robots, [](const RobotSpec& robot) { return isOnWire(robot.body); });
  return on_wire ? kLineTimeout_us : kMotorTimeout_us;
}

void MotorCalibrator::tick() {
  const std::int64_t now = loop_.now();
  const bool requesting =
      phase_ == Phase::kAsk || phase_ == Phase::kStore || phase_ == Phase::kTakeBack;
  if (requesting && now >= next_request_) {
    next_request_ = now + kRequestPeriod_us;
    request_.utime = 0;
    node_.publishCommand(channels::kRobotCalibration, request_);
  }
  if (driver_) driver_->tick(now);
  const bool waited = now - since_ > timeout();
  switch (phase_) {
    case Phase::kBoot:
      if (!controller_.inScript()) return;
      phase_ = Phase::kAsk;
      since_ = now;
      requestStored();
      return;
    case Phase::kAsk: {
      const bool all_known = std::ranges::all_of(
          robots_, [this](std::int32_t robot) { return held_.contains(robot); });
      if (all_known || waited) nextRobot();
      return;
    }
    case Phase::kCheckBefore:
    case Phase::kPattern:
    case Phase::kCheckAfter:
      if (driver_->isOver()) finishPattern();
      return;
    case Phase::kStore:
    case Phase::kTakeBack:
      if (isHeld(calibration::fromMessage(request_.robots.front()))) return stored();
      if (waited) failStoring();
      return;
    case Phase::kDone:
      return;
  }
}

// A gain of 0 in the message requests the calibration without storing one.
void MotorCalibrator::requestStored() {
  std::vector<motor_calibration_t> questions;
  for (const std::int32_t robot : robots_) {
    motor_calibration_t question{};
    question.robot_id = robot;
    questions.push_back(question);
  }
  request(questions);
}

void MotorCalibrator::nextRobot() {
  if (next_robot_ == robots_.size()) {
    phase_ = Phase::kDone;
    done_();
    return;
  }
  report_ = {};
  report_.robot = robots_[next_robot_++];
  const auto held = held_.find(report_.robot);
  if (held == held_.end()) {
    refuse(
        fmt::format("robot {} does not report its calibration: is it switched on?", report_.robot));
    return;
  }
  report_.held = held->second;
  report_.stored = held->second;
  drive(Phase::kCheckBefore, calibration::checkPattern(experiment_.hardware.max_wheel_speed),
        report_.held);
}

void MotorCalibrator::drive(Phase phase, const calibration::Pattern& pattern,
                            const Motors& believed) {
  phase_ = phase;
  pattern_ = pattern;
  believed_ = believed;
  tries_ = 0;
  startPattern();
}

void MotorCalibrator::startPattern() {
  ++tries_;
  driver_ = std::make_unique<PatternDriver>(
      experiment_, report_.robot, believed_, pattern_, seen_robots_,
      DriveActions{[this](double left, double right) { command(left, right); },
                   [this] { controller_.command(standCommand(experiment_)); },
                   [this] { return controller_.isObeyedBy(report_.robot); }});
}

void MotorCalibrator::command(double left, double right) {
  robot_command_t command = standCommand(experiment_);
  // The lease without free run: a robot must not drive on for longer if commands stop.
  command.lease_ms = static_cast<std::int32_t>(std::lround(experiment_.hardware.lease * 1000));
  std::vector<std::int32_t>& others = command.orders.front().robot_ids;
  std::erase(others, report_.robot);
  command.orders.front().num_robots = static_cast<std::int32_t>(others.size());
  robot_order_t order{};
  order.robot_ids = {report_.robot};
  order.num_robots = 1;
  order.mode = robot_order_t::DRIVE;
  order.wheel_left = left;
  order.wheel_right = right;
  command.orders.push_back(order);
  command.num_orders = static_cast<std::int32_t>(command.orders.size());
  controller_.command(command);
}

void MotorCalibrator::finishPattern() {
  const std::unique_ptr<PatternDriver> driver = std::move(driver_);
  const double max = experiment_.hardware.max_wheel_speed;
  if (!driver->failure().empty()) {
    if (phase_ == Phase::kCheckAfter) {
      report_.refusal = driver->failure();
      return store(Phase::kTakeBack, report_.held);
    }
    return refuse(driver->failure());
  }
  const std::vector<calibration::CheckedSegment> segments = driver->segments();
  const calibration::SegmentCounts counts =
      calibration::usableSegments(calibration::segmentsOf(segments)).counts;
  if (counts.used < kUsableShare * counts.driven && tries_ < kPatternTries) return startPattern();
  if (phase_ == Phase::kCheckBefore) {
    before_ = segments;
    return drive(Phase::kPattern, calibration::calibrationPattern(report_.held, max), report_.held);
  }
  if (phase_ == Phase::kPattern) return fit(segments);
  report_.after = calibration::checkSpeeds(segments, report_.stored, max, report_.fit.lateral);
  report_.refusal = calibration::checkRefusal(report_.after);
  if (!report_.refusal.empty()) return store(Phase::kTakeBack, report_.held);
  finishRobot();
}

void MotorCalibrator::fit(const std::vector<calibration::CheckedSegment>& driven) {
  const double max = experiment_.hardware.max_wheel_speed;
  const std::vector<calibration::Segment> segments = calibration::segmentsOf(driven);
  Motors nominal;
  nominal.wheel_base = experiment_.hardware.diameter;
  report_.fit = calibration::fitMotors(segments, nominal, max);
  if (!report_.fit.refusal.empty()) return refuse(report_.fit.refusal);
  report_.before = calibration::checkSpeeds(before_, report_.held, max, report_.fit.lateral);
  report_.stored = calibration::fitStorable(report_.fit, segments, max);
  store(Phase::kStore, report_.stored);
}

void MotorCalibrator::store(Phase phase, const Motors& motors) {
  phase_ = phase;
  since_ = loop_.now();
  held_.erase(report_.robot);
  request({calibration::toMessage(report_.robot, motors)});
}

void MotorCalibrator::request(const std::vector<motor_calibration_t>& motors) {
  ++request_.seq;
  request_.robots = motors;
  request_.num_robots = static_cast<std::int32_t>(motors.size());
  next_request_ = loop_.now();
}

bool MotorCalibrator::isHeld(const Motors& motors) const {
  const auto held = held_.find(report_.robot);
  return held != held_.end() &&
         calibration::storable(held->second) == calibration::storable(motors);
}

void MotorCalibrator::stored() {
  if (phase_ == Phase::kTakeBack) {
    const std::string why = report_.refusal;
    return refuse(why + "; the previous calibration was restored");
  }
  drive(Phase::kCheckAfter, calibration::checkPattern(experiment_.hardware.max_wheel_speed),
        report_.stored);
}

// The robot may use the new values even though it did not confirm them, so the old ones are stored
// again.
void MotorCalibrator::failStoring() {
  if (phase_ == Phase::kStore) {
    report_.refusal =
        fmt::format("robot {} does not confirm that it stored its calibration", report_.robot);
    return store(Phase::kTakeBack, report_.held);
  }
  refuse(report_.refusal +
         "; it does not confirm the previous calibration either: the calibration "
         "that it uses is unknown, calibrate it again");
}

void MotorCalibrator::refuse(const std::string& why) {
  report_.refusal = why;
  finishRobot();
}

void MotorCalibrator::finishRobot() {
  if (!report_.refusal.empty()) report_.stored = report_.held;
  tell_(report_);
  nextRobot();
}

}  // namespace lab::runner
