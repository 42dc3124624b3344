/// Vectors that may be larger than the memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <queue>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/process/file_descriptor.hpp"

namespace lab {

/// Bytes in the address space: in memory as long as they are few, then in a file without a name, so
/// that the system may take their memory. The file lies in $TMPDIR, else in /var/tmp, and ends with
/// its owner.
class DiskBytes {
 public:
  /// Above this size the bytes are in a file, and this much of them stays in memory.
  static constexpr std::size_t kMostInMemory = std::size_t{64} << 20U;

  DiskBytes() = default;
  DiskBytes(DiskBytes&& other) noexcept;
  DiskBytes& operator=(DiskBytes&& other) noexcept;
  DiskBytes(const DiskBytes&) = delete;
  DiskBytes& operator=(const DiskBytes&) = delete;
  ~DiskBytes();

  [[nodiscard]] void* data() const { return data_; }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  [[nodiscard]] bool inFile() const { return file_.get() >= 0; }

  /// Makes room for at least so many bytes. Pointers to the content become invalid.
  /// @throws std::runtime_error: the folder of the file has no room or cannot be written
  void grow(std::size_t bytes);

  /// Gives back the memory of the content, which the file keeps. Without a file it does nothing.
  void releaseMemory() const;

 private:
  void moveToFile(std::size_t bytes);
  void growFile(std::size_t bytes);

  void* data_ = nullptr;
  std::size_t capacity_ = 0;
  FileDescriptor file_;
};

/// A vector of plain values that takes about 64 MB of memory, however long it is. Loops over all of
/// it use each(), or call keepNear().
template <class T>
requires std::is_trivially_copyable_v<T>
class DiskVector {
 public:
  /// Number of values that stay in memory.
  static constexpr std::size_t kBlock = DiskBytes::kMostInMemory / sizeof(T);

  DiskVector() = default;
  DiskVector(DiskVector&& other) noexcept
      : bytes_(std::move(other.bytes_)), size_(std::exchange(other.size_, 0)) {}
  DiskVector& operator=(DiskVector&& other) noexcept {
    bytes_ = std::move(other.bytes_);
    size_ = std::exchange(other.size_, 0);
    return *this;
  }
  DiskVector(const DiskVector& other) { append(other); }
  DiskVector& operator=(const DiskVector& other) {
    if (this != &other) *this = DiskVector(other);
    return *this;
  }
  ~DiskVector() = default;

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] T& operator[](std::size_t i) { return data()[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const { return data()[i]; }
  [[nodiscard]] T& front() { return data()[0]; }
  [[nodiscard]] const T& front() const { return data()[0]; }
  [[nodiscard]] T& back() { return data()[size_ - 1]; }
  [[nodiscard]] const T& back() const { return data()[size_ - 1]; }
  [[nodiscard]] std::span<T> part(std::size_t begin, std::size_t end) {
    return {data() + begin, end - begin};
  }
  [[nodiscard]] std::span<const T> part(std::size_t begin, std::size_t end) const {
    return {data() + begin, end - begin};
  }

  /// @throws std::runtime_error: no room for the file
  T& push_back(const T& value) {
    const T copy = value;  // it may be one of these, which move
    if ((size_ + 1) * sizeof(T) > bytes_.capacity()) bytes_.grow((size_ + 1) * sizeof(T));
    keepNear(size_);
    return *std::construct_at(data() + size_++, copy);
  }

  /// Drops the values from this one on.
  void shrink(std::size_t size) { size_ = std::min(size, size_); }

  void releaseMemory() const { bytes_.releaseMemory(); }

  /// Gives back the memory of values far from this one, for loops in any order.
  void keepNear(std::size_t i) const {
    if ((i > near_ ? i - near_ : near_ - i) < kBlock) return;
    releaseMemory();
    near_ = i;
  }

  /// Calls visit(value) for all, in order.
  template <class Visit>
  void each(Visit&& visit) {
    eachOf(*this, visit);
  }
  template <class Visit>
  void each(Visit&& visit) const {
    eachOf(*this, visit);
  }

  /// Sorts; equal values keep their order. Needs as much room in the folder of the file again.
  template <class Less>
  void stableSort(Less less) {
    if (isSorted(less)) return;
    for (std::size_t begin = 0; begin < size_; begin += kBlock) {
      const std::span<T> block = part(begin, std::min(begin + kBlock, size_));
      std::stable_sort(block.begin(), block.end(), less);
      releaseMemory();
    }
    if (size_ > kBlock) *this = merged(less);
  }

 private:
  [[nodiscard]] T* data() const { return static_cast<T*>(bytes_.data()); }

  template <class Self, class Visit>
  static void eachOf(Self& self, Visit& visit) {
    for (std::size_t i = 0; i < self.size_; ++i) {
      visit(self[i]);
      self.keepNear(i);
    }
    self.releaseMemory();
  }

  void append(const DiskVector& other) {
    other.each([this](const T& value) { push_back(value); });
  }

  template <class Less>
  [[nodiscard]] bool isSorted(Less& less) const {
    for (std::size_t i = 1; i < size_; ++i) {
      if (less((*this)[i], (*this)[i - 1])) return false;
      keepNear(i);
    }
    return true;
  }

  /// The values of sorted blocks, sorted.
  template <class Less>
  [[nodiscard]] DiskVector merged(Less& less) const {
    const auto later = [&](std::size_t a, std::size_t b) {
      if (less((*this)[b], (*this)[a])) return true;
      return !less((*this)[a], (*this)[b]) && b < a;
    };
    std::priority_queue<std::size_t, std::vector<std::size_t>, decltype(later)> next(later);
    for (std::size_t begin = 0; begin < size_; begin += kBlock) next.push(begin);
    DiskVector all;
    while (!next.empty()) {
      const std::size_t i = next.top();
      next.pop();
      all.push_back((*this)[i]);
      if (i + 1 < size_ && (i + 1) % kBlock != 0) next.push(i + 1);
      if (all.size() % kBlock == 0) releaseMemory();
    }
    return all;
  }

  DiskBytes bytes_;
  std::size_t size_ = 0;
  mutable std::size_t near_ = 0;  ///< index at the last call of releaseMemory()
};

}  // namespace lab
