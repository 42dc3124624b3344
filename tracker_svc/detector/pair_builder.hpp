/// Pairs the circles of one picture into caps.
#pragma once

#include <cstddef>
#include <vector>

#include "tracker_svc/circle_search/circle_search.hpp"
#include "tracker_svc/detection.hpp"
#include "tracker_svc/detector/cap_pose.hpp"
#include "tracker_svc/detector/fitted_circles.hpp"
#include "tracker_svc/detector/known_caps.hpp"

namespace lab::detector {

/// Adds the caps it finds to `known`. All `rejected` may be null.
class PairBuilder {
 public:
  PairBuilder(const DetectorSetup& setup, CircleSearch& search, FittedCircles& circles,
              KnownCaps& known)
      : setup_(setup), search_(search), circles_(circles), known_(known) {}

  /// Collects pairs of free spots at about the right distance; one spot of each pair has index
  /// `first` or higher.
  void gather(std::size_t first, std::vector<Rejection>* rejected);
  /// Collects pairs among the remaining spots, centred again as circles of the right sizes.
  void lookAgain(std::vector<Rejection>* rejected);
  /// Fits the collected pairs and adds the best of them to the known caps.
  void settlePairs(std::vector<Rejection>* rejected);
  /// settlePairs() for this pair only.
  void settleOne(const CirclePair& pair, std::vector<Rejection>* rejected);

  /// Fits both circles, then checks their spacing and the rim around them.
  /// @return whether it is a cap; sets cost and rim
  [[nodiscard]] bool measure(CirclePair& pair, std::vector<Rejection>* rejected);
  /// The pose of a measured pair.
  [[nodiscard]] Detection poseOf(const CirclePair& pair) const;

 private:
  /// Approximate image of the axis.
  [[nodiscard]] optics::Pixel middleOf(const Spot& big, const Spot& small) const;
  /// Adds the pair if its spots are about as far apart as the circles of a cap.
  /// @return whether they are
  bool addCirclePair(std::size_t big, std::size_t small);
  /// Whether a coarse look shows the rim of a cap around the pair; sets its contrast.
  [[nodiscard]] bool hasRim(CirclePair& pair, std::vector<Rejection>* rejected) const;
  void settle(std::vector<CirclePair>& pairs, std::vector<Rejection>* rejected);
  /// The centre of a circle, its covariance widened by possible glare.
  [[nodiscard]] MeasuredPoint measuredPointOf(const FittedCircles::Circle& circle,
                                              const FittedCircles::Circle& other) const;

  const DetectorSetup& setup_;
  CircleSearch& search_;
  FittedCircles& circles_;
  KnownCaps& known_;
  std::vector<CirclePair> pairs_;
  std::vector<CirclePair> doubtful_;  // settled after the others
  std::vector<int> partners_;         // by spot: number of pairs it is in
  std::vector<float> clearest_;       // by spot: highest rim contrast of its pairs
  std::vector<std::size_t> order_;    // free spots, by row
};

}  // namespace lab::detector
