/// What of a picture is spoken for: circles that were found, long things that would only be found
/// again, and places around caps that are known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lab::detector {

class ClaimMap {
 public:
  ClaimMap() = default;
  /// @param width,height [px] of the places that can be asked for
  ClaimMap(int width, int height);

  void forget();

  /// Nothing is left to be found within.
  /// @param radius [px]
  void cover(float x, float y, float radius);
  /// May say no where two of those places overlap.
  [[nodiscard]] bool isCovered(int x, int y) const;
  /// A row's pixels from first to last: a place that holds both holds all between them.
  [[nodiscard]] bool isCovered(int first, int last, int y) const {
    return isCovered(first, y) && isCovered(last, y) &&
           covered_[cellAt(first, y)] == covered_[cellAt(last, y)];
  }

  /// A circle, or something long, that was found.
  /// @param reach [px] around it
  /// @param dark [DN above black] of something long; 0: a circle
  void claim(float x, float y, float reach, int dark);

  /// Whether it belongs to something that was found.
  /// @param dark [DN above black] of what is there: something much darker in the middle of
  ///   something long may be a circle after all
  /// @param noise [DN]
  [[nodiscard]] bool isClaimed(float x, float y, int dark, int noise) const;

 private:
  static constexpr int kCell = 8;  // [px]

  struct Claim {
    float x = 0, y = 0;
    float reach = 0;
    int dark = 0;
    int left = 0, top = 0, right = 0, bottom = 0;  // cells
  };
  struct Cover {
    float x, y;
    float square;  // of the radius
  };

  [[nodiscard]] std::size_t cellAt(int x, int y) const {
    return static_cast<std::size_t>(y / kCell * columns_ + x / kCell);
  }

  int columns_ = 0;
  int rows_ = 0;
  std::vector<Claim> claims_;
  std::vector<Cover> covers_;
  std::vector<std::int16_t> cells_;    // which claim, -1: none
  std::vector<std::int16_t> covered_;  // which cover, -1: none
};

}  // namespace lab::detector
