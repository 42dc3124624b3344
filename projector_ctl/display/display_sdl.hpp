/// Displays by SDL2.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "projector_ctl/display/display.hpp"

namespace lab::projector {

/// Every display, by number. @throws DisplayError when there is no desktop to ask.
[[nodiscard]] std::vector<DisplayInfo> listDisplays();

/// One line each: number, name, size, refresh rate, position.
[[nodiscard]] std::string describe(const std::vector<DisplayInfo>& displays);

/// A window over the whole display `wanted`, a number or a name as listDisplays() has it, in the
/// mode that the desktop has set; no cursor, no screen saver. Drawn by the graphics card with its
/// vertical blank, or, where there is no card, through shared memory without one.
/// @throws DisplayError when there is no such display or no window can be opened.
[[nodiscard]] std::unique_ptr<Display> openSdlDisplay(const std::string& wanted);

}  // namespace lab::projector
