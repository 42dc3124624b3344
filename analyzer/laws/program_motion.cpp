#include "analyzer/laws/program_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "robot/dynamics/kinematics.hpp"
#include "robot/dynamics/machine.hpp"
#include "robot/dynamics/odometry.hpp"

namespace lab::analysis {
namespace {

constexpr double kForever = 1e12;  // s
constexpr double kMicro = 1e-6;
constexpr double kMilli = 1e-3;

std::int32_t micrometres(double metres) {
  return static_cast<std::int32_t>(std::lround(metres / kMicro));
}

class ProgramMotion : public Motion {
 public:
  ProgramMotion(ByteCode code, const RobotBody& body) : code_(std::move(code)), body_(body) {
    wheel_.ideal = !body.pwm_steps;
    wheel_.max_um_s = micrometres(body.max_wheel_speed);
    inputs_.half_wheel_base_um = micrometres(body.wheel_base / 2);
    odometry_.setHalfWheelBase(inputs_.half_wheel_base_um);
    scan_ms_ = std::max<std::uint32_t>(
        1, static_cast<std::uint32_t>(std::lround(body.sensor_period / kMilli)));
  }

  Arc first(Random& random) override {
    rng_.seed(random.next());
    second_ = body_.clock_error > 0 ? 1 / (1 + body_.clock_error * random.normal()) : 1;
    next_scan_ms_ = 1 + static_cast<std::uint32_t>(random.next() % scan_ms_);
    machine_.start(code_->data(), static_cast<std::uint8_t>(code_->size()), inputs_, rng_);
    begin();
    return drive();
  }

  [[nodiscard]] int holds() const { return holds_; }  ///< Begun.

  Arc next(Random& /*random*/) override {
    if (left_ms_ == 0) begin();
    if (next_scan_ms_ == time_ms_ && machine_.canBeInterrupted()) {
      updateInputs();
      if (machine_.interrupted(inputs_, rng_)) begin();
    }
    if (next_scan_ms_ <= time_ms_) {
      next_scan_ms_ += ((time_ms_ - next_scan_ms_) / scan_ms_ + 1) * scan_ms_;
    }
    return drive();
  }

 private:
  void updateInputs() {
    inputs_.time_ms = time_ms_;
    inputs_.phase_time_ms = time_ms_ - phase_begin_ms_;
    inputs_.heading_turns = odometry_.headingTurns();
    inputs_.distance_um = odometry_.distanceUm();
  }

  void begin() {
    ++holds_;
    phase_begin_ms_ = time_ms_;
    updateInputs();
    const dynamics::PhaseResult hold = machine_.next(inputs_, rng_);
    bool saturated = false;
    left_um_s_ = dynamics::clampWheel(hold.left_um_s, wheel_.max_um_s, saturated);
    right_um_s_ = dynamics::clampWheel(hold.right_um_s, wheel_.max_um_s, saturated);
    left_ms_ = hold.duration_ms;
    const double left = dynamics::wheelSpeed(left_um_s_, wheel_);
    const double right = dynamics::wheelSpeed(right_um_s_, wheel_);
    speed_ = 0.5 * (left + right);
    turning_ = (right - left) / body_.wheel_base;
  }

  /// The arc to the end of the hold, or to the next look at its condition.
  Arc drive() {
    std::uint32_t ms = left_ms_;
    if (machine_.canBeInterrupted()) {
      ms = std::min(ms, next_scan_ms_ - time_ms_);
    } else if (ms == dynamics::kEndless) {
      return {speed_, turning_, kForever};
    }
    if (left_ms_ != dynamics::kEndless) left_ms_ -= ms;
    time_ms_ += ms;
    odometry_.add(left_um_s_, right_um_s_, ms);
    return {speed_, turning_, ms * kMilli * second_};
  }

  ByteCode code_;
  RobotBody body_;
  dynamics::WheelModel wheel_;
  dynamics::Machine machine_;
  dynamics::MachineInputs inputs_;
  dynamics::Odometry odometry_;
  dynamics::Rng rng_;
  int holds_ = 0;
  std::uint32_t scan_ms_ = 20;
  std::uint32_t next_scan_ms_ = 0;
  std::uint32_t left_ms_ = 0;  ///< Of the hold.
  std::uint32_t time_ms_ = 0;
  std::uint32_t phase_begin_ms_ = 0;
  std::int32_t left_um_s_ = 0;
  std::int32_t right_um_s_ = 0;
  double speed_ = 0;    ///< m/s.
  double turning_ = 0;  ///< rad/s.
  double second_ = 1;   ///< A second of the robot's clock, s.
};

}  // namespace

bool readsInput(const std::vector<std::uint8_t>& code, dynamics::Input input) {
  for (std::size_t block = 2; block < code.size(); block += 1U + code[block]) {
    const std::size_t end = block + 1 + code[block];
    for (std::size_t at = block + 1; at < end; at += dynamics::instructionSize(code[at])) {
      if (code[at] == dynamics::kRead && code[at + 1] == input) return true;
    }
  }
  return false;
}

std::unique_ptr<Motion> programMotion(const ByteCode& code, const RobotBody& body) {
  return std::make_unique<ProgramMotion>(code, body);
}

HoldFacts holdFacts(const ByteCode& code, const RobotBody& body) {
  constexpr int kMostArcs = 20000;
  constexpr int kMostHolds = 4000;
  RobotBody ideal = body;
  ideal.clock_error = 0;
  ProgramMotion motion(code, ideal);
  Random random(1);
  struct Hold {
    double duration = 0;
    double turning2 = 0;
  };
  std::vector<Hold> holds(1);
  Arc arc = motion.first(random);
  int begun = motion.holds();
  for (int i = 0; i < kMostArcs && motion.holds() <= kMostHolds; ++i) {
    if (arc.duration >= kForever) return {std::numeric_limits<double>::infinity(), 0, 0};
    if (motion.holds() != begun) holds.emplace_back();
    begun = motion.holds();
    holds.back().duration += arc.duration;
    holds.back().turning2 = arc.turning * arc.turning;
    arc = motion.next(random);
  }
  double time = 0;
  double turning2 = 0;
  for (const Hold& hold : holds) {
    time += hold.duration;
    turning2 += hold.duration * hold.turning2;
  }
  turning2 /= time;
  double scatter = 0;
  double longest = 0;
  double shortest = std::numeric_limits<double>::infinity();
  // The last one may be incomplete.
  for (std::size_t i = 0; i + 1 < holds.size(); ++i) {
    longest = std::max(longest, holds[i].duration);
    shortest = std::min(shortest, holds[i].duration);
  }
  for (const Hold& hold : holds) {
    scatter += std::pow(hold.duration * (hold.turning2 - turning2), 2);
  }
  HoldFacts facts;
  facts.mean = time / static_cast<double>(holds.size());
  if (turning2 > 0) facts.turning_scatter = scatter / (time * turning2 * turning2);
  if (longest - shortest < 0.5 * kMilli) facts.constant = longest;
  return facts;
}

SpeedSteps speedSteps(const ByteCode& code, const RobotBody& body) {
  constexpr int kArcs = 4000;
  RobotBody robot = body;
  robot.clock_error = 0;
  robot.pwm_steps = true;
  RobotBody ideal = robot;
  ideal.pwm_steps = false;
  // Both draw the same numbers.
  Random random(1);
  Random same_random(1);
  ProgramMotion stepped(code, robot);
  ProgramMotion ordered(code, ideal);
  struct Piece {
    double time = 0;
    double ordered = 0;  // m
    double change = 0;   // m
  };
  std::vector<Piece> pieces;
  double time = 0;
  double path = 0;
  double change = 0;
  Arc with = stepped.first(random);
  Arc without = ordered.first(same_random);
  for (int i = 0; i < kArcs; ++i) {
    const double duration = std::min(without.duration, kForever);
    pieces.push_back({duration, duration * without.speed, duration * (with.speed - without.speed)});
    time += duration;
    path += pieces.back().ordered;
    change += pieces.back().change;
    if (duration >= kForever) break;
    with = stepped.next(random);
    without = ordered.next(same_random);
  }
  SpeedSteps steps;
  if (path == 0) return steps;
  steps.relative = change / path;
  double squares = 0;
  for (const Piece& piece : pieces) {
    squares += std::pow(piece.change - steps.relative * piece.ordered, 2);
  }
  steps.sigma = std::sqrt(squares) / std::abs(path);
  steps.scatter = squares / time;
  return steps;
}

}  // namespace lab::analysis
