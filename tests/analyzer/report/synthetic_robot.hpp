#pragma once

#include <cstdint>
#include <lab/robot_state_t.hpp>
#include <lab/tracked_pose_t.hpp>

#include "common/experiment/experiment.hpp"
#include "common/math/random.hpp"

namespace lab::report {

/// One robot with exact arcs, held draws, exact resume after reversals.
class SyntheticRobot {
 public:
  SyntheticRobot(std::int32_t id, const Experiment& experiment, std::int64_t boot);

  void setProgram(const RobotProgram& program, std::int64_t utime);
  void advance(double dt, std::int64_t utime);  ///< to utime
  [[nodiscard]] robot_state_t state(std::int64_t utime);
  [[nodiscard]] tracked_pose_t pose() const;

 private:
  void draw();
  void drive(double vl, double vr, double dt);
  [[nodiscard]] bool atWall(double direction) const;

  const Experiment& experiment_;
  Random random_;
  RobotProgram program_;
  robot_state_t state_{};
  double x_ = 0;
  double y_ = 0;
  double theta_ = 0;
  double left_ = 0;  ///< [m/s] held
  double right_ = 0;
  double hold_left_ = 0;  ///< [s] until the next draw
  bool tumbling_ = false;
  double reversal_direction_ = -1;
  double reversal_left_ = 0;  ///< [s] 0: none
};

}  // namespace lab::report
