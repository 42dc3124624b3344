/// Displays using SDL2.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "projector_ctl/display/display.hpp"

namespace lab::projector {

/// All displays, in order of their numbers. @throws DisplayError if there is no desktop.
[[nodiscard]] std::vector<DisplayInfo> listDisplays();

/// One line per display: number, name, size, refresh rate, position.
[[nodiscard]] std::string describe(const std::vector<DisplayInfo>& displays);

/// Opens a full-screen window on the display `name_or_number`, a number or name as in
/// listDisplays(). It uses the desktop's display mode and hides cursor and screen saver. It is
/// drawn by the graphics card, synchronised with the vertical blank; without a graphics card,
/// through shared memory and not synchronised.
/// @throws DisplayError if there is no such display or no window can be opened.
[[nodiscard]] std::unique_ptr<Display> openSdlDisplay(const std::string& name_or_number);

}  // namespace lab::projector
