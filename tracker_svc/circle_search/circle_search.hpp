/// Finds places in a picture that may be black circles of the right sizes on a white cap. One pass
/// at memory speed, without a global threshold.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "light/optics/grey_image.hpp"
#include "light/photometry/imaging.hpp"
#include "tracker_svc/circle_search/candidate.hpp"
#include "tracker_svc/circle_search/contrast_prefilter.hpp"
#include "tracker_svc/circle_search/dark_pixels.hpp"
#include "tracker_svc/circle_search/occupancy_map.hpp"
#include "tracker_svc/circle_search/outline_fitter.hpp"
#include "tracker_svc/circle_search/padded_picture.hpp"
#include "tracker_svc/detector/scale_map.hpp"

namespace lab::detector {

/// Which rows are tested.
enum class Rows : std::uint8_t { kSome, kAll };

/// Tests about two rows per small circle. Each pixel is compared with its neighbours at slightly
/// more than the big radius, along four axes: it is a candidate if it is less than half as bright
/// as both ends of at least one axis. A light edge beside or across a circle leaves at least the
/// axis parallel to it. Candidates are then centred on the outline around them.
class CircleSearch {
 public:
  /// @param width,height of the pictures [px]
  CircleSearch(const ScaleMap& scale, const optics::CapGeometry& cap,
               const optics::Imaging& imaging, int width, int height);

  /// Finds the circles whose candidates lie in one of the regions, ordered by top row. The result
  /// for a circle does not depend on the regions if one of them contains all of it.
  void find(const optics::GreyView& picture, std::span<const Region> regions,
            std::vector<Spot>& spots, std::vector<RejectedSpot>* rejected);

  /// find() in two steps. The first finds complete circles and stores other dark candidates; the
  /// second examines these closely, except in areas excluded by cover(): most of them are rims and
  /// sides of caps.
  void findRound(const optics::GreyView& picture, std::span<const Region> regions,
                 std::vector<Spot>& spots, std::vector<RejectedSpot>* rejected);
  /// @param rows kAll if light edges may leave so little of a circle that a row misses it
  void findRest(Rows rows, std::vector<Spot>& spots, std::vector<RejectedSpot>* rejected);

  /// Excludes an area from the search.
  /// @param radius [px]
  void cover(double x, double y, double radius);

  /// Sets the picture for circleAt().
  void aimAt(const optics::GreyView& picture);

  /// The circle around a place, if its whole outline is visible, it may be of that size, it is not
  /// in the dark and not at the edge of the picture. find() gives the same result for such a
  /// circle.
  [[nodiscard]] std::optional<Spot> circleAt(optics::Pixel place, bool big) const;

  /// The circle of the given size that a spot is part of, in the picture last given to find(),
  /// which must still exist; empty if there is no such outline.
  [[nodiscard]] std::optional<Spot> centredAs(const Spot& spot, bool big);

 private:
  static constexpr int kBand = 32;  // rows that share one set of sizes

  void addSizes(const ScaleMap& scale, const optics::CapGeometry& cap);
  /// @param around [px] distance around it that is read
  [[nodiscard]] bool isInner(int x, int y, int around) const;
  [[nodiscard]] const Plane& planeAt(int x, int y, int around);
  void mark(const optics::GreyView& picture, const Region& region);
  void testRow(int y, std::ptrdiff_t ahead);
  /// Tests the remaining rows, outside known caps.
  void testBetween();
  void testWords(int y, std::size_t block, std::uint64_t wanted, std::ptrdiff_t ahead);
  void examineWords(std::span<const DarkPixelWord> words, int y);
  [[nodiscard]] bool examineRound(Candidate candidate);
  void examine(const Candidate& candidate);
  void add(Spot spot, const Sizes& sizes);
  void bringBack(std::vector<Spot>& spots, std::size_t first) const;
  [[nodiscard]] bool isOccupied(float x, float y, int dark) const {
    return occupied_.isOccupied(x, y, dark - levels_.black, levels_.noise);
  }

  GreyLevels levels_;
  Levels search_levels_;
  OutlineFitter outline_;
  int padding_ = 0;  // [px] added on every side of a picture
  int width_ = 0;    // [px] with padding on both sides
  int height_ = 0;
  int step_ = 3;       // [rows] between tested ones, in sufficient light
  int first_row_ = 0;  // of the regions, padded
  int last_row_ = -1;
  int near_ = 0;   // [px] largest horizontal reach of findDarkPixels()
  int reach_ = 0;  // [px] around a candidate in which pixels are read
  std::vector<int> word_starts_;
  std::vector<std::uint64_t> edge_words_;  // bits: words whose neighbours lie outside the picture
  std::vector<Neighbours> neighbours_;     // by band, by word
  std::vector<Sizes> sizes_;               // by band, by word
  ContrastPrefilter prefilter_;
  PaddedPicture padded_;
  Plane inner_;  // the picture itself
  Plane edges_;  // copy of its edges, padded
  std::vector<Spot>* spots_ = nullptr;
  std::vector<RejectedSpot>* rejected_spots_ = nullptr;
  OccupancyMap occupied_;
  std::vector<DarkPixelWord> dark_;   // of the current row
  std::vector<Candidate> rest_;       // to be examined by findRest()
  std::vector<std::uint64_t> marks_;  // by row, bits: words to be tested
};

}  // namespace lab::detector
