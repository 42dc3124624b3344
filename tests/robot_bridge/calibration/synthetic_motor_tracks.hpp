/// Simulated tracks of a robot with known motors, with the tracker's noise.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "common/math/random.hpp"
#include "robot/dynamics/kinematics.hpp"
#include "robot_bridge/calibration/drive_pattern.hpp"
#include "robot_bridge/calibration/motor_fit.hpp"
#include "robot_bridge/calibration/speed_check.hpp"

namespace lab::calibration {

inline constexpr double kMaxSpeed = 0.27;  // m/s

struct Camera {
  double fps = 50;
  TrackNoise noise{3e-4, 0.0105};
};

class SyntheticRobot {
 public:
  SyntheticRobot(const Motors& motors, const Camera& camera, std::uint64_t seed)
      : motors_(motors), camera_(camera), random_(seed) {
    pose_.theta = 2 * std::numbers::pi * random_.uniform();
  }

  /// Offset of the tracked point to the left of the wheel axis' centre, m.
  void setLateral(double lateral) { lateral_ = lateral; }

  Segment drive(const PatternStep& step, const Motors& stored) {
    Segment segment;
    segment.duty_left = dutyFor(stored.left, step.left, kMaxSpeed, true);
    segment.duty_right = dutyFor(stored.right, step.right, kMaxSpeed, true);
    segment.frames = static_cast<int>(std::lround(step.duration * camera_.fps));
    const double left = wheelSpeed(motors_.left, segment.duty_left, kMaxSpeed);
    const double right = wheelSpeed(motors_.right, segment.duty_right, kMaxSpeed);
    const dynamics::Arc settle = dynamics::makeArc(left, right, motors_.wheel_base, kSettleTime);
    const dynamics::Arc frame = dynamics::makeArc(left, right, motors_.wheel_base, 1 / camera_.fps);
    pose_ = dynamics::apply(settle, pose_);
    for (int i = 0; i < segment.frames; ++i) {
      pose_ = dynamics::apply(frame, pose_);
      segment.track.push_back(seen(i / camera_.fps));
    }
    return segment;
  }

  std::vector<Segment> drive(const Pattern& pattern, const Motors& stored) {
    std::vector<Segment> segments;
    for (const PatternStep& step : pattern) segments.push_back(drive(step, stored));
    return segments;
  }

  std::vector<CheckedSegment> check(const Motors& stored) {
    std::vector<CheckedSegment> segments;
    for (const PatternStep& step : checkPattern(kMaxSpeed)) {
      segments.push_back({step.left, step.right, drive(step, stored)});
    }
    return segments;
  }

 private:
  TrackPoint seen(double time) {
    return {time,
            pose_.x - lateral_ * std::sin(pose_.theta) + camera_.noise.position * random_.normal(),
            pose_.y + lateral_ * std::cos(pose_.theta) + camera_.noise.position * random_.normal(),
            std::remainder(pose_.theta + camera_.noise.heading * random_.normal(),
                           2 * std::numbers::pi)};
  }

  Motors motors_;
  Camera camera_;
  Random random_;
  dynamics::Pose pose_;
  double lateral_ = 0;
};

}  // namespace lab::calibration
