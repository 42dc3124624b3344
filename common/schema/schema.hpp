/// The message types as data: fields, units and constants of lcmtypes/*.lcm, for programs that
/// handle messages of any type (tables, exports, the Python package).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace lab::schema {

enum class Kind {
  kBoolean,
  kByte,
  kInt8,
  kInt16,
  kInt32,
  kInt64,
  kFloat,
  kDouble,
  kString,
  kStruct
};

/// Bytes of a number in an encoding; 0 for strings and structs.
[[nodiscard]] std::size_t sizeOf(Kind kind);

struct Constant {
  std::string type;  ///< "int8_t"
  std::string name;
  std::string value;  ///< as written
  std::string comment;
};

struct Type;

struct Field {
  std::string name;
  Kind kind = Kind::kByte;
  const Type* type = nullptr;  ///< of a struct
  std::string type_name;       ///< as written: "int32_t", "tracked_pose_t"
  std::size_t count = 1;       ///< elements, if the number is fixed
  bool array = false;          ///< whether it is written with brackets
  int count_field = -1;        ///< index of the field that holds the number of elements; -1: fixed
  std::string unit;            ///< "m", "us since 1970"; empty: none is given
  std::string comment;         ///< without the unit
  std::vector<Constant> constants{};  ///< those that follow the field in its definition
};

/// One message type, or a part of one.
struct Type {
  std::string name;     ///< "robot_status_t"
  std::string comment;  ///< before the struct
  std::vector<Field> fields;
  std::int64_t base_hash = 0;   ///< of its own fields, as lcm-gen computes it
  std::int64_t hash = 0;        ///< LCM's fingerprint, with which an encoding begins
  std::size_t fixed_bytes = 0;  ///< of an encoding, if all encodings have the same size; else 0

  /// -1: it has none of this name.
  [[nodiscard]] int indexOf(std::string_view field) const;
};

/// A set of definitions.
class Schema {
 public:
  /// @param definitions the texts of .lcm files of one package, one struct each, in any order
  /// @throws std::invalid_argument that quotes what is not understood, or names a type that is
  ///   missing
  explicit Schema(const std::vector<std::string>& definitions);

  /// In alphabetical order.
  [[nodiscard]] const std::vector<std::unique_ptr<Type>>& types() const { return types_; }

  /// nullptr: there is none.
  [[nodiscard]] const Type* find(std::string_view name) const;
  [[nodiscard]] const Type* findHash(std::int64_t hash) const;

 private:
  void link(Type& type);
  std::int64_t hashOf(const Type& type, std::vector<const Type*>& parents) const;

  std::vector<std::unique_ptr<Type>> types_;
  std::map<std::string, Type*, std::less<>> by_name_;
  std::map<std::int64_t, const Type*> by_hash_;
};

/// The types of lcmtypes/ with which this program was built.
[[nodiscard]] const Schema& messageSchema();

/// The first 8 bytes of an encoding; 0 if it has fewer.
[[nodiscard]] std::int64_t fingerprintOf(const std::uint8_t* data, std::size_t size);

}  // namespace lab::schema
