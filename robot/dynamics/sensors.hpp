#pragma once

#include <stdint.h>

namespace lab {
namespace dynamics {

/// The infrared sensors sit on the rim, counter-clockwise from the front: 0, +60, +120, 180, -120
/// and -60 degrees. A reading is 0 with nothing in range and 1023 when touching.
constexpr uint8_t kIrSensors = 6;

/// What the robot measures in one scan, in counts 0..1023.
struct Sensors {
  uint16_t light_front = 0;
  uint16_t light_back = 0;
  uint16_t ir[kIrSensors] = {0, 0, 0, 0, 0, 0};
};

}  // namespace dynamics
}  // namespace lab
