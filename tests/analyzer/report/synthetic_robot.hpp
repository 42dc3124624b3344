#pragma once

#include <cstdint>
#include <lab/robot_state_t.hpp>
#include <lab/tracked_pose_t.hpp>
#include <string>

#include "common/experiment/experiment.hpp"
#include "common/math/random.hpp"

namespace lab::report {

/// One robot with exact arcs, held draws, exact resume after reversals.
class SyntheticRobot {
 public:
  SyntheticRobot(std::int32_t id, const Experiment& experiment, std::int64_t boot);

  void setProgram(const Program& program, std::int64_t utime);
  void advance(double dt, std::int64_t utime);  ///< to utime
  [[nodiscard]] robot_state_t state(std::int64_t utime);
  [[nodiscard]] tracked_pose_t pose() const;

 private:
  void draw();
  void drive(double vl, double vr, double dt);
  [[nodiscard]] bool atWall(double direction) const;

  const Experiment& experiment_;
  Random random_;
  /// The parameters of the paper's programs, SI units.
  struct Parameters {
    std::string law;
    double v = 0, va = 0, V = 0, epsilon = 0, eta = 0, gamma = 0, tau_t = 0;
  };
  Parameters program_;
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
