#pragma once

#include "robot/dynamics/robot_core.hpp"

namespace lab {
namespace avr {

/// Starts the converter: 125 kHz, 104 us per conversion, supply voltage as reference, emitters off.
void startConverter();

/// Begins a scan of all sensors, which takes 1.6 ms. Must not be called during a scan.
void beginScan();

/// Whether a scan is in progress, or its readings were not fetched yet by takeScan().
bool scanUnderWay();

/// Returns true once after each scan, with its readings. An infrared reading is the difference
/// between emitters on and off, which removes ambient light.
bool takeScan(dynamics::Sensors& sensors);

}  // namespace avr
}  // namespace lab
