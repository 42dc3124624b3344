/// A flat board with a grid of black discs, to show to a camera.
#pragma once

#include <string>

namespace lab::calibration {

struct BoardSpec {
  int columns = 9;
  int rows = 6;
  double spacing = 0.028;  ///< [m] between the centres of neighbours; only its evenness matters

  [[nodiscard]] double discRadius() const { return 0.3 * spacing; }
};

/// From "9x6,3": columns x rows, spacing in cm.
/// @throws std::invalid_argument: what was found and what was expected
[[nodiscard]] BoardSpec boardFrom(const std::string& text);

/// A drawing to print at its own size.
[[nodiscard]] std::string boardSvg(const BoardSpec& board);

}  // namespace lab::calibration
