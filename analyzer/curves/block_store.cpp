#include "analyzer/curves/block_store.hpp"

#include <algorithm>
#include <bit>
#include <utility>

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
    : block_length_(block_length), open_end_(block_length), closed_total_(lags) {
  open_.lags.resize(lags);
}

void BlockStore::addTime(double dt) {
  const bool closes = wouldClose(dt);
  open_.time += dt;
  time_ += dt;
  if (!closes) return;
  close();
  if (closed_.size() == kMaxBlocks) {
    mergePairs();
  }
  // Blocks end at multiples of the length, so the excess of one block does not shift the later
  // ones.
  open_end_ = static_cast<double>(closed_.size() + 1) * block_length_;
}

void BlockStore::close() {
  unpacked_.reset();
  std::vector<LagSums> lags = std::exchange(open_.lags, {});
  closed_.push_back(open_);
  open_ = BlockSums{};
  packed_.reserve(packed_.size() + lags.size());
  for (std::size_t i = 0; i < lags.size(); ++i) {
    closed_total_[i] += lags[i];
    packed_.push_back(pack(lags[i]));
    lags[i] = LagSums{};
  }
  open_.lags = std::move(lags);
}

void BlockStore::mergePairs() {
  const std::size_t n = open_.lags.size();
  for (std::size_t b = 0; b < kMaxBlocks / 2; ++b) {
    closed_[2 * b] += closed_[2 * b + 1];
    closed_[b] = closed_[2 * b];
    for (std::size_t i = 0; i < n; ++i) {
      LagSums sum = unpack(packed_[2 * b * n + i]);
      sum += unpack(packed_[(2 * b + 1) * n + i]);
      packed_[b * n + i] = pack(sum);
    }
  }
  closed_.resize(kMaxBlocks / 2);
  packed_.resize(kMaxBlocks / 2 * n);
  block_length_ *= 2;
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
  if (!unpacked_) unpacked_ = std::make_shared<const ClosedBlocks>(unpackAll());
  return unpacked_;
}

ClosedBlocks BlockStore::unpackAll() const {
  const std::size_t n = open_.lags.size();
  ClosedBlocks closed;
  closed.blocks = closed_;
  for (std::size_t b = 0; b < closed_.size(); ++b) {
    closed.total += closed_[b];
    closed.blocks[b].lags.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      closed.blocks[b].lags[i] = unpack(packed_[b * n + i]);
    }
  }
  for (std::size_t i = 0; !closed_.empty() && i < n; ++i) {
    makeExact(closed.blocks, i);
  }
  closed.total.lags = closed_total_;
  return closed;
}

void BlockStore::makeExact(std::vector<BlockSums>& blocks, std::size_t i) const {
  LagSums missing = closed_total_[i];
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
  return sizeof(*this) + (open_.lags.capacity() + closed_total_.capacity()) * sizeof(LagSums) +
         closed_.capacity() * sizeof(BlockSums) + packed_.capacity() * sizeof(Packed) +
         (unpacked_
              ? unpacked_->blocks.size() * (sizeof(BlockSums) + open_.lags.size() * sizeof(LagSums))
              : 0);
}

}  // namespace lab::analysis
