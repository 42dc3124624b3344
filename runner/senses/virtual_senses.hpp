/// The numbers that the host writes for programs of motion, computed from poses. Pure.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "robot/dynamics/byte_code.hpp"

namespace lab::runner {

/// The pose of a robot in the arena frame.
struct SensedPose {
  std::int32_t id = 0;
  double x = 0;      ///< [m]
  double y = 0;      ///< [m]
  double theta = 0;  ///< [rad]
};

/// What a program reads as sense(0) to sense(7), in cm, s and rad.
using SenseValues = std::array<double, dynamics::kSenses>;

/// The light at a place [m], 0 to 1.
using LightAt = std::function<double(double x, double y)>;

/// The senses of every robot, in the order of `poses`. Only robots in `poses` count as neighbours.
/// An expression that is no finite number is 0.
/// @param light empty: dark
[[nodiscard]] std::vector<SenseValues> virtualSenses(const std::vector<SenseSpec>& senses,
                                                     const std::vector<SensedPose>& poses,
                                                     const LightAt& light);

}  // namespace lab::runner
