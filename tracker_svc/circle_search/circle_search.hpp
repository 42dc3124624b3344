/// Where in a picture black circles of the right sizes on something white may be: one pass at the
/// speed of memory, no threshold for the picture as a whole.
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

/// Every few rows, some two to the small circle, each pixel is held against its neighbours at a bit
/// more than the big radius, in four directions through it: less than half as bright as both in at
/// least one direction makes a candidate. A light edge beside or across a circle leaves at least
/// one direction that lies along it. Candidates are then centred on the outline around them.
class CircleSearch {
 public:
  /// @param width,height of the pictures [px]
  CircleSearch(const ScaleMap& scale, const optics::CapGeometry& cap,
               const optics::Imaging& imaging, int width, int height);

  /// The circles whose candidates lie in one of the regions, in the order of their top rows. A
  /// circle is found in the same place whatever the regions, if one of them holds all of it.
  void find(const optics::GreyView& picture, std::span<const Region> regions,
            std::vector<Spot>& spots, std::vector<RejectedSpot>* refused);

  /// find() in two halves. The first gives what is a whole circle at first sight and keeps what
  /// else is dark; the second looks at that closely, but not where cover() said that a cap is
  /// known: most of it is the rims and sides of caps.
  void findRound(const optics::GreyView& picture, std::span<const Region> regions,
                 std::vector<Spot>& spots, std::vector<RejectedSpot>* refused);
  /// @param rows all where light edges may leave of a circle what a row just misses
  void findRest(Rows rows, std::vector<Spot>& spots, std::vector<RejectedSpot>* refused);

  /// Nothing is left to be found here.
  /// @param radius [px]
  void cover(double x, double y, double radius);

  /// What the next circleAt() look at.
  void aimAt(const optics::GreyView& picture);

  /// The circle around a place, if it shows all of its outline, may be of that size, and neither
  /// lies in the dark nor at the edge of the picture: what find() would take for such a circle.
  [[nodiscard]] std::optional<Spot> circleAt(optics::Pixel place, bool big) const;

  /// The circle of the given size that a spot is part of, in the picture that find() was given last
  /// and that is still there; empty where the outline is not there.
  [[nodiscard]] std::optional<Spot> centredAs(const Spot& spot, bool big);

 private:
  static constexpr int kBand = 32;  // rows that share one set of sizes

  void addSizes(const ScaleMap& scale, const optics::CapGeometry& cap);
  /// @param around [px] how far from there something is read
  [[nodiscard]] bool isInner(int x, int y, int around) const;
  [[nodiscard]] const Plane& planeAt(int x, int y, int around);
  void mark(const optics::GreyView& picture, const Region& region);
  void testRow(int y, std::ptrdiff_t ahead);
  /// The rows between those that were tested, where no cap is known.
  void testBetween();
  void testWords(int y, std::size_t block, std::uint64_t wanted, std::ptrdiff_t ahead);
  void takeWords(std::span<const DarkPixelWord> words, int y);
  [[nodiscard]] bool takeRound(Candidate candidate);
  void take(const Candidate& candidate);
  void add(Spot spot, const Sizes& sizes);
  void bringBack(std::vector<Spot>& spots, std::size_t first) const;
  [[nodiscard]] bool isOccupied(float x, float y, int dark) const {
    return occupied_.isOccupied(x, y, dark - levels_.black, levels_.noise);
  }

  GreyLevels levels_;
  Levels search_levels_;
  OutlineFitter outline_;
  int padding_ = 0;  // [px] added on every side of a picture
  int width_ = 0;    // [px] with padding
  int height_ = 0;
  int step_ = 3;       // [rows] between tested ones, where there is light
  int first_row_ = 0;  // of the regions
  int last_row_ = -1;
  int near_ = 0;   // [px] that findDarkPixels() looks to the sides, at most
  int reach_ = 0;  // [px] around a candidate in which pixels are looked at
  std::vector<int> word_starts_;
  std::vector<std::uint64_t> edge_words_;  // bits: words that reach beyond the picture
  std::vector<Neighbours> neighbours_;     // by band, by word
  std::vector<Sizes> sizes_;               // by band, by word
  ContrastPrefilter prefilter_;
  PaddedPicture padded_;
  Plane inner_;  // of the picture as it is
  Plane edges_;  // of its edges, padded
  std::vector<Spot>* spots_ = nullptr;
  std::vector<RejectedSpot>* rejected_spots_ = nullptr;
  OccupancyMap occupied_;
  std::vector<DarkPixelWord> dark_;   // of the row that is tested
  std::vector<Candidate> rest_;       // to be looked at closely
  std::vector<std::uint64_t> marks_;  // by row, bits: words to be tested
};

}  // namespace lab::detector
