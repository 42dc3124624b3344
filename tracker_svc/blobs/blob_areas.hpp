/// Which pixels belong to which blob: its inside, the blurred edge around it, and the ground beside
/// it.
#pragma once

#include <cstdint>
#include <vector>

#include "tracker_svc/blobs/pixel_regions.hpp"

namespace lab::detector {

/// A pixel and the number of steps from the region that it was reached from.
struct AreaPixel {
  int x = 0;
  int y = 0;
  int steps = 0;  ///< 0: inside
};

/// The surroundings of one region, up to those of its neighbours.
struct BlobArea {
  std::vector<AreaPixel> pixels;
  std::vector<int> neighbours;  ///< regions so close that the blur mixes them, ascending
  bool cut = false;             ///< by the border of the picture
};

/// Grows regions step by step, alternately to four and to eight neighbours, until they meet.
class BlobAreas {
 public:
  /// @param edge [steps] width of a blurred edge, that belongs to the blob
  /// @param ground [steps] width of the ring of ground around it
  /// @param close [steps] from both regions, where they are neighbours if they meet
  /// @return one area for each region
  [[nodiscard]] std::vector<BlobArea> grow(const std::vector<PixelRegion>& regions, int width,
                                           int height, int edge, int ground, int close);

 private:
  std::vector<std::int32_t> owner_;  ///< by pixel: region + 1, 0: none. Zero between calls.
  std::vector<std::uint8_t> steps_;  ///< by pixel
};

}  // namespace lab::detector
