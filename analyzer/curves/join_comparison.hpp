#pragma once

#include <cstdint>
#include <vector>

#include "analyzer/curves/msd_accumulator.hpp"

namespace lab::analysis {

/// One lag, SI units; nan where too few windows or blocks are there.
struct JoinLag {
  double tau = 0;         ///< s
  double share = 0;       ///< Of the windows, those that straddle a join.
  double whole = 0;       ///< Of all windows.
  double within = 0;      ///< Of the windows that lie in one piece.
  double difference = 0;  ///< whole - within.
  double sigma = 0;       ///< Standard error of the difference: jackknife over paired blocks.
  double selection = 0;   ///< What the selection of windows by walls can make of the difference.
  double z = 0;           ///< difference / (sigma and selection together).
  bool compared = false;  ///< Counts for the verdict.
};

/// Whether joining pieces across removed reversals shows in the curves.
///
/// Windows within pieces are those that met no wall, so that both sets differ even where every join
/// is perfect: robots that drive straight, fast and toward the wall are in the windows that
/// straddle a join. With p their share of the windows, whole - within = p (straddling - within),
/// and in walled recordings of all four programs the MSD and the angular MSD of straddling windows,
/// of up to a quarter of the mean piece, are between 0 and kSelection times those of the others.
/// That much is not held against the joins; what a defect adds is the square of the misplaced
/// length, which at short lags is many times the square of what is driven in the lag.
struct JoinComparison {
  std::int64_t joins = 0;
  double mean_piece = 0;   ///< Free time per piece, s.
  double longest_lag = 0;  ///< Longer lags are not compared: a quarter of the mean piece, s.
  std::vector<JoinLag> msd;
  std::vector<JoinLag> angular_msd;
  int compared = 0;      ///< Lags, of both curves.
  double max_z = 0;      ///< Largest of them by its absolute value; nan: none.
  double max_z_tau = 0;  ///< s
  bool max_z_angular = false;
};

inline constexpr double kSelection = 2.5;  ///< docs/stitching.md says what was measured.

/// Sums of both kinds of windows, in blocks whose windows do not overlap.
struct JoinBlocks {
  struct Block {
    double time = 0;  ///< s
    double joins = 0;
    std::vector<LagSums> whole;
    std::vector<LagSums> within;
  };
  std::vector<int> lags;  ///< frames
  double frame_period = 0;
  std::vector<Block> blocks;

  void pool(const JoinBlocks& other);
};

/// Collects them for one robot and program: two accumulators fed with the same samples, for the
/// second of which every piece is a segment.
class JoinAccumulator {
 public:
  /// The nominal frame period and the longest lag, s.
  JoinAccumulator(double frame_period, double max_lag);

  void add(const Sample& sample);

  /// With the block that is not full yet.
  [[nodiscard]] JoinBlocks blocks() const;

 private:
  void collect(JoinBlocks& blocks) const;

  JoinBlocks blocks_;
  double block_length_ = 0;
  MsdAccumulator whole_;
  MsdAccumulator within_;
};

/// Nothing is compared where there are no joins or fewer than eight blocks.
[[nodiscard]] JoinComparison compareJoins(const JoinBlocks& blocks);

}  // namespace lab::analysis
