/// Connected regions of pixels.
#pragma once

#include <cstddef>
#include <vector>

namespace lab::detector {

/// Pixels first <= x <= last of a row.
struct PixelRun {
  int y = 0;
  int first = 0;
  int last = 0;
};

/// Pixels that touch each other, also at corners.
struct PixelRegion {
  std::vector<PixelRun> runs;  ///< by row, then by column
  int pixels = 0;
  int x0 = 0, y0 = 0, x1 = -1, y1 = -1;  ///< first and last column and row
};

/// Joins runs into regions, with a union-find structure.
class RegionFinder {
 public:
  void begin();

  /// Adds a run right of or below all earlier ones.
  void add(const PixelRun& run);

  /// All regions, in the order of their first runs.
  [[nodiscard]] std::vector<PixelRegion> regions();

 private:
  [[nodiscard]] std::size_t rootOf(std::size_t run);

  std::vector<PixelRun> runs_;
  std::vector<std::size_t> parents_;
  std::size_t row_ = 0;        ///< first run of the last row
  std::size_t above_ = 0;      ///< run of the row above from which on runs may touch the next one
  std::size_t above_end_ = 0;  ///< end of the runs of the row above
};

}  // namespace lab::detector
