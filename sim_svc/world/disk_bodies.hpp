/// Positions and motions of disks, as arrays.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "robot/dynamics/kinematics.hpp"
#include "sim_svc/world/arena.hpp"

namespace lab::sim {

/// How a robot moves.
struct Motion {
  double speed = 0;  ///< Forward [m/s].
  double turn = 0;   ///< Turning rate [rad/s].
};

/// Disks that move along exact arcs. One array per quantity, because a step moves all of them.
struct DiskBodies {
  std::vector<Vec> centre;  ///< [m]
  std::vector<double> theta;
  std::vector<double> turned;                ///< Free rotation since the step began [rad].
  std::vector<double> heading_x, heading_y;  ///< Unit vectors.
  std::vector<double> speed, turn;           ///< As driven, without regard to contacts.

  void add(const dynamics::Pose& pose) {
    centre.push_back({pose.x, pose.y});
    theta.push_back(pose.theta);
    for (std::vector<double>* values : {&turned, &heading_x, &heading_y, &speed, &turn}) {
      values->push_back(0);
    }
    setTheta(theta.size() - 1, pose.theta);
  }

  [[nodiscard]] Vec heading(std::size_t i) const { return {heading_x[i], heading_y[i]}; }

  void setTheta(std::size_t i, double value) {
    theta[i] = value;
    heading_x[i] = std::cos(value);
    heading_y[i] = std::sin(value);
  }

  /// Rotates disk i along an arc. Rotating the heading is cheaper than cos and sin of theta;
  /// setTheta() removes the rounding errors that this accumulates.
  void rotate(std::size_t i, const dynamics::Arc& arc) {
    const Vec along = heading(i);
    theta[i] += arc.dtheta;
    turned[i] += arc.dtheta;
    heading_x[i] = along.x * arc.cos_turn - along.y * arc.sin_turn;
    heading_y[i] = along.y * arc.cos_turn + along.x * arc.sin_turn;
  }

  /// The move of disk i along an arc.
  [[nodiscard]] Vec along(std::size_t i, const dynamics::Arc& arc) const {
    return {heading_x[i] * arc.dx - heading_y[i] * arc.dy,
            heading_y[i] * arc.dx + heading_x[i] * arc.dy};
  }

  /// Moves disk i for the time dt [s].
  void move(std::size_t i, double dt) {
    const dynamics::Arc arc = dynamics::makeArcOf(speed[i], turn[i], dt);
    const Vec move = along(i, arc);
    centre[i].x += move.x;
    centre[i].y += move.y;
    rotate(i, arc);
  }

  /// Moves the disks from `begin` to before `end`, disk i for the time dt[i] [s]: the same numbers
  /// as of move(), several disks at a time.
  void moveEach(std::size_t begin, std::size_t end, const double* dt);
};

}  // namespace lab::sim
