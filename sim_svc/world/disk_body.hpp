/// The state of one moving disk.
#pragma once

#include "sim_svc/world/arena.hpp"

namespace lab::sim {

/// How a robot moves.
struct Motion {
  double speed = 0;  ///< Forward [m/s].
  double turn = 0;   ///< Turning rate [rad/s].
};

/// A disk without its position, which is kept apart for the processor's cache.
struct DiskBody {
  double theta = 0;
  Vec heading{1, 0};  ///< Unit vector.
  Motion motion;      ///< As driven, without regard to contacts.
  double turned = 0;  ///< Free rotation since the step began [rad].
};

}  // namespace lab::sim
