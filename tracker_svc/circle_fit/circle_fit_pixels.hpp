/// The pixels that belong to a circle, and weights for a first estimate from them; computed once
/// for all circles of about the same outline and blur. Internal to the circle fit.
///
/// Fits start at points of a grid (circle_fit_grid.hpp), relative to which the pixels have fixed
/// positions. So the positions are a list, and one least-squares step from a fixed disc is a
/// weighted sum.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "light/optics/grey_image.hpp"
#include "tracker_svc/circle_fit/circle_fit_grid.hpp"
#include "tracker_svc/circle_fit/circle_fit_window.hpp"

namespace lab::detector::fit {

class PixelLayout {
 public:
  /// The layout for about this outline, blur and margin [px], from a cache. Copy the pointer before
  /// the next call.
  /// @param sparse omit pixels that contribute little to the centre, if the circle is large enough
  static const std::shared_ptr<const PixelLayout>& about(const DiscShape& shape, float sigma,
                                                         float margin, bool sparse);

  struct Rough {
    double x = 0;  ///< [DN px] contrast times the distance to the centre
    double y = 0;
    double white = 0;  ///< [DN]
    double dark = 0;   ///< [DN]
  };
  /// One least-squares step from a disc at the point. Pixels outside the picture repeat its edge.
  [[nodiscard]] Rough rough(const optics::GreyView& picture, const GridPoint& point) const;

  /// Reads the pixels within the margin around the outline centred on the point.
  /// @return false if the outline would leave the picture
  bool gather(const optics::GreyView& picture, const GridPoint& point, Window& window) const;

  /// The mean of the pixels inside that gather() omits [DN]; empty if there are none, or not all
  /// are in the picture.
  [[nodiscard]] std::optional<float> middle(const optics::GreyView& picture,
                                            const GridPoint& point) const;

 private:
  struct Kind {  // a class of similar outlines: see about()
    int width, height, skew, blur, margin;
    bool sparse;
    bool operator==(const Kind&) const = default;
  };
  struct Ellipse {
    explicit Ellipse(const Kind& kind);
    double m[4];              // |m d| < 1 inside
    double radius;            // [px]
    double reach_x, reach_y;  // [px]
  };
  struct Span {  // pixels of one row
    int dx, dy, count;
    [[nodiscard]] int end() const { return dx + count; }
  };
  static constexpr int kRun = 16;
  struct Run {  // consecutive pixels of a row
    int dx, dy;
  };
  struct Eight {  // eight pixels of one row, and their destination; surplus ones are overwritten by
                  // the next
    int dx, dy, to;
  };
  /// The first estimate. Integers: fast to sum, and the same on every processor.
  struct RoughSums {
    std::vector<Run> runs;
    std::vector<std::int16_t> weights[4];  // weights of the pixels for x, y, white and dark
    std::array<double, 4> unit{};          // unit of these weights
  };
  struct Phase {  // whether a grid point lies on a pixel or between two, in x and in y
    RoughSums rough;
    std::vector<Span> spans;
    std::vector<Eight> eights;                     // covering the spans, in order
    std::vector<Span> middle;                      // what they omit inside
    std::vector<float> x, y;                       // [px] of the pixels, a multiple of kLanes
    int count = 0;                                 // without the padding of the last eight
    int left = 0, right = 0, top = 0, bottom = 0;  // bounds of everything that is read
    [[nodiscard]] bool within(const optics::GreyView& picture, int at_x, int at_y) const;
  };

  explicit PixelLayout(const Kind& kind);
  static Span rowWithin(const Ellipse& ellipse, double margin, int row, double shift_x,
                        double shift_y);
  static std::vector<Span> spansWithin(const Ellipse& ellipse, double margin, double shift_x,
                                       double shift_y);
  static Phase phaseOf(const Kind& kind, const Ellipse& ellipse, double shift_x, double shift_y);
  static void addRough(const Ellipse& ellipse, double sigma, double shift_x, double shift_y,
                       Phase& phase);
  static void sum(const optics::GreyView& picture, const Phase& phase, int x, int y,
                  std::int32_t* sums);
  static void copyPixels(const optics::GreyView& picture, const Phase& phase, int x, int y,
                         Window& window);
  [[nodiscard]] const Phase& phaseAt(const GridPoint& point) const {
    return phases_[static_cast<std::size_t>((point.x & 1) + 2 * (point.y & 1))];
  }

  Kind kind_;
  Ellipse ellipse_;
  std::array<Phase, 4> phases_;
};

}  // namespace lab::detector::fit
