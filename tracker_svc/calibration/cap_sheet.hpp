/// A sheet of caps to print, cut out and put on robots.
#pragma once

#include <string>

#include "light/optics/cap.hpp"

namespace lab::calibration {

/// A drawing of as many caps as fit on A4, at least one, to print at its own size: the circles, a
/// line to cut along, ticks at the rim that show the axis and the front, and a length to hold a
/// ruler against.
[[nodiscard]] std::string capSheetSvg(const optics::CapGeometry& cap);

}  // namespace lab::calibration
