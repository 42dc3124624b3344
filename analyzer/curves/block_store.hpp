#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "analyzer/curves/block_sums.hpp"

namespace lab::analysis {

/// Stores the block sums of one robot and one program in bounded memory. The scatter between blocks
/// gives the error bars (block_sums.hpp).
///
/// The newest block is open: windows are added to it. All other blocks are closed, have nearly the
/// same length in free time, and take 16 bytes per lag. When kMaxBlocks blocks are closed,
/// neighbouring blocks are merged in pairs.
///
/// Per lag, a closed block keeps the means of r^2 and a^2 as floats. It keeps the numbers of
/// windows and the kurtoses with 8 significant bits, which is enough because they only weight the
/// blocks. The sums over all closed blocks are kept in addition, in full precision.
class BlockStore {
 public:
  static constexpr std::size_t kMaxBlocks = 28;  ///< Even, because pairs are merged.

  /// @param block_length free time of the first block [s]
  BlockStore(std::size_t lags, double block_length);

  /// The block to which windows and steps are added.
  [[nodiscard]] BlockSums& openBlock() { return open_; }

  /// Adds free time [s] to the open block, and closes it if it is long enough.
  void addTime(double dt);

  /// True if addTime(dt) would close the open block.
  [[nodiscard]] bool wouldClose(double dt) const { return time_ + dt >= open_end_; }

  [[nodiscard]] double time() const { return time_; }  ///< [s] free time of all blocks

  /// All blocks. Their sum is exact: per lag, the rounding errors are added to the block with the
  /// most windows.
  [[nodiscard]] BlockTrack blocks() const { return {closed(), open_}; }

  [[nodiscard]] std::size_t memoryBytes() const;

 private:
  /// One lag of a closed block.
  struct Packed {
    float r2 = 0;  ///< [m^2] mean of r^2
    float a2 = 0;  ///< [rad^2] mean of a^2
    // The other four are bfloat16: the upper 16 bits of a float.
    std::uint16_t windows = 0;
    std::uint16_t angular_windows = 0;
    std::uint16_t r_kurtosis = 0;
    std::uint16_t a_kurtosis = 0;
  };
  /// The closed blocks. Copies of the store share them: they change rarely, and a copy is made for
  /// every query.
  struct Closed {
    std::vector<LagSums> total;                    ///< Sums over all of them, per lag.
    std::vector<BlockCounts> each;                 ///< In time order.
    std::vector<Packed> packed;                    ///< Their lags, ordered by block, then by lag.
    std::shared_ptr<const ClosedBlocks> unpacked;  ///< nullptr: not asked for yet.
  };

  /// Unpacked; kept until another block closes.
  [[nodiscard]] std::shared_ptr<const ClosedBlocks> closed() const;
  static Packed pack(const LagSums& sums);
  static LagSums unpack(const Packed& packed);
  void close();
  static void mergePairs(Closed& closed);
  static ClosedBlocks unpackAll(const Closed& closed);
  static void makeExact(const Closed& closed, std::vector<BlockSums>& blocks, std::size_t lag);

  double block_length_;
  double open_end_;  ///< [s] free time at which the open block closes
  double time_ = 0;  ///< [s] free time of all blocks
  BlockSums open_;
  std::shared_ptr<Closed> closed_;
};

}  // namespace lab::analysis
