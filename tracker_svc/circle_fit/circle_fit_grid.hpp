/// Starting points of fits, chosen so that every start near a circle gives the same bits. Internal
/// to the circle fit.
#pragma once

#include <cmath>
#include <optional>

#include "light/optics/grey_image.hpp"

namespace lab::detector::fit {

/// Fits start at points of a grid over the picture.
constexpr double kGrid = 0.5;  ///< [px]

struct GridPoint {
  int x = 0;
  int y = 0;
  [[nodiscard]] optics::Pixel pixel() const { return {x * kGrid, y * kGrid}; }
  bool operator==(const GridPoint&) const = default;
  [[nodiscard]] bool before(const GridPoint& o) const { return y != o.y ? y < o.y : x < o.x; }
};

/// Floor, for values within the range of int. std::floor is a library call on processors without
/// SSE 4.1.
template <typename Number>
int floorOf(Number value) {
  const int cut = static_cast<int>(value);
  return cut - (value < static_cast<Number>(cut) ? 1 : 0);
}

inline GridPoint nearest(const optics::Pixel& p) {
  return {floorOf(p.x / kGrid + 0.5), floorOf(p.y / kGrid + 0.5)};
}

/// Walks over the grid to the point whose own estimate of the centre lies in its own cell. If
/// neighbouring points both qualify, the first in reading order is taken, whichever was reached
/// first; this holds while their estimates differ by less than `doubt` [px].
/// @param estimate computes the centre from a grid point, using only that point and the picture;
///   returns std::optional<optics::Pixel>
template <typename Estimate>
std::optional<GridPoint> settle(GridPoint here, double doubt, int most_moves,
                                const Estimate& estimate) {
  GridPoint before = here;
  std::optional<optics::Pixel> found = estimate(here);
  for (int move = 0; found; ++move) {
    const GridPoint next = nearest(*found);
    if (next == here) break;
    if (move == most_moves) return std::nullopt;
    if (move > 0 && next == before)
      return here.before(next) ? here : next;  // both point at each other
    before = here;
    here = next;
    found = estimate(here);
  }
  if (!found) return std::nullopt;
  const double inner = 0.5 - doubt / kGrid;
  const double x = found->x / kGrid - here.x;
  const double y = found->y / kGrid - here.y;
  const int sx = x > inner ? 1 : x < -inner ? -1 : 0;
  const int sy = y > inner ? 1 : y < -inner ? -1 : 0;
  GridPoint chosen = here;
  for (const GridPoint neighbour : {GridPoint{here.x + sx, here.y}, GridPoint{here.x, here.y + sy},
                                    GridPoint{here.x + sx, here.y + sy}}) {
    if (!neighbour.before(chosen)) continue;
    const std::optional<optics::Pixel> centre = estimate(neighbour);
    if (centre && nearest(*centre) == neighbour) chosen = neighbour;
  }
  return chosen;
}

}  // namespace lab::detector::fit
