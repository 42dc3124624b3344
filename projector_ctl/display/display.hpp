/// Interface to a display: SDL, or a test double.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "light/optics/grey_image.hpp"
#include "projector_ctl/painter/box.hpp"

namespace lab::projector {

/// An error of a display, with one line of text: the operation, what was found, what to do.
class DisplayError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Properties of a display.
struct DisplayInfo {
  int number = 0;           ///< counts from 0
  std::string name{};       ///< "HDMI-1 24\""
  int x = 0;                ///< [px] position on the desktop
  int y = 0;                ///< [px]
  int width = 0;            ///< [px]
  int height = 0;           ///< [px]
  double refresh_rate = 0;  ///< [Hz] 0: unknown
};

enum class DisplayEvent : std::int8_t {
  kEscape,   ///< the key Escape
  kOverlay,  ///< the key O, which switches the overlay on or off
  kClosed,   ///< the user has closed the window
  kGone,     ///< the display was unplugged or switched off
  kResized,  ///< its size has changed; it must be opened again
  kTab,      ///< this and the following keys adjust corners
  kLeft,
  kRight,
  kUp,
  kDown,
  kFastLeft,
  kFastRight,
  kFastUp,
  kFastDown,
  kEnter,
};

/// A full-screen window on a display, from construction to destruction, in one thread.
class Display {
 public:
  Display() = default;
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;
  virtual ~Display() = default;

  [[nodiscard]] virtual const DisplayInfo& info() const = 0;

  /// Whether present() may wait for the display. Whether it does is for the caller to measure.
  [[nodiscard]] virtual bool mayWait() const = 0;

  /// Shows a picture of the display's size that differs from the last one only in `changed`, and
  /// returns when it is on the display; with mayWait() this is usually the next refresh.
  /// @throws DisplayError if the display is gone.
  virtual void present(const optics::GreyView& picture, std::span<const Box> changed) = 0;

  /// The events since the last call, in order.
  [[nodiscard]] virtual std::vector<DisplayEvent> events() = 0;
};

/// Opens the display that the experiment names. @throws DisplayError.
using OpenDisplay = std::function<std::unique_ptr<Display>()>;

}  // namespace lab::projector
