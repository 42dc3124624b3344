/// The encoding of ROS 2's messages: OMG CDR, little-endian, with its encapsulation header.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

namespace lab::schema {

/// Writes fields one after the other. A number stands at a multiple of its size, counted from the
/// end of the header.
class CdrWriter {
 public:
  CdrWriter() { begin(); }

  /// Begins a new message in the same memory.
  void begin() { bytes_.assign({0, 1, 0, 0}); }

  template <class Number>
  void number(Number value) {
    align(sizeof value);
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof value);
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }

  void boolean(bool value) { number<std::uint8_t>(value ? 1 : 0); }

  void text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    bytes_.push_back(0);
  }

  /// The length of a sequence, before its elements.
  void length(std::size_t count) { number(static_cast<std::uint32_t>(count)); }

  void bytes(const std::uint8_t* data, std::size_t size) {
    bytes_.insert(bytes_.end(), data, data + size);
  }

  [[nodiscard]] const std::vector<std::uint8_t>& encoding() const { return bytes_; }

 private:
  static constexpr std::size_t kHeader = 4;

  void align(std::size_t size) {
    while ((bytes_.size() - kHeader) % size != 0) bytes_.push_back(0);
  }

  std::vector<std::uint8_t> bytes_;
};

}  // namespace lab::schema
