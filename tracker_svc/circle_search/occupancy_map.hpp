/// What of a picture is spoken for: circles that were found, long things that would only be found
/// again, and places around caps that are known.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lab::detector {

class OccupancyMap {
 public:
  OccupancyMap() = default;
  /// @param width,height [px] of the places that can be asked for
  OccupancyMap(int width, int height);

  void forget();

  /// Nothing is left to be found within.
  /// @param radius [px]
  void cover(float x, float y, float radius);
  /// A row's pixels from first to last, by one of those places. May say no where there are many.
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

  /// A circle, or something long, that was found.
  /// @param reach [px] around it
  /// @param dark [DN above black] of something long; 0: a circle
  void markOccupied(float x, float y, float reach, int dark);

  /// Whether it belongs to something that was found.
  /// @param dark [DN above black] of what is there: something much darker in the middle of
  ///   something long may be a circle after all
  /// @param noise [DN]
  [[nodiscard]] bool isOccupied(float x, float y, int dark, int noise) const {
    const int number = cells_[cellAt(static_cast<int>(x), static_cast<int>(y))];
    return number >= 0 && holds(occupied_[static_cast<std::size_t>(number)], x, y, dark, noise);
  }

 private:
  static constexpr int kCell = 8;   // [px]
  static constexpr int kWide = 64;  // [px] of the cells by which covers are found

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
  std::vector<std::int16_t> cells_;  // which region, -1: none
  std::vector<Nearby> nearby_;       // by wide cell
};

}  // namespace lab::detector
