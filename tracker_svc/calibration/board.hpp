/// A flat calibration board with a grid of black discs.
#pragma once

#include <string>

namespace lab::calibration {

struct BoardSpec {
  int columns = 9;
  int rows = 6;
  double spacing = 0.028;  ///< [m] between neighbouring centres; only its uniformity matters

  [[nodiscard]] double discRadius() const { return 0.3 * spacing; }
};

/// Parses "9x6,3": columns x rows, spacing in cm.
/// @throws std::invalid_argument with the value found and the format expected
[[nodiscard]] BoardSpec boardFrom(const std::string& text);

/// An SVG drawing to print at its own size.
[[nodiscard]] std::string boardSvg(const BoardSpec& board);

}  // namespace lab::calibration
