#include "common/schema/ros_encoding.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <set>

#include "common/schema/cdr_writer.hpp"
#include "common/schema/lcm_writer.hpp"

namespace lab::schema {
namespace {

/// "robot_status_t" -> "RobotStatus"
std::string camelCase(std::string_view name) {
  if (name.ends_with("_t")) name.remove_suffix(2);
  std::string result;
  bool upper = true;
  for (const char letter : name) {
    if (letter == '_') {
      upper = true;
      continue;
    }
    result += upper ? static_cast<char>(std::toupper(static_cast<unsigned char>(letter))) : letter;
    upper = false;
  }
  return result;
}

/// Of a field or a constant: "int8_t" -> "int8".
std::string rosTypeName(std::string_view type) {
  if (type == "float") return "float32";
  if (type == "double") return "float64";
  if (type == "boolean") return "bool";
  if (type == "byte") return "uint8";
  if (type.ends_with("_t")) type.remove_suffix(2);
  return std::string(type);
}

std::string fieldLine(const Field& field) {
  std::string line = field.type != nullptr
                         ? std::string(kRosPackage) + "/" + camelCase(field.type_name)
                         : rosTypeName(field.type_name);
  if (field.array) {
    line += field.count_field >= 0 ? "[]" : "[" + std::to_string(field.count) + "]";
  }
  line += " " + field.name;
  if (!field.unit.empty() || !field.comment.empty()) line += "  #";
  if (!field.unit.empty()) line += " [" + field.unit + "]";
  if (!field.comment.empty()) line += " " + field.comment;
  return line + "\n";
}

std::string msgFile(const Type& type) {
  std::string text = type.comment.empty() ? "" : "# " + type.comment + "\n";
  for (const Field& field : type.fields) {
    text += fieldLine(field);
    for (const Constant& constant : field.constants) {
      text += rosTypeName(constant.type) + " " + constant.name + "=" + constant.value;
      text += constant.comment.empty() ? "\n" : "  # " + constant.comment + "\n";
    }
  }
  return text;
}

void collectParts(const Type& type, std::vector<const Type*>& parts) {
  for (const Field& field : type.fields) {
    if (field.type == nullptr || std::ranges::find(parts, field.type) != parts.end()) continue;
    parts.push_back(field.type);
    collectParts(*field.type, parts);
  }
}

/// Reads numbers of either byte order.
class Reader {
 public:
  Reader(Bytes bytes, bool big_endian, bool aligned)
      : bytes_(bytes), big_endian_(big_endian), aligned_(aligned) {}

  [[nodiscard]] bool possible() const { return possible_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

  /// Whether everything was read. CDR may end with padding to a multiple of 4.
  [[nodiscard]] bool complete() const { return possible_ && (aligned_ ? left() < 4 : left() == 0); }

  std::uint64_t bits(std::size_t size) {
    if (aligned_) {
      const std::size_t padding = (size - at_ % size) % size;
      if (take(padding) == nullptr) return 0;
    }
    const std::uint8_t* from = take(size);
    if (from == nullptr) return 0;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i)
      value = value << 8U | from[big_endian_ ? i : size - 1 - i];
    return value;
  }

  const std::uint8_t* take(std::size_t size) {
    if (!possible_ || size > left()) {
      possible_ = false;
      return nullptr;
    }
    const std::uint8_t* from = bytes_.data() + at_;
    at_ += size;
    return from;
  }

  /// A length of at least one byte per element.
  std::size_t length(std::size_t size) {
    const std::uint64_t value = bits(size);
    if (value > left()) possible_ = false;
    return possible_ ? static_cast<std::size_t>(value) : 0;
  }

  std::string_view text() {
    const std::size_t size = length(sizeof(std::uint32_t));
    const std::uint8_t* from = take(size);
    if (from == nullptr || size == 0 || std::memchr(from, 0, size) != from + size - 1) {
      possible_ = false;
      return {};
    }
    return {reinterpret_cast<const char*>(from), size - 1};
  }

  void fail() { possible_ = false; }

 private:
  Bytes bytes_;
  std::size_t at_ = 0;
  bool big_endian_;
  bool aligned_;
  bool possible_ = true;
};

std::int64_t signedOf(std::uint64_t bits, std::size_t size) {
  const auto unused = static_cast<unsigned>(64 - 8 * size);
  return static_cast<std::int64_t>(bits << unused) >> unused;
}

void putNumber(CdrWriter& cdr, std::uint64_t bits, std::size_t size) {
  switch (size) {
    case 1:
      cdr.number(static_cast<std::uint8_t>(bits));
      return;
    case 2:
      cdr.number(static_cast<std::uint16_t>(bits));
      return;
    case 4:
      cdr.number(static_cast<std::uint32_t>(bits));
      return;
    default:
      cdr.number(bits);
      return;
  }
}

void copyToCdr(const Type& type, Reader& lcm, CdrWriter& cdr) {
  std::vector<std::int64_t> numbers(type.fields.size(), 0);
  for (std::size_t i = 0; i < type.fields.size() && lcm.possible(); ++i) {
    const Field& field = type.fields[i];
    std::size_t count = field.count;
    if (field.count_field >= 0) {
      const std::int64_t number = numbers[static_cast<std::size_t>(field.count_field)];
      if (number < 0 || static_cast<std::uint64_t>(number) > lcm.left()) return lcm.fail();
      count = static_cast<std::size_t>(number);
      cdr.length(count);
    }
    const std::size_t size = sizeOf(field.kind);
    for (std::size_t element = 0; element < count && lcm.possible(); ++element) {
      if (field.type != nullptr) {
        copyToCdr(*field.type, lcm, cdr);
      } else if (field.kind == Kind::kString) {
        cdr.text(lcm.text());
      } else {
        const std::uint64_t bits = lcm.bits(size);
        numbers[i] = signedOf(bits, size);
        putNumber(cdr, bits, size);
      }
    }
  }
}

void copyFromCdr(const Type& type, Reader& cdr, LcmWriter& lcm) {
  std::vector<std::int64_t> numbers(type.fields.size(), 0);
  for (std::size_t i = 0; i < type.fields.size() && cdr.possible(); ++i) {
    const Field& field = type.fields[i];
    std::size_t count = field.count;
    if (field.count_field >= 0) {
      count = cdr.length(sizeof(std::uint32_t));
      const std::int64_t number = numbers[static_cast<std::size_t>(field.count_field)];
      if (number < 0 || static_cast<std::uint64_t>(number) != count) return cdr.fail();
    }
    const std::size_t size = sizeOf(field.kind);
    for (std::size_t element = 0; element < count && cdr.possible(); ++element) {
      if (field.type != nullptr) {
        copyFromCdr(*field.type, cdr, lcm);
      } else if (field.kind == Kind::kString) {
        lcm.text(cdr.text());
      } else {
        const std::uint64_t bits = cdr.bits(size);
        numbers[i] = signedOf(bits, size);
        lcm.number(bits, size);
      }
    }
  }
}

}  // namespace

std::string rosName(const Type& type) {
  return std::string(kRosPackage) + "/msg/" + camelCase(type.name);
}

const Type* typeOfRosName(std::string_view name) {
  for (const auto& type : messageSchema().types()) {
    if (rosName(*type) == name) return type.get();
  }
  return nullptr;
}

std::string rosDefinition(const Type& type) {
  std::string text = msgFile(type);
  std::vector<const Type*> parts;
  collectParts(type, parts);
  for (const Type* part : parts) {
    text += std::string(80, '=') + "\nMSG: " + kRosPackage + "/" + camelCase(part->name) + "\n" +
            msgFile(*part);
  }
  return text;
}

std::optional<std::vector<std::uint8_t>> toCdr(const Type& type, Bytes encoding) {
  Reader lcm(encoding, true, false);
  if (static_cast<std::int64_t>(lcm.bits(sizeof type.hash)) != type.hash) return std::nullopt;
  CdrWriter cdr;
  copyToCdr(type, lcm, cdr);
  if (!lcm.complete()) return std::nullopt;
  return cdr.encoding();
}

std::optional<std::vector<std::uint8_t>> fromCdr(const Type& type, Bytes cdr) {
  constexpr std::size_t kHeader = 4;
  if (cdr.size() < kHeader || cdr[0] != 0 || cdr[1] > 1) return std::nullopt;
  Reader reader(cdr.subspan(kHeader), cdr[1] == 0, true);
  LcmWriter lcm;
  lcm.number(static_cast<std::uint64_t>(type.hash), sizeof type.hash);
  copyFromCdr(type, reader, lcm);
  if (!reader.complete()) return std::nullopt;
  return lcm.take();
}

}  // namespace lab::schema
