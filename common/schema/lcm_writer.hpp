/// Writes values as LCM encodes them: big-endian, texts with their length and a final 0 (LCM's type
/// specification).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace lab::schema {

class LcmWriter {
 public:
  /// The lowest `size` bytes of `bits`.
  void number(std::uint64_t bits, std::size_t size) {
    for (std::size_t i = size; i-- > 0;)
      bytes_.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
  }
  void text(std::string_view value) {
    number(value.size() + 1, sizeof(std::int32_t));
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    bytes_.push_back(0);
  }
  void clear() { bytes_.clear(); }
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  [[nodiscard]] std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace lab::schema
