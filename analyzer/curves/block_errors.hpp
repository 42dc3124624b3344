#pragma once

#include <functional>
#include <vector>

#include "analyzer/curves/msd_accumulator.hpp"

namespace lab::analysis {

/// Effective number of groups below which the scatter between groups is not a reliable error. The
/// standard error is then at least the prediction of the program's law, if the law predicts one,
/// and the note of the estimate says so.
inline constexpr std::size_t kMinReliableGroups = 8;

/// Merges adjacent blocks of each robot until every group lasts min_length [s]. The lengths of
/// blocks differ by a few frames, so a group may be 5 % shorter. What remains at the end of a robot
/// joins the group before it; a robot with less than min_length is one group.
[[nodiscard]] std::vector<BlockSums> groupBlocks(const BlockData& data, double min_length);

/// Values of several functions of the sums: for all groups (values[q]) and with one group omitted
/// (without[group][q]).
struct Replicates {
  std::vector<double> values;
  std::vector<std::vector<double>> without;
  std::vector<double> shares;  ///< Share of each group in the observed time.

  /// The jackknife standard error of the function with index q for groups of unequal size (Busing,
  /// Meijer and van der Leeden 1999); nan below 2 groups.
  [[nodiscard]] double sigma(std::size_t q) const { return sigmaOf(values[q], column(q)); }

  /// The same for a function that is given by its value for all groups and its values with one
  /// group omitted.
  [[nodiscard]] double sigmaOf(double value, const std::vector<double>& without_each) const;

  /// The values of the function with index q, with one group omitted.
  [[nodiscard]] std::vector<double> column(std::size_t q) const;

  /// The degrees of freedom of sigma: the effective number of groups, less 1.
  [[nodiscard]] double degreesOfFreedom() const;
};

/// Evaluates `functions` on the total and on the total without each group.
[[nodiscard]] Replicates jackknife(
    const std::vector<BlockSums>& groups,
    const std::function<std::vector<double>(const BlockSums&)>& functions);

}  // namespace lab::analysis
