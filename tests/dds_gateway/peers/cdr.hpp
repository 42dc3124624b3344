/// A CDR encoder for ROS 2's wire format: XCDR1, little endian, each value aligned to its own size
/// from the start of the data (OMG DDSI-RTPS 2.3, 10; CORBA 3.1, 15.3).
#pragma once

#include <bit>
#include <cstdint>
#include <string_view>
#include <vector>

namespace lab::ros {

class Cdr {
 public:
  Cdr& u8(std::uint8_t value) { return put(value, 1); }
  Cdr& u32(std::uint32_t value) { return put(value, 4); }
  Cdr& i32(std::int32_t value) { return u32(std::bit_cast<std::uint32_t>(value)); }
  Cdr& f32(float value) { return u32(std::bit_cast<std::uint32_t>(value)); }
  Cdr& f64(double value) { return put(std::bit_cast<std::uint64_t>(value), 8); }
  Cdr& text(std::string_view value) {
    u32(static_cast<std::uint32_t>(value.size()) + 1);
    for (const char one : value) u8(static_cast<std::uint8_t>(one));
    return u8(0);
  }

  /// The payload of a DATA submessage: an encapsulation header, whose last two bits give the number
  /// of padding bytes at the end, and the data.
  [[nodiscard]] std::vector<std::uint8_t> payload() const {
    const std::size_t fill = (4 - data_.size() % 4) % 4;
    std::vector<std::uint8_t> all = {0, 1, 0, static_cast<std::uint8_t>(fill)};
    all.insert(all.end(), data_.begin(), data_.end());
    all.resize(all.size() + fill);
    return all;
  }

 private:
  Cdr& put(std::uint64_t value, std::size_t size) {
    while (data_.size() % size != 0) data_.push_back(0);
    for (std::size_t i = 0; i < size; ++i) {
      data_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
    return *this;
  }

  std::vector<std::uint8_t> data_;
};

}  // namespace lab::ros
