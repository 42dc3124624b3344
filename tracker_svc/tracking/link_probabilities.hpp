/// How probable each link between tracks and detections is.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace lab::tracker {

/// A possible link. Its weight is the likelihood of the detection as that of the track, over the
/// likelihood that the track was missed and that the detection is something new.
struct Link {
  std::size_t track = 0;
  std::size_t detection = 0;
  double weight = 0;
};

/// The probability of every link, if each track has at most one detection and each detection at
/// most one track, and an assignment is as probable as the product of its weights.
///
/// Links that depend on each other are summed over exactly, in groups of at most kMost tracks or
/// detections. Larger groups are divided at their weakest links, which then have the probability
/// 0. (Belief propagation, which needs no groups, is far too sure where two tracks may be swapped.)
class LinkProbabilities {
 public:
  static constexpr std::size_t kMost = 11;

  /// @return one probability for each link; valid until the next call
  [[nodiscard]] const std::vector<double>& of(std::span<const Link> links);

  /// Indices of the links of each group, as found by the last call of of().
  [[nodiscard]] const std::vector<std::vector<std::size_t>>& groups() const { return groups_; }

 private:
  void group(std::span<const Link> links);
  void solveExactly(std::span<const Link> links, const std::vector<std::size_t>& group);

  std::vector<double> probabilities_;
  std::vector<std::vector<std::size_t>> groups_;
};

}  // namespace lab::tracker
