/// Where in a picture black circles of the right sizes on something white may be: one pass at the
/// speed of memory, no threshold for the picture as a whole.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "optics/image.hpp"
#include "optics/imaging.hpp"
#include "tracker_svc/scale_map.hpp"

namespace lab::tracker {

/// A circle, known to about a tenth of its radius.
struct Spot {
  float x = 0;      ///< [px]
  float y = 0;      ///< [px]
  float white = 0;  ///< [DN] around it, black level taken off
  bool can_be_big = false;
  bool can_be_small = false;
};

/// A part of a picture: first to last column and row, both included.
struct Region {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;
};

/// Something dark that was looked at and is no circle.
struct Refused {
  float x = 0;
  float y = 0;
  float seen = 0;    ///< [1] share of directions with an outline at the right distance
  float wanted = 0;
};

/// Every few rows, each pixel is held against its neighbours at a bit more than the big radius, in
/// four directions through it: less than half as bright as both in at least one direction makes a
/// candidate. A light edge beside or across a circle leaves at least one direction that lies along
/// it. Candidates are then centred on the outline around them.
class CircleSearch {
 public:
  /// @param width,height of the pictures [px], with `padding` that was added on every side
  CircleSearch(const ScaleMap& scale, const optics::CapGeometry& cap,
               const optics::Imaging& imaging, int width, int height, int padding = 0);

  /// The circles whose candidates lie in one of the regions, in the order of their top rows. A
  /// circle is found in the same place whatever the regions, if one of them holds all of it.
  void find(const optics::GreyView& picture, std::span<const Region> regions,
            std::vector<Spot>& spots, std::vector<Refused>* refused);

  /// The circle of the given size that a spot is part of; empty where the outline is not there.
  [[nodiscard]] std::optional<Spot> centredAs(const optics::GreyView& picture, const Spot& spot,
                                              bool big) const;

 private:
  static constexpr int kWord = 32;       // pixels tested at once
  static constexpr int kDirections = 16;
  static constexpr int kBand = 32;       // rows that share one set of sizes
  static constexpr int kCell = 8;        // [px] of the map of circles already found

  struct Sizes {  // of one word in one band
    std::int16_t across = 0;    // [px] to the neighbours in a row and in a column, 0: no cap here
    std::int16_t diagonal = 0;  // [px] to those on the diagonals, each way
    std::int16_t near = 0;      // [px] to a place that is inside of both circles
    float big = 0;              // [px]
    float small = 0;            // [px]
  };
  struct Ring {  // what one look around a point gives
    int outlines = 0;      // directions with an outline near the right distance
    int open = 0;          // pairs of opposite directions without any
    float dx = 0, dy = 0;  // [px] where the centre rather is
    float white = 0;       // [DN]
  };

  enum class Shape : std::uint8_t { kRound, kLong, kThin, kOther };
  struct Claim {  // a circle, or something long, that was found
    float x = 0, y = 0;
    float reach = 0;  // [px]
    int dark = 0;     // [DN] of something long, 0: a circle
    int left = 0, top = 0, right = 0, bottom = 0;  // cells
  };

  void mark(const Region& region);
  void testRow(const optics::GreyView& picture, int y);
  void takeWord(const optics::GreyView& picture, int y, int x, const Sizes& sizes);
  void takeRun(const optics::GreyView& picture, int x, int y, int white, const Sizes& sizes);
  [[nodiscard]] bool standsOut(const optics::GreyView& picture, int x, int y,
                               const Sizes& sizes) const;
  [[nodiscard]] Shape shapeAround(const optics::GreyView& picture, int x, int y, int white,
                                  const Sizes& sizes, Spot& spot) const;
  [[nodiscard]] Ring lookAround(const optics::GreyView& picture, float x, float y, float radius,
                                float slack) const;
  [[nodiscard]] bool weigh(const optics::GreyView& picture, float x, float y, const Sizes& sizes,
                           Spot& spot) const;
  [[nodiscard]] bool settle(const optics::GreyView& picture, float x, float y, const Sizes& sizes,
                            Spot& spot);
  [[nodiscard]] int centre(const optics::GreyView& picture, float x, float y, float radius,
                           Spot& spot) const;
  void forget();
  [[nodiscard]] bool known(float x, float y, int dark) const;
  void remember(const Spot& spot, float radius, int dark);
  [[nodiscard]] const Sizes& sizesAt(int y) const;  // of the first word

  optics::Imaging imaging_;
  int width_;
  int height_;
  int step_ = 3;     // [rows] between tested ones
  int margin_ = 0;   // [px] at the edges of the picture where nothing is tested
  int black_ = 0;    // [DN]
  float softness_ = 0;  // [px] standard deviation of blur and pixel
  int noise_ = 0;    // [DN] a difference that read noise alone does not make
  std::vector<int> word_starts_;
  std::vector<Sizes> sizes_;  // by band, by word
  std::array<float, kDirections> cos_{};
  std::array<float, kDirections> sin_{};
  std::vector<Spot>* spots_ = nullptr;
  std::vector<Refused>* refused_ = nullptr;
  int cell_columns_ = 0;
  std::vector<std::int16_t> cells_;  // last circle that covers each cell, -1: none
  std::vector<Claim> claims_;
  std::vector<std::int16_t> across_;  // of the row that is tested, by word
  std::vector<int> words_;            // in it that were found
  std::vector<std::uint8_t> marks_;  // by tested row, by word: to be tested
};

}  // namespace lab::tracker
