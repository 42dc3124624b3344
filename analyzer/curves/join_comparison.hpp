#pragma once

#include <cstdint>
#include <vector>

#include "analyzer/curves/msd_accumulator.hpp"

namespace lab::analysis {

/// One lag, SI units; nan if there are too few windows or blocks.
struct JoinLag {
  double tau = 0;         ///< s
  double share = 0;       ///< Share of the windows that lie across a join.
  double whole = 0;       ///< Mean of all windows.
  double within = 0;      ///< Mean of the windows within one piece.
  double difference = 0;  ///< whole - within.
  double sigma = 0;       ///< Standard error of the difference: jackknife over paired blocks.
  double selection = 0;   ///< Largest difference that the selection of windows by walls can cause.
  double z = 0;           ///< (difference beyond selection) / sigma.
  bool compared = false;  ///< Counts for the verdict.
};

/// Whether joining pieces across removed reversals changes the curves.
///
/// Windows within pieces met no wall, so the two kinds differ even if every join is perfect: in a
/// window across a join, a robot drives straight, fast and toward the wall. With p their share of
/// the windows, whole - within = p (across - within). In walled recordings of all four programs,
/// the MSD and the angular MSD of windows across a join are between 0 and kSelection times those of
/// the others, at lags up to a quarter of the mean piece. Such a difference is not counted as a
/// defect. A defective join adds the square of its displacement error, which at short lags is many
/// times the MSD.
struct JoinComparison {
  std::int64_t joins = 0;
  double mean_piece = 0;   ///< Free time per piece, s.
  double longest_lag = 0;  ///< Longest lag that is compared: a quarter of the mean piece, s.
  std::vector<JoinLag> msd;
  std::vector<JoinLag> angular_msd;
  int compared = 0;      ///< Number of compared lags, of both curves.
  double max_z = 0;      ///< The z with the largest absolute value; nan: none.
  double max_z_tau = 0;  ///< s
  bool max_z_angular = false;
};

inline constexpr double kSelection = 2.5;  ///< Measured; see docs/stitching.md.

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

/// Collects the blocks of one robot and program with two accumulators. For the second one, every
/// piece is a segment.
class JoinAccumulator {
 public:
  /// The nominal frame period and the longest lag, s.
  JoinAccumulator(double frame_period, double max_lag);

  void add(const Sample& sample);

  /// Includes the block that is not full yet.
  [[nodiscard]] JoinBlocks blocks() const;

 private:
  void collect(JoinBlocks& blocks) const;

  JoinBlocks blocks_;
  double block_length_ = 0;
  MsdAccumulator whole_;
  MsdAccumulator within_;
};

/// Compares nothing if there are no joins or fewer than eight blocks.
[[nodiscard]] JoinComparison compareJoins(const JoinBlocks& blocks);

}  // namespace lab::analysis
