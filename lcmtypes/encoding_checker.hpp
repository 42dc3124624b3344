/// The check of an encoding before it is decoded. cmake/CheckedDecoding.cmake writes a function
///
///     void checkFields(EncodingChecker& packet, const program_t* type);
///
/// for every type, beside the class that lcm-gen writes. It names the fields in the order of the
/// definition. LCM's own decoder trusts the counts and lengths in a packet: one flipped bit makes
/// it ask for gigabytes or read past the end.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace lab {

/// Walks over an encoding field by field. It allocates nothing, and its time is proportional to the
/// length of the encoding. The first impossible field ends the walk; later calls do nothing.
class EncodingChecker {
 public:
  explicit EncodingChecker(std::span<const std::uint8_t> encoding) : left_(encoding) {}

  /// Whether the fields so far were possible and used every byte of the encoding.
  [[nodiscard]] bool complete() const { return possible_ && left_.empty(); }

  /// `count` numbers of `size` bytes each.
  void numbers(std::size_t size, std::int64_t count) {
    if (holds(count, size)) left_ = left_.subspan(static_cast<std::size_t>(count) * size);
  }

  /// A number that is the length of one or more lists.
  /// @return the number as it stands in the encoding, 0 when the walk has ended.
  template <std::signed_integral Integer>
  std::int64_t count() {
    if (!holds(1, sizeof(Integer))) return 0;
    std::uint64_t bits = 0;
    for (const std::uint8_t byte : left_.first(sizeof(Integer))) bits = bits << 8 | byte;
    left_ = left_.subspan(sizeof(Integer));
    return static_cast<Integer>(bits);
  }

  /// `count` strings. The length of a string includes its final zero. It holds no other zero: such
  /// a string could not be encoded again.
  void strings(std::int64_t count) {
    if (!holds(count, sizeof(std::int32_t) + 1)) return;
    for (std::int64_t i = 0; i < count && possible_; ++i) {
      const auto length = static_cast<std::size_t>(this->count<std::int32_t>());
      if (length < 1 || length > left_.size() ||
          std::memchr(left_.data(), 0, length) != &left_[length - 1]) {
        fail();
        return;
      }
      left_ = left_.subspan(length);
    }
  }

  /// `count` structs of the type `Part`.
  template <class Part>
  void structs(std::int64_t count) {
    if (!holds(count, 1)) return;
    for (std::int64_t i = 0; i < count && possible_; ++i) {
      checkFields(*this, static_cast<const Part*>(nullptr));
    }
  }

 private:
  /// Whether `count` elements of at least `size` bytes each can be left. Ends the walk if not.
  bool holds(std::int64_t count, std::size_t size) {
    if (count < 0 || static_cast<std::uint64_t>(count) > left_.size() / size) fail();
    return possible_;
  }

  void fail() {
    possible_ = false;
    left_ = {};
  }

  std::span<const std::uint8_t> left_;
  bool possible_ = true;
};

/// A generated type whose encoding can be checked.
template <class Message>
concept CheckedMessage = requires(EncodingChecker& packet, const Message* type) {
  checkFields(packet, type);
};

}  // namespace lab
