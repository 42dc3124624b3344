/// Finds the parts of a picture with enough local contrast for a circle, from the minimum and
/// maximum of each cell, so that the pixel-wise test can skip the rest.
#pragma once

#include <cstdint>
#include <vector>

#include "light/optics/grey_image.hpp"
#include "tracker_svc/circle_search/dark_pixels.hpp"

namespace lab::detector {

/// A cell is a word wide, and high enough that all neighbours of a pixel lie in adjacent cells.
/// Minimum and maximum are over means of two adjacent pixels, to reduce noise in dim light; a
/// circle is wider than two pixels.
class ContrastPrefilter {
 public:
  ContrastPrefilter() = default;

  /// @param width,height of the pictures [px], at least a word and a pixel wide
  /// @param starts of the words [px]
  /// @param first,step [rows] that are read: first, first + step ...
  /// @param around [px] largest distance of a neighbour
  ContrastPrefilter(int width, int height, const std::vector<int>& starts, int first, int step,
                    int around);

  /// Reads rows top to bottom of a picture (inclusive), and their neighbours.
  void look(const optics::GreyView& picture, const Levels& levels, int top, int bottom);

  /// Words of a row that may hold pixels of circles.
  /// @param block of 64 words
  /// @return bit i: word 64 block + i
  [[nodiscard]] std::uint64_t words(int row, std::size_t block) const {
    return words_[static_cast<std::size_t>(row / tall_) * blocks_ + block];
  }

  /// The subset of words() in light so dim that noise matters.
  [[nodiscard]] std::uint64_t faintWords(int row, std::size_t block) const {
    return faint_[static_cast<std::size_t>(row / tall_) * blocks_ + block];
  }
  [[nodiscard]] bool anyFaint(int row) const {
    const auto first = static_cast<std::size_t>(row / tall_) * blocks_;
    for (std::size_t block = 0; block < blocks_; ++block) {
      if (faint_[first + block] != 0) return true;
    }
    return false;
  }

 private:
  [[nodiscard]] std::size_t placeOf(int cell) const {
    return static_cast<std::size_t>(cell) * width_;
  }
  struct Span {  // rows that are read
    int top = 0;
    int count = 0;
  };
  [[nodiscard]] Span rowsOf(int cell) const;
  void lookAtRow(const optics::GreyView& picture, int cell);
  void compare(const Levels& levels, int top, int bottom);

  std::vector<int> starts_;
  int height_ = 0;
  int first_ = 0;
  int step_ = 1;
  int tall_ = 1;   // [rows] of a cell: several steps
  int cells_ = 0;  // number of rows of cells
  std::size_t blocks_ = 0;
  std::size_t width_ = 0;             // words, padded to whole blocks
  std::vector<std::uint8_t> dark_;    // [DN] by cell, by word
  std::vector<std::uint8_t> bright_;  // [DN]
  std::vector<std::uint64_t> words_;
  std::vector<std::uint64_t> faint_;
};

}  // namespace lab::detector
