#pragma once

#include <cstdint>
#include <vector>

#include "analyzer/curves/block_sums.hpp"

namespace lab::analysis {

/// The blocks of one robot and program in little memory. One block is open and takes windows. The
/// others are closed, cover nearly equal free times, and take 16 bytes per lag. There are at most
/// 28; when full, pairs are merged to 14.
///
/// Per lag, a closed block keeps its two means with 24 bits, and the numbers of windows and the
/// kurtoses with 8 bits: the means determine the scatter of blocks, the others are only weights.
/// The sums over all blocks are kept in addition, in full precision.
class BlockStore {
 public:
  static constexpr std::size_t kMaxBlocks = 28;  ///< Even.

  /// The number of lags, and the length of the first block (s).
  BlockStore(std::size_t lags, double block_length);

  /// The block to which windows and steps are added.
  [[nodiscard]] BlockSums& open() { return open_; }

  /// Adds free time (s) to the open block, and closes it if it is long enough.
  void addTime(double dt);

  /// Whether addTime(dt) would close the open block.
  [[nodiscard]] bool closesAfter(double dt) const { return time_ + dt >= open_end_; }

  [[nodiscard]] double time() const { return time_; }  ///< Of all blocks, s.

  /// All blocks in time order, the open one last. Their sum is exact: per lag, the rounding errors
  /// are added to the block with the most windows.
  [[nodiscard]] std::vector<BlockSums> blocks() const;

  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  /// One lag of a closed block.
  struct Packed {
    float r2 = 0;  ///< Means.
    float a2 = 0;
    std::uint16_t windows = 0;  ///< These four are upper halves of floats.
    std::uint16_t angular_windows = 0;
    std::uint16_t r_kurtosis = 0;
    std::uint16_t a_kurtosis = 0;
  };

  static Packed pack(const LagSums& sums);
  static LagSums unpack(const Packed& packed);
  void close();
  void mergePairs();
  void makeExact(std::vector<BlockSums>& blocks, std::size_t lag) const;

  double block_length_;
  double open_end_;  ///< Free time at which the open block closes, s.
  double time_ = 0;  ///< Of all blocks.
  BlockSums open_;
  std::vector<LagSums> closed_total_;  ///< Of all closed blocks.
  std::vector<BlockSums> closed_;      ///< Without their lags.
  std::vector<Packed> packed_;         ///< Their lags, block by block.
};

}  // namespace lab::analysis
