/// Messages of any type as tables of columns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/schema/array_groups.hpp"
#include "common/schema/schema.hpp"

namespace lab::schema {

/// Memory of a column. It grows without being set to zero, and a large block grows in place.
class ColumnMemory {
 public:
  void reserve(std::size_t bytes);
  [[nodiscard]] std::byte* data() { return memory_.get(); }
  [[nodiscard]] const std::byte* data() const { return memory_.get(); }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }

  struct Free {
    void operator()(std::byte* memory) const { std::free(memory); }
  };
  using Block = std::unique_ptr<std::byte, Free>;
  /// Gives the memory away, without what is beyond `bytes`.
  [[nodiscard]] Block release(std::size_t bytes);

 private:
  Block memory_;
  std::size_t capacity_ = 0;
};

/// The texts of a column, each once.
class TextPool {
 public:
  std::int32_t codeOf(std::string_view text);
  [[nodiscard]] const std::vector<std::string>& texts() const { return texts_; }

 private:
  struct Hash {
    using is_transparent = void;
    std::size_t operator()(std::string_view text) const {
      return std::hash<std::string_view>{}(text);
    }
  };
  std::vector<std::string> texts_;
  std::unordered_map<std::string, std::int32_t, Hash, std::equal_to<>> codes_;
};

/// What a column is.
struct ColumnInfo {
  std::string name;
  Kind kind = Kind::kInt64;
  std::string unit{};
  std::string comment{};
  const Field* field = nullptr;  ///< of the type; nullptr: a column that is in no message

  [[nodiscard]] std::size_t itemSize() const {
    return kind == Kind::kString ? sizeof(std::int32_t) : sizeOf(kind);
  }
};

struct Column : ColumnInfo {
  ColumnMemory values{};  ///< little-endian numbers; of a text its code (int32) in `texts`
  TextPool texts{};
};

/// Names of the columns that every table has before those of the type.
namespace columns {
inline constexpr const char* kEvent = "event";                 ///< number of the message in the log
inline constexpr const char* kReceived = "received_utime";     ///< its arrival at the recorder
inline constexpr const char* kParent = "parent";               ///< row of the table one level above
inline constexpr const char* kUtime = "utime";                 ///< of the message
inline constexpr const char* kMessageUtime = "message_utime";  ///< where the row has its own utime
}  // namespace columns

/// One table of a type: a row per message, or per element of a list in it. A struct that is a
/// single field has a column for each of its fields, with its name before theirs ("program_hash");
/// a list of fixed length has one for each element ("covariance_0").
class MessageTable {
 public:
  /// @param path one of tablePaths()
  /// @param selection names of the columns; nothing: all. Without any, rows are only counted.
  /// @throws std::invalid_argument if there is no such table or column
  MessageTable(const Type& type, std::string_view path,
               const std::optional<std::vector<std::string>>& selection = std::nullopt);
  ~MessageTable();
  MessageTable(MessageTable&&) noexcept;
  MessageTable& operator=(MessageTable&&) noexcept;

  /// Appends the rows of one message.
  /// @return false if `encoding` is none of the type; the table is then unchanged
  bool take(std::int64_t event, std::int64_t received_utime, Bytes encoding);

  /// Since the beginning, or since clear().
  [[nodiscard]] std::size_t rows() const;

  void reserve(std::size_t rows);

  /// Removes the rows. The numbers in `parent` continue, and texts keep their codes.
  void clear();

  [[nodiscard]] std::vector<Column>& columns();
  [[nodiscard]] const std::vector<Column>& columns() const;

  /// All columns that the table could have.
  [[nodiscard]] static std::vector<ColumnInfo> allColumns(const Type& type, std::string_view path);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lab::schema
