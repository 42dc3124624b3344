#include "tests/analyzer/report/synthetic_robot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include "common/experiment/program_messages.hpp"

namespace lab::report {
namespace {

constexpr double kWallMargin = 0.0875;   // [m] IR range and radius
constexpr double kPoseNoise = 0.0002;    // [m]
constexpr double kHeadingNoise = 0.005;  // [rad]

}  // namespace

SyntheticRobot::SyntheticRobot(std::int32_t id, const Experiment& experiment, std::int64_t boot)
    : experiment_(experiment),
      random_(deriveSeed(experiment.seed, id, "synthetic") + static_cast<std::uint64_t>(boot)) {
  state_.robot_id = id;
  state_.origin = robot_state_t::SIM;
  state_.band = -1;
  x_ = 0.2 + 0.8 * random_.uniform();
  y_ = 0.2 + 0.5 * random_.uniform();
  theta_ = 2 * std::numbers::pi * random_.uniform();
}

void SyntheticRobot::setProgram(const Program& program, std::int64_t utime) {
  program_ = {};
  program_.law = program.law.name;
  const std::map<std::string, double Parameters::*> members{
      {"v", &Parameters::v},        {"va", &Parameters::va},
      {"V", &Parameters::V},        {"epsilon", &Parameters::epsilon},
      {"eta", &Parameters::eta},    {"gamma", &Parameters::gamma},
      {"tau_t", &Parameters::tau_t}};
  for (const ProgramParameter& one : program.parameters) {
    program_.*members.at(one.name) = one.value;
  }
  state_.program = toId(program);
  state_.band = 0;
  ++state_.program_epoch;
  state_.program_start_utime = utime;
  tumbling_ = program_.law == "rtp";  // draw() toggles: a program begins with a run
  draw();
  // The first hold is cut short, so that camera and robot are out of step.
  if (program_.law != "rtp") hold_left_ *= random_.uniform();
}

void SyntheticRobot::draw() {
  const double d = experiment_.hardware.diameter;
  hold_left_ = program_.epsilon;
  if (program_.law == "abp") {
    const double half_turn = program_.eta * (2 * random_.uniform() - 1) * d / 2;
    left_ = program_.v - half_turn;
    right_ = program_.v + half_turn;
  } else if (program_.law == "noisy_abp" || program_.law == "bp") {
    left_ = program_.va + program_.V * (2 * random_.uniform() - 1);
    right_ = program_.va + program_.V * (2 * random_.uniform() - 1);
  } else if (program_.law == "rtp") {
    tumbling_ = !tumbling_;
    if (tumbling_) {
      ++state_.tumble_count;
      hold_left_ = program_.tau_t;
      const double turn = std::numbers::pi * (2 * random_.uniform() - 1);
      right_ = turn / program_.tau_t * d / 2;
      left_ = -right_;
    } else {
      hold_left_ = -std::log(1 - random_.uniform()) / program_.gamma;
      left_ = right_ = program_.v;
    }
  } else {
    hold_left_ = 1e9;
    left_ = right_ = 0;
  }
}

void SyntheticRobot::drive(double vl, double vr, double dt) {
  const double turn = (vr - vl) / experiment_.hardware.diameter * dt;
  const double arc = 0.5 * (vl + vr) * dt;
  const double chord = std::abs(turn) < 1e-9 ? arc : arc * std::sin(turn / 2) / (turn / 2);
  x_ += chord * std::cos(theta_ + turn / 2);
  y_ += chord * std::sin(theta_ + turn / 2);
  theta_ += turn;
}

bool SyntheticRobot::atWall(double direction) const {
  const double vx = direction * std::cos(theta_);
  const double vy = direction * std::sin(theta_);
  return (x_ < kWallMargin && vx < 0) || (x_ > experiment_.arena_width - kWallMargin && vx > 0) ||
         (y_ < kWallMargin && vy < 0) || (y_ > experiment_.arena_height - kWallMargin && vy > 0);
}

void SyntheticRobot::advance(double dt, std::int64_t utime) {
  if (reversal_left_ > 0) {
    const double speed = reversal_direction_ * experiment_.reversal.speed;
    drive(speed, speed, dt);
    reversal_left_ -= dt;
    if (reversal_left_ <= 1e-9 || atWall(reversal_direction_)) {
      reversal_left_ = 0;
      state_.reversal_end_utime = utime;
    }
    return;
  }
  double left = dt;
  while (left > 1e-12) {
    const double step = std::min(left, hold_left_);
    drive(left_, right_, step);
    if (program_.law == "rtp" && !tumbling_) state_.run_time += step;
    hold_left_ -= step;
    left -= step;
    if (hold_left_ <= 1e-12) draw();
  }
  const double direction = left_ + right_ >= 0 ? 1 : -1;
  if (std::abs(left_ + right_) > 1e-6 && atWall(direction)) {
    reversal_direction_ = -direction;
    reversal_left_ = experiment_.reversal.distance / experiment_.reversal.speed;
    ++state_.reversal_count;
    state_.reversal_start_utime = utime;
    state_.reversal_end_utime = 0;
  }
}

robot_state_t SyntheticRobot::state(std::int64_t utime) {
  state_.utime = utime;
  state_.flags = 0;
  if (reversal_left_ > 0) state_.flags |= robot_state_t::FLAG_REVERSING;
  if (tumbling_) state_.flags |= robot_state_t::FLAG_TUMBLING;
  state_.program_left = left_;
  state_.program_right = right_;
  return state_;
}

tracked_pose_t SyntheticRobot::pose() const {
  tracked_pose_t pose{};
  pose.robot_id = state_.robot_id;
  Random noise(static_cast<std::uint64_t>(std::llround(x_ * 1e12)) ^
               static_cast<std::uint64_t>(std::llround(theta_ * 1e12)));
  pose.x = x_ + kPoseNoise * noise.normal();
  pose.y = y_ + kPoseNoise * noise.normal();
  pose.theta = std::remainder(theta_ + kHeadingNoise * noise.normal(), 2 * std::numbers::pi);
  pose.covariance[0] = pose.covariance[3] = kPoseNoise * kPoseNoise;
  pose.covariance[5] = kHeadingNoise * kHeadingNoise;
  pose.confidence = 1;
  return pose;
}

}  // namespace lab::report
