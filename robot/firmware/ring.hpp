#pragma once

#include <stdint.h>

namespace lab {
namespace firmware {

/// A queue of at most N items. When it is full, push() rejects the new item.
template <class T, uint8_t N>
class Ring {
 public:
  bool push(const T& item) {
    if (count_ == N) {
      return false;
    }
    items_[(first_ + count_) % N] = item;
    ++count_;
    return true;
  }

  bool empty() const { return count_ == 0; }

  /// The oldest item; the queue must not be empty.
  const T& front() const { return items_[first_]; }

  void pop() {
    first_ = static_cast<uint8_t>((first_ + 1U) % N);
    --count_;
  }

 private:
  T items_[N];
  uint8_t first_ = 0;
  uint8_t count_ = 0;
};

}  // namespace firmware
}  // namespace lab
