/// A printable sheet of caps to cut out.
#pragma once

#include <string>

#include "light/optics/cap.hpp"

namespace lab::calibration {

/// An SVG drawing of as many caps as fit on A4, at least one, to print at its own size: the
/// circles, a cutting line, ticks at the rim that mark the axis and the front, and a scale to check
/// with a ruler.
[[nodiscard]] std::string capSheetSvg(const optics::CapGeometry& cap);

}  // namespace lab::calibration
