#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "analyzer/curves/block_sums.hpp"

namespace lab::analysis {

/// Effective number of groups below which the scatter between groups is not a reliable error. The
/// standard error is then at least the prediction of the program's law, if the law predicts one,
/// and the note of the estimate says so.
inline constexpr std::size_t kMinReliableGroups = 8;

/// Adjacent blocks of one robot.
struct BlockGroup {
  const BlockTrack* track = nullptr;
  std::size_t begin = 0;  ///< Indices [begin, end) of its blocks.
  std::size_t end = 0;
  double time = 0;  ///< s
};

/// Merges adjacent blocks of each robot until every group lasts min_length [s]. The lengths of
/// blocks differ by a few frames, so a group may be 5 % shorter. What remains at the end of a robot
/// joins the group before it; a robot with less than min_length is one group.
/// @param data must outlive the groups
[[nodiscard]] std::vector<BlockGroup> groupBlocks(const BlockData& data, double min_length);

/// The sum of all groups. It differs from the total of the data if an open block, in which no time
/// has passed yet, is in no group.
/// @param total data.total()
[[nodiscard]] BlockSums totalOf(const std::vector<BlockGroup>& groups, const BlockData& data,
                                BlockSums total);

/// Sums of everything but one group, for one group after another.
class GroupOmitter {
 public:
  /// @param lags indices of the lags that are needed; the others are not kept up to date
  GroupOmitter(const BlockSums& total, std::vector<std::size_t> lags);

  /// Valid until the next call.
  const BlockSums& without(const BlockGroup& group);

 private:
  const BlockSums& total_;
  std::vector<std::size_t> lags_;
  BlockSums rest_;
};

/// The degrees of freedom of a jackknife error: the effective number of groups, less 1.
/// @param shares of the groups in the observed time
[[nodiscard]] double degreesOfFreedom(const std::vector<double>& shares);

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

  [[nodiscard]] double degreesOfFreedom() const { return analysis::degreesOfFreedom(shares); }
};

/// Evaluates `functions` on the total and on the total without each group.
/// @param total totalOf(groups)
/// @param lags indices of the lags that `functions` needs
[[nodiscard]] Replicates jackknife(
    const std::vector<BlockGroup>& groups, const BlockSums& total,
    const std::vector<std::size_t>& lags,
    const std::function<std::vector<double>(const BlockSums&)>& functions);

}  // namespace lab::analysis
