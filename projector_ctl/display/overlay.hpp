/// What the projector says of itself on its own picture.
#pragma once

#include <string>
#include <vector>

#include "projector_ctl/display/frame_loop.hpp"
#include "projector_ctl/projector_core.hpp"

namespace lab::projector {

/// Frame rate, vsync, command and calibration, a line each.
/// @param rate [Hz] measured
[[nodiscard]] std::vector<std::string> overlayLines(const ShownFrame& shown,
                                                    const FrameLoop::SwappedFrame& swapped,
                                                    double rate);

}  // namespace lab::projector
