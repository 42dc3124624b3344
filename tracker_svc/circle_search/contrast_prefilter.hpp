/// Where in a picture something may be much darker than what is near: told from the darkest and the
/// brightest of each cell, before any pixel is held against its neighbours.
#pragma once

#include <cstdint>
#include <vector>

#include "light/optics/grey_image.hpp"
#include "tracker_svc/circle_search/dark_pixels.hpp"

namespace lab::detector {

/// A cell is a word wide and so high that what is near lies in the next ones. Dark and bright are
/// of two pixels side by side, so that the noise of single ones in the dark is not taken for a
/// contrast; a circle is wider.
class ContrastPrefilter {
 public:
  ContrastPrefilter() = default;

  /// @param width,height of the pictures [px], at least a word and a pixel wide
  /// @param starts of the words [px]
  /// @param first,step [rows] that are looked at: first, first + step ...
  /// @param around [px] how far what is near may be
  ContrastPrefilter(int width, int height, const std::vector<int>& starts, int first, int step,
                    int around);

  /// Looks at some rows of a picture, both included, and at what is near them.
  void look(const optics::GreyView& picture, const Levels& levels, int top, int bottom);

  /// Words of a row that may hold pixels of circles.
  /// @param block of 64 words
  /// @return bit i: word 64 block + i
  [[nodiscard]] std::uint64_t words(int row, std::size_t block) const {
    return words_[static_cast<std::size_t>(row / tall_) * blocks_ + block];
  }

  /// Those of them in so little light that noise counts.
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
  struct Span {  // rows that are looked at
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
  int tall_ = 1;   // [rows] of a cell: some steps
  int cells_ = 0;  // one below the other
  std::size_t blocks_ = 0;
  std::size_t width_ = 0;             // words, and what fills up the last block
  std::vector<std::uint8_t> dark_;    // [DN] by cell, by word
  std::vector<std::uint8_t> bright_;  // [DN]
  std::vector<std::uint64_t> words_;
  std::vector<std::uint64_t> faint_;
};

}  // namespace lab::detector
