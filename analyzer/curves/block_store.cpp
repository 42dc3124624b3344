#include "analyzer/curves/block_store.hpp"

#include <algorithm>
#include <bit>

namespace lab::analysis {
namespace {

/// A positive number as bfloat16, rounded: 8 significant bits.
std::uint16_t toBfloat16(double value) {
  constexpr std::uint32_t kHalf = 0x8000;
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
  return static_cast<std::uint16_t>((bits + kHalf) >> 16U);
}

double fromBfloat16(std::uint16_t half) {
  return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(half) << 16U));
}

double kurtosis(double fourth, double second, double n) {
  return second != 0 ? fourth * n / (second * second) : 0;
}

}  // namespace

BlockStore::BlockStore(std::size_t lags, double block_length)
    : block_length_(block_length), open_end_(block_length), closed_(std::make_shared<Closed>()) {
  closed_->total.resize(lags);
  open_.lags.resize(lags);
}

void BlockStore::addTime(double dt) {
  const bool closes = wouldClose(dt);
  open_.time += dt;
  time_ += dt;
  if (!closes) return;
  close();
  if (closed_->each.size() == kMaxBlocks) {
    mergePairs(*closed_);
    block_length_ *= 2;
  }
  // Blocks end at multiples of the length, so the excess of one block does not shift the later
  // ones.
  open_end_ = static_cast<double>(closed_->each.size() + 1) * block_length_;
}

void BlockStore::close() {
  if (closed_.use_count() > 1) closed_ = std::make_shared<Closed>(*closed_);
  closed_->unpacked.reset();
  closed_->each.push_back(open_);
  static_cast<BlockCounts&>(open_) = BlockCounts{};
  closed_->packed.reserve(closed_->packed.size() + open_.lags.size());
  for (std::size_t i = 0; i < open_.lags.size(); ++i) {
    closed_->total[i] += open_.lags[i];
    closed_->packed.push_back(pack(open_.lags[i]));
    open_.lags[i] = LagSums{};
  }
}

void BlockStore::mergePairs(Closed& closed) {
  const std::size_t n = closed.total.size();
  for (std::size_t b = 0; b < kMaxBlocks / 2; ++b) {
    closed.each[2 * b] += closed.each[2 * b + 1];
    closed.each[b] = closed.each[2 * b];
    for (std::size_t i = 0; i < n; ++i) {
      LagSums sum = unpack(closed.packed[2 * b * n + i]);
      sum += unpack(closed.packed[(2 * b + 1) * n + i]);
      closed.packed[b * n + i] = pack(sum);
    }
  }
  closed.each.resize(kMaxBlocks / 2);
  closed.packed.resize(kMaxBlocks / 2 * n);
}

BlockStore::Packed BlockStore::pack(const LagSums& sums) {
  Packed packed;
  const double n = sums.windows;
  const double m = sums.angular_windows;
  packed.windows = toBfloat16(n);
  packed.angular_windows = toBfloat16(m);
  packed.r2 = n > 0 ? static_cast<float>(sums.r2 / n) : 0.0F;
  packed.a2 = m > 0 ? static_cast<float>(sums.a2 / m) : 0.0F;
  packed.r_kurtosis = toBfloat16(kurtosis(sums.r4, sums.r2, n));
  packed.a_kurtosis = toBfloat16(kurtosis(sums.a4, sums.a2, m));
  return packed;
}

LagSums BlockStore::unpack(const Packed& packed) {
  const double n = fromBfloat16(packed.windows);
  const double m = fromBfloat16(packed.angular_windows);
  const auto r2 = static_cast<double>(packed.r2);
  const auto a2 = static_cast<double>(packed.a2);
  LagSums sums;
  sums.windows = static_cast<std::uint32_t>(n);
  sums.angular_windows = static_cast<std::uint32_t>(m);
  sums.r2 = n * r2;
  sums.a2 = m * a2;
  sums.r4 = n * r2 * r2 * fromBfloat16(packed.r_kurtosis);
  sums.a4 = m * a2 * a2 * fromBfloat16(packed.a_kurtosis);
  return sums;
}

std::shared_ptr<const ClosedBlocks> BlockStore::closed() const {
  if (!closed_->unpacked) {
    closed_->unpacked = std::make_shared<const ClosedBlocks>(unpackAll(*closed_));
  }
  return closed_->unpacked;
}

ClosedBlocks BlockStore::unpackAll(const Closed& closed) {
  const std::size_t n = closed.total.size();
  ClosedBlocks unpacked;
  unpacked.blocks.resize(closed.each.size());
  for (std::size_t b = 0; b < closed.each.size(); ++b) {
    BlockSums& block = unpacked.blocks[b];
    static_cast<BlockCounts&>(block) = closed.each[b];
    static_cast<BlockCounts&>(unpacked.total) += closed.each[b];
    block.lags.reserve(n);
    for (std::size_t i = 0; i < n; ++i) block.lags.push_back(unpack(closed.packed[b * n + i]));
  }
  for (std::size_t i = 0; !closed.each.empty() && i < n; ++i) {
    makeExact(closed, unpacked.blocks, i);
  }
  unpacked.total.lags = closed.total;
  return unpacked;
}

void BlockStore::makeExact(const Closed& closed, std::vector<BlockSums>& blocks, std::size_t i) {
  LagSums missing = closed.total[i];
  LagSums* most = &blocks.front().lags[i];
  LagSums* most_angular = most;
  for (BlockSums& block : blocks) {
    LagSums& sums = block.lags[i];
    missing -= sums;  // unsigned numbers may wrap around here, and wrap back below
    most = sums.windows > most->windows ? &sums : most;
    most_angular = sums.angular_windows > most_angular->angular_windows ? &sums : most_angular;
  }
  most->windows += missing.windows;
  most->r2 += missing.r2;
  most->r4 += missing.r4;
  most_angular->angular_windows += missing.angular_windows;
  most_angular->a2 += missing.a2;
  most_angular->a4 += missing.a4;
}

std::size_t BlockStore::memoryBytes() const {
  std::size_t bytes = sizeof(*this) + sizeof(Closed) +
                      (open_.lags.capacity() + closed_->total.capacity()) * sizeof(LagSums) +
                      closed_->each.capacity() * sizeof(BlockCounts) +
                      closed_->packed.capacity() * sizeof(Packed);
  if (closed_->unpacked) {
    bytes += closed_->unpacked->blocks.size() *
             (sizeof(BlockSums) + open_.lags.size() * sizeof(LagSums));
  }
  return bytes;
}

}  // namespace lab::analysis
