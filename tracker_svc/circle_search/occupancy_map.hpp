/// Regions of a picture that are already assigned: circles found, elongated objects (which would be
/// found again in every row), and the surroundings of known caps.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lab::detector {

class OccupancyMap {
 public:
  OccupancyMap() = default;
  /// @param width,height [px] range of the coordinates
  OccupancyMap(int width, int height);

  void forget();

  /// Excludes a disc from the search.
  /// @param radius [px]
  void cover(float x, float y, float radius);
  /// Whether pixels first to last of a row lie in one excluded disc. May return false where many
  /// discs overlap.
  [[nodiscard]] bool isCovered(int first, int last, int y) const {
    const Nearby& nearby =
        nearby_[static_cast<std::size_t>(y / kWide * wide_columns_ + first / kWide)];
    for (std::size_t i = 0; i < static_cast<std::size_t>(nearby.count); ++i) {
      const Cover& cover = covers_[static_cast<std::size_t>(nearby.covers[i])];
      if (cover.holds(first, y) && cover.holds(last, y)) return true;
    }
    return false;
  }
  [[nodiscard]] bool isCovered(int x, int y) const { return isCovered(x, x, y); }

  /// Marks a circle, or an elongated object, as found.
  /// @param reach [px] around it
  /// @param dark [DN above black] of an elongated object; 0 for a circle
  void markOccupied(float x, float y, float reach, int dark);

  /// Whether a pixel belongs to something that was found.
  /// @param dark [DN above black] of the pixel: if much darker than an elongated object around it,
  ///   it may be a circle
  /// @param noise [DN]
  [[nodiscard]] bool isOccupied(float x, float y, int dark, int noise) const {
    const int number = cells_[cellAt(static_cast<int>(x), static_cast<int>(y))];
    return number >= 0 && holds(occupied_[static_cast<std::size_t>(number)], x, y, dark, noise);
  }

 private:
  static constexpr int kCell = 8;   // [px]
  static constexpr int kWide = 64;  // [px] of the cells that index covers

  struct OccupiedRegion {
    float x = 0, y = 0;
    float reach = 0;
    int dark = 0;
    int left = 0, top = 0, right = 0, bottom = 0;  // cells
  };
  struct Cover {
    float x, y;
    float square;  // of the radius
    [[nodiscard]] bool holds(int px, int py) const {
      const float dx = static_cast<float>(px) - x;
      const float dy = static_cast<float>(py) - y;
      return dx * dx + dy * dy < square;
    }
  };
  struct Nearby {  // covers that reach into a cell
    static constexpr std::int16_t kMost = 15;
    std::int16_t count = 0;
    std::array<std::int16_t, kMost> covers;
  };

  [[nodiscard]] static bool holds(const OccupiedRegion& region, float x, float y, int dark,
                                  int noise);
  [[nodiscard]] std::size_t cellAt(int x, int y) const {
    return static_cast<std::size_t>(y / kCell * columns_ + x / kCell);
  }

  int columns_ = 0;
  int rows_ = 0;
  std::vector<OccupiedRegion> occupied_;
  std::vector<Cover> covers_;
  int wide_columns_ = 0;
  int wide_rows_ = 0;
  std::vector<std::int16_t> cells_;  // index of the region, -1 if none
  std::vector<Nearby> nearby_;       // by wide cell
};

}  // namespace lab::detector
