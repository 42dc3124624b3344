/// The spots of one picture and the circles fitted to them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tracker_svc/circle_fit.hpp"
#include "tracker_svc/circle_search/circle_search.hpp"
#include "tracker_svc/detector/detector_setup.hpp"
#include "tracker_svc/detector/pairing.hpp"

namespace lab::detector {

/// A spot may be a big or a small circle. Each of the two is fitted when first needed, and kept.
/// Which spots are fitted, and in which order, decides the last bits of the results.
class FittedCircles {
 public:
  struct Circle {
    bool fitted = false;
    CircleFit fit;
    optics::Place place;                 ///< [m] of its centre on the cap plane
    std::array<double, 3> covariance{};  ///< [m^2] xx, xy, yy
  };

  explicit FittedCircles(const DetectorSetup& setup) : setup_(setup) {}

  /// Removes all spots. Later fits use this picture.
  void begin(const optics::GreyView& picture);
  [[nodiscard]] const optics::GreyView& picture() const { return picture_; }

  [[nodiscard]] const std::vector<Spot>& spots() const { return spots_; }
  [[nodiscard]] std::size_t size() const { return spots_.size(); }
  /// For CircleSearch to append to; call admit() afterwards.
  [[nodiscard]] std::vector<Spot>& newSpots() { return spots_; }
  /// Makes appended spots known: not fitted, not assigned to a cap.
  void admit();
  /// @return its index
  int add(const Spot& spot);
  void removeLast();

  /// Whether the spot belongs to a cap.
  [[nodiscard]] bool isAssigned(std::size_t spot) const { return assigned_[spot] != 0; }
  void assign(int spot) { assigned_[static_cast<std::size_t>(spot)] = 1; }
  void release(int spot) { assigned_[static_cast<std::size_t>(spot)] = 0; }

  /// The circle as it is now, perhaps not fitted.
  [[nodiscard]] const Circle& of(int spot, bool big) const { return circles_[index(spot, big)]; }
  void restore(int spot, bool big, const Circle& circle) { circles_[index(spot, big)] = circle; }

  /// The circle, fitted from the spot's place if it was not fitted yet. References stay valid until
  /// spots are added.
  const Circle& fit(int spot, bool big);
  /// Fits again from another start.
  /// @param glare accept glare, which is a fault otherwise
  const Circle& fitFrom(optics::Pixel start, int spot, bool big, bool glare = false);
  /// Fits both circles of a pair. If one fit fails, it is repeated from where the other circle
  /// predicts it. @return whether both fits succeeded
  [[nodiscard]] bool fitBoth(const CirclePair& pair);

 private:
  static std::size_t index(int spot, bool big) {
    return 2 * static_cast<std::size_t>(spot) + (big ? 0 : 1);
  }
  [[nodiscard]] Circle& at(int spot, bool big) { return circles_[index(spot, big)]; }

  const DetectorSetup& setup_;
  optics::GreyView picture_;
  std::vector<Spot> spots_;
  std::vector<Circle> circles_;  // two per spot: as a big one, as a small one
  std::vector<char> assigned_;   // by spot
};

}  // namespace lab::detector
