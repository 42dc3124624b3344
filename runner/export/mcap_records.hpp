/// The records of MCAP files (https://mcap.dev/spec): little-endian, each with an opcode and its
/// length.
#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lab::runner::mcap {

inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};

enum class Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

using Text = std::map<std::string, std::string>;

/// Writes the fields of records.
class RecordWriter {
 public:
  template <class Number>
  RecordWriter& number(Number value) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof value);
    std::memcpy(bytes_.data() + at, &value, sizeof value);
    return *this;
  }

  RecordWriter& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    return raw(value);
  }

  RecordWriter& raw(std::string_view value) {
    bytes_.append(value);
    return *this;
  }

  RecordWriter& texts(const Text& values) {
    RecordWriter pairs;
    for (const auto& [key, value] : values) pairs.text(key).text(value);
    return text(pairs.bytes());
  }

  /// Appends a whole record.
  RecordWriter& record(Opcode opcode, std::string_view content) {
    number(opcode);
    number(static_cast<std::uint64_t>(content.size()));
    return raw(content);
  }

  void clear() { bytes_.clear(); }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Reads the fields of records. After an impossible length everything is empty or 0.
class RecordReader {
 public:
  explicit RecordReader(std::string_view bytes) : left_(bytes) {}

  [[nodiscard]] bool possible() const { return possible_; }
  [[nodiscard]] std::string_view rest() const { return left_; }

  template <class Number>
  Number number() {
    Number value{};
    const std::string_view bytes = take(sizeof value);
    if (bytes.size() == sizeof value) std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }

  std::string_view text() { return take(number<std::uint32_t>()); }

  std::string_view take(std::uint64_t size) {
    if (size > left_.size()) {
      possible_ = false;
      left_ = {};
      return {};
    }
    const std::string_view taken = left_.substr(0, static_cast<std::size_t>(size));
    left_.remove_prefix(static_cast<std::size_t>(size));
    return taken;
  }

 private:
  std::string_view left_;
  bool possible_ = true;
};

}  // namespace lab::runner::mcap
