#include "robot_bridge/calibration/speed_check.hpp"

#include <cmath>

#include "robot_bridge/calibration/track_noise.hpp"

namespace lab::calibration {
namespace {

class RootMeanSquare {
 public:
  void add(double value) {
    sum_ += value * value;
    ++count_;
  }
  [[nodiscard]] double value() const { return count_ > 0 ? std::sqrt(sum_ / count_) : 0; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

constexpr double kStill = 1e-9;  // [m/s], [rad/s] ordered values below count as 0

}  // namespace

std::vector<Segment> segmentsOf(const std::vector<CheckedSegment>& checked) {
  std::vector<Segment> segments;
  segments.reserve(checked.size());
  for (const CheckedSegment& one : checked) segments.push_back(one.segment);
  return segments;
}

SpeedCheck checkSpeeds(const std::vector<CheckedSegment>& segments, const Motors& stored,
                       double max, double lateral) {
  const UsableSegments usable = usableSegments(segmentsOf(segments));
  SpeedCheck check;
  check.driven = usable.counts.driven;
  check.used = usable.counts.used;
  RootMeanSquare speed, turn, veer, motors_speed, motors_turn, speed_noise, turn_noise;
  for (const UsableSegment& segment : usable.segments) {
    const CheckedSegment& checked = segments[segment.index];
    const Motion asked = motionOf(checked.left, checked.right, stored.wheel_base);
    const Motion rounded = motionOf(stored, segment.duty_left, segment.duty_right, max);
    const double measured_turn = segment.motion.value[1];
    const double measured_speed = segment.motion.value[0] + lateral * measured_turn;
    if (std::fabs(asked.speed) > kStill) {
      speed.add(measured_speed / asked.speed - 1);
      motors_speed.add((measured_speed - rounded.speed) / asked.speed);
      speed_noise.add(std::sqrt(segment.motion.covariance(0, 0)) / asked.speed);
    }
    if (std::fabs(asked.turn) > kStill) {
      turn.add(measured_turn / asked.turn - 1);
      motors_turn.add((measured_turn - rounded.turn) / asked.turn);
      turn_noise.add(std::sqrt(segment.motion.covariance(1, 1)) / asked.turn);
    } else if (std::fabs(asked.speed) > kStill) {
      veer.add(measured_turn / measured_speed);
    }
  }
  check.speed = speed.value();
  check.turn = turn.value();
  check.veer = veer.value();
  check.motors_speed = motors_speed.value();
  check.motors_turn = motors_turn.value();
  check.speed_noise = speed_noise.value();
  check.turn_noise = turn_noise.value();
  return check;
}

}  // namespace lab::calibration
