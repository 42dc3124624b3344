/// The bytes of a fuzzer's input, consumed from the front.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>

namespace lab::fuzz {

/// Beyond its end an input has zeros.
class Input {
 public:
  Input(const std::uint8_t* bytes, std::size_t size) : rest_(bytes, size) {}

  [[nodiscard]] bool empty() const { return rest_.empty(); }

  /// An integer or floating-point number with these bytes, in the order of this machine.
  template <class Number>
  [[nodiscard]] Number number() {
    Number value{};
    const auto bytes = take(sizeof value);
    if (!bytes.empty()) std::memcpy(&value, bytes.data(), bytes.size());
    return value;
  }

  /// Up to `size` bytes.
  [[nodiscard]] std::span<const std::uint8_t> take(std::size_t size) {
    const auto taken = rest_.first(std::min(size, rest_.size()));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }

  [[nodiscard]] std::string text(std::size_t size) {
    const auto bytes = take(size);
    return {bytes.begin(), bytes.end()};
  }
  /// As text(), up to the first NUL.
  [[nodiscard]] std::string cText(std::size_t size) { return text(size).c_str(); }
  [[nodiscard]] std::string restAsText() { return text(rest_.size()); }

 private:
  std::span<const std::uint8_t> rest_;
};

/// Ends the program, as a finding, if a condition does not hold that every input must keep.
inline void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace lab::fuzz
