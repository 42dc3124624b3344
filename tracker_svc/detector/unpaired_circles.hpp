/// Finds the partners of circles that the search found alone.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "tracker_svc/detection.hpp"
#include "tracker_svc/detector/fitted_circles.hpp"
#include "tracker_svc/detector/known_caps.hpp"
#include "tracker_svc/detector/pair_builder.hpp"

namespace lab::detector {

/// The search misses a circle that a light edge crosses or that noise hides. Its place is derived
/// from the other circle and the rim of the cap. Adds the caps it finds to `known`.
class UnpairedCircles {
 public:
  UnpairedCircles(const DetectorSetup& setup, FittedCircles& circles, const KnownCaps& known,
                  PairBuilder& pairs)
      : setup_(setup), circles_(circles), known_(known), pairs_(pairs) {}

  /// Examines at most some hundred free spots.
  /// @param rejected may be null
  void search(std::vector<Rejection>* rejected);

 private:
  struct Partner {
    double theta = 0;  // [rad] heading of the cap
    float score = 0;   // [1] rim contrast times darkness
  };

  /// Fits the circle of a single spot and tries its possible partners.
  /// @param aside if set, where the circle may be instead
  /// @return number of fits that led to no cap
  int tryUnpaired(int spot, bool big, const std::optional<optics::Place>& aside,
                  std::vector<Rejection>* rejected);
  /// Headings at which the place of the other circle is dark and a rim surrounds both.
  /// @param step tests every step-th heading
  /// @return best first
  [[nodiscard]] std::vector<Partner> partnersOf(optics::Place circle, bool big,
                                                std::size_t step) const;
  /// Whether a circle here would be as dark inside as paint.
  [[nodiscard]] bool isBlack(optics::Pixel at, bool big) const;
  /// The place near an approximate one that has the best partner.
  [[nodiscard]] std::optional<optics::Place> placeAside(optics::Place rough, bool big) const;
  /// @return number of fits that led to no cap
  int pairBeside(int spot, bool big, double theta, std::vector<Rejection>* rejected);
  [[nodiscard]] float leastRim(const CirclePair& pair) const;

  const DetectorSetup& setup_;
  FittedCircles& circles_;
  const KnownCaps& known_;
  PairBuilder& pairs_;
};

}  // namespace lab::detector
