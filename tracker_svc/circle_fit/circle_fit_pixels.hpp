/// Which pixels belong to a circle, and what a first look at them says: worked out once for all
/// circles of about the same outline and blur. Internal to the circle fit.
///
/// Fits begin at points of a grid (circle_fit_grid.hpp), where the pixels always lie the same. So
/// their places are a list, and a step of least squares from a fixed disc is a weighted sum.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "light/optics/grey_image.hpp"
#include "tracker_svc/circle_fit/circle_fit_grid.hpp"
#include "tracker_svc/circle_fit/circle_fit_window.hpp"

namespace lab::detector::fit {

class PixelLayout {
 public:
  /// About this outline, blur and margin [px]; kept for the next circle of that kind. To be copied
  /// before the next call.
  /// @param sparse without pixels that tell little of the centre, if the circle is large enough
  static const std::shared_ptr<const PixelLayout>& about(const DiscShape& shape, float sigma,
                                                         float margin, bool sparse);

  struct Rough {
    double x = 0;  ///< [DN px] contrast times the way to the centre
    double y = 0;
    double white = 0;  ///< [DN]
    double dark = 0;   ///< [DN]
  };
  /// A step from a disc at the point. Beyond the picture its outermost pixels go on.
  [[nodiscard]] Rough rough(const optics::GreyView& picture, const GridPoint& point) const;

  /// Takes the pixels within the margin outside the outline centred on the point.
  /// @return false where the outline would leave the picture
  bool gather(const optics::GreyView& picture, const GridPoint& point, Window& window) const;

  /// The mean of what gather() leaves out inside [DN]; empty where that is nothing, or not all in
  /// the picture.
  [[nodiscard]] std::optional<float> middle(const optics::GreyView& picture,
                                            const GridPoint& point) const;

 private:
  struct Kind {  // the outline, as a class of outlines: see about()
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
  struct Run {  // so many pixels of a row
    int dx, dy;
  };
  struct Eight {  // pixels of one row, and where they go; the next ones write over what is too much
    int dx, dy, to;
  };
  /// The first look. Whole numbers: sums of them take less time, and are the same everywhere.
  struct RoughSums {
    std::vector<Run> runs;
    std::vector<std::int16_t> weights[4];  // of their pixels in x, y, white and dark
    std::array<double, 4> unit{};          // of these weights
  };
  struct Phase {  // a grid point lies on a pixel, or between two, by x and by y
    RoughSums rough;
    std::vector<Span> spans;
    std::vector<Eight> eights;                     // of the spans, in order
    std::vector<Span> middle;                      // what is left out of it
    std::vector<float> x, y;                       // [px] of the pixels, a multiple of kLanes
    int count = 0;                                 // without those that fill the last eight
    int left = 0, right = 0, top = 0, bottom = 0;  // what is read, and nothing farther
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
  static void take(const optics::GreyView& picture, const Phase& phase, int x, int y,
                   Window& window);
  [[nodiscard]] const Phase& phaseAt(const GridPoint& point) const {
    return phases_[static_cast<std::size_t>((point.x & 1) + 2 * (point.y & 1))];
  }

  Kind kind_;
  Ellipse ellipse_;
  std::array<Phase, 4> phases_;
};

}  // namespace lab::detector::fit
