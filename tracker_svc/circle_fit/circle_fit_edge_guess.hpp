/// First guesses of the light edges around a circle, for the edge model. Internal to the circle
/// fit.
#pragma once

#include <array>
#include <cstdint>

#include "tracker_svc/circle_fit/circle_fit_edge_model.hpp"

namespace lab::detector::fit {

/// Borders between light and shade, and the light level on each side.
struct EdgeGuess {
  bool good = false;
  float gain = 0;  ///< [DN^2] reduction of the sum of squares, compared with one mean level
  std::array<Line, 2> line{};
  std::array<float, 4> level{};  ///< [DN] as in LitDisc
};

struct TwoEdgeGuesses {
  EdgeGuess parallel;  ///< two parallel lines: the edges of a stripe
  EdgeGuess crossing;  ///< two perpendicular lines: the corner of a checkerboard
};

/// Pixels around a circle: all, or those that had a weight in the previous fit.
enum class Pick : std::uint8_t { kAll, kWellFitted };

/// The white pixels around a circle.
class Surroundings {
 public:
  Surroundings(const Window& window, const Constants& constants, const Disc& disc, Pick pick);

  /// Whether their light varies by more than noise of this variance [DN^2], and by a relevant
  /// amount. A light edge across the circle crosses them as well.
  [[nodiscard]] bool uneven(float variance) const;

  /// The line that separates them best into two levels.
  [[nodiscard]] EdgeGuess oneLine() const;

  /// The two lines that separate them best into three or four levels.
  [[nodiscard]] TwoEdgeGuesses twoLines() const;

 private:
  struct Sample {
    float x, y, light;
  };
  std::array<Sample, kMostPixels> samples_;
  int count_ = 0;
  float reach_ = 0;  ///< [px] distance of the farthest pixel
};

}  // namespace lab::detector::fit
