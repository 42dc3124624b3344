#pragma once

#include "robot/dynamics/robot_core.hpp"

namespace lab {
namespace avr {

/// The converter at 125 kHz, 104 us a conversion, supply as reference; emitters off.
void startConverter();

/// Begins a scan of all sensors, 1.6 ms; not while one is under way.
void beginScan();

/// From beginScan() until its readings were taken.
bool scanUnderWay();

/// True once after each scan, with its readings. An infrared reading is the one with the emitters
/// on less the one with them off, so that light from elsewhere does not count.
bool takeScan(dynamics::Sensors& sensors);

}  // namespace avr
}  // namespace lab
