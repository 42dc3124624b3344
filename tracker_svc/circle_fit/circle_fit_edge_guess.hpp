/// Where the light on the white around a circle jumps: first guesses for the edge model. Internal
/// to the circle fit.
#pragma once

#include <array>
#include <cstdint>

#include "tracker_svc/circle_fit/circle_fit_edge_model.hpp"

namespace lab::detector::fit {

/// Borders between light and shade, and the light on their sides.
struct EdgeGuess {
  bool good = false;
  float gain = 0;  ///< [DN^2] what the levels take off the sum of squares, less the mean's
  std::array<Line, 2> line{};
  std::array<float, 4> level{};  ///< [DN] as in LitDisc
};

struct TwoEdgeGuesses {
  EdgeGuess parallel;  ///< two parallel lines: a stripe
  EdgeGuess crossing;  ///< two lines at a right angle: the corner of a checker
};

/// Which pixels around a circle: all, or those that the fit before believed.
enum class Pick : std::uint8_t { kAll, kBelieved };

/// The pixels around a circle that are just white.
class Surroundings {
 public:
  Surroundings(const Window& window, const Constants& constants, const Disc& disc, Pick pick);

  /// Whether the light on them differs by more than noise of this variance [DN^2], and by enough to
  /// matter. A light edge that crosses the circle crosses them as well.
  [[nodiscard]] bool uneven(float variance) const;

  /// The line that parts them best into two levels.
  [[nodiscard]] EdgeGuess oneLine() const;

  /// The two lines that part them best into three or four levels.
  [[nodiscard]] TwoEdgeGuesses twoLines() const;

 private:
  struct Sample {
    float x, y, light;
  };
  std::array<Sample, kMostPixels> samples_;
  int count_ = 0;
  float reach_ = 0;  ///< [px] of the farthest
};

}  // namespace lab::detector::fit
