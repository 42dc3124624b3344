#include "common/schema/schema.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include "common/schema/definitions.hpp"

namespace lab::schema {
namespace {

struct KindName {
  std::string_view name;
  Kind kind;
  std::size_t size;
};

constexpr KindName kKinds[] = {
    {"boolean", Kind::kBoolean, 1}, {"byte", Kind::kByte, 1},     {"int8_t", Kind::kInt8, 1},
    {"int16_t", Kind::kInt16, 2},   {"int32_t", Kind::kInt32, 4}, {"int64_t", Kind::kInt64, 8},
    {"float", Kind::kFloat, 4},     {"double", Kind::kDouble, 8}, {"string", Kind::kString, 0},
};

std::optional<Kind> primitive(std::string_view name) {
  for (const KindName& kind : kKinds) {
    if (kind.name == name) return kind.kind;
  }
  return std::nullopt;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// LCM's own sums over names and dimensions (lcmgen.c).
std::int64_t hashOfByte(std::int64_t hash, std::int64_t byte) {
  const auto bits = static_cast<std::uint64_t>(hash);
  const auto sign = static_cast<std::uint64_t>(hash >> 55);
  return static_cast<std::int64_t>(((bits << 8U) ^ sign) + static_cast<std::uint64_t>(byte));
}

std::int64_t hashOfText(std::int64_t hash, std::string_view text) {
  hash = hashOfByte(hash, static_cast<std::int64_t>(text.size()));
  for (const char letter : text) hash = hashOfByte(hash, letter);
  return hash;
}

void append(std::string& text, std::string_view more) {
  if (more.empty()) return;
  if (!text.empty()) text += ' ';
  text += more;
}

/// Reads one definition, line by line: a comment belongs to the statement before it on its line.
class Parser {
 public:
  Type parse(std::string_view text) {
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      readLine(text.substr(0, end));
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
    if (!ended_ || type_.fields.empty()) fail("the end of the file", "a struct with fields and }");
    for (Field& field : type_.fields) splitUnit(field);
    return std::move(type_);
  }

 private:
  [[noreturn]] void fail(std::string_view found, const std::string& expected) const {
    throw std::invalid_argument("definition of " + (type_.name.empty() ? "a type" : type_.name) +
                                ": found \"" + std::string(found.substr(0, 60)) + "\", expected " +
                                expected);
  }

  void readLine(std::string_view line) {
    const std::size_t slashes = line.find("//");
    std::string_view code = trimmed(line.substr(0, slashes));
    std::string_view comment;
    if (slashes != std::string_view::npos) comment = trimmed(line.substr(slashes + 2));
    if (code.empty()) {
      if (!begun_) append(type_.comment, comment);
      return;
    }
    last_comment_ = nullptr;
    while (!code.empty()) code = readStatement(code);
    if (last_comment_ != nullptr) append(*last_comment_, comment);
  }

  std::string_view readStatement(std::string_view code) {
    if (code == "}") {
      ended_ = true;
      return {};
    }
    if (code.starts_with("struct ")) {
      const std::size_t brace = code.find('{');
      if (brace == std::string_view::npos) fail(code, "struct NAME {");
      type_.name = trimmed(code.substr(7, brace - 7));
      begun_ = true;
      return trimmed(code.substr(brace + 1));
    }
    const std::size_t end = code.find(';');
    if (end == std::string_view::npos) fail(code, "a statement that ends with ; on its line");
    const std::string_view statement = trimmed(code.substr(0, end));
    if (statement.starts_with("const ")) {
      readConstant(statement.substr(6));
    } else if (!statement.starts_with("package ")) {
      readField(statement);
    }
    return trimmed(code.substr(end + 1));
  }

  void readConstant(std::string_view statement) {
    const std::size_t blank = statement.find(' ');
    const std::size_t equals = statement.find('=');
    if (blank == std::string_view::npos || equals == std::string_view::npos ||
        type_.fields.empty()) {
      fail(statement, "const TYPE NAME = VALUE after a field");
    }
    Constant constant;
    constant.type = statement.substr(0, blank);
    constant.name = trimmed(statement.substr(blank, equals - blank));
    constant.value = trimmed(statement.substr(equals + 1));
    auto& constants = type_.fields.back().constants;
    constants.push_back(std::move(constant));
    last_comment_ = &constants.back().comment;
  }

  void readField(std::string_view statement) {
    const std::size_t blank = statement.find(' ');
    if (!begun_ || blank == std::string_view::npos)
      fail(statement, "TYPE NAME or TYPE NAME[COUNT]");
    Field field;
    field.type_name = statement.substr(0, blank);
    field.kind = primitive(field.type_name).value_or(Kind::kStruct);
    std::string_view name = trimmed(statement.substr(blank));
    const std::size_t bracket = name.find('[');
    if (bracket != std::string_view::npos) {
      if (name.back() != ']') fail(statement, "one dimension in brackets");
      const std::string count(trimmed(name.substr(bracket + 1, name.size() - bracket - 2)));
      name = trimmed(name.substr(0, bracket));
      field.array = true;
      field.count_field = type_.indexOf(count);
      if (field.count_field < 0) {
        const bool number =
            !count.empty() && count.find_first_not_of("0123456789") == std::string::npos;
        if (!number) fail(count, "a number, or a field before " + std::string(name));
        field.count = std::stoul(count);
      }
    }
    field.name = name;
    type_.fields.push_back(std::move(field));
    last_comment_ = &type_.fields.back().comment;
  }

  /// Cuts the unit, in square brackets, out of a comment: "[m] ..." or "(STEP) [s] ...".
  static void splitUnit(Field& field) {
    std::string& comment = field.comment;
    const std::size_t begin = comment.starts_with('(') ? comment.find(") [") + 2 : 0;
    const std::size_t end = comment.find(']', begin);
    if (begin < comment.size() && comment[begin] == '[' && end != std::string::npos) {
      field.unit = comment.substr(begin + 1, end - begin - 1);
      std::string rest(trimmed(comment.substr(0, begin)));
      append(rest, trimmed(std::string_view(comment).substr(end + 1)));
      comment = rest;
    } else if (field.kind == Kind::kInt64 && field.name.ends_with("utime")) {
      field.unit = "us since 1970";  // as lcmtypes/README.md says of all times
    }
  }

  Type type_;
  bool begun_ = false;
  bool ended_ = false;
  std::string* last_comment_ = nullptr;
};

std::int64_t baseHash(const Type& type) {
  constexpr std::int64_t kStart = 0x12345678;
  constexpr std::int64_t kFixed = 0;
  constexpr std::int64_t kVariable = 1;
  std::int64_t hash = kStart;
  for (const Field& field : type.fields) {
    hash = hashOfText(hash, field.name);
    if (field.kind != Kind::kStruct) hash = hashOfText(hash, field.type_name);
    hash = hashOfByte(hash, field.array ? 1 : 0);
    if (!field.array) continue;
    const bool variable = field.count_field >= 0;
    hash = hashOfByte(hash, variable ? kVariable : kFixed);
    hash = hashOfText(hash, variable ? type.fields[static_cast<std::size_t>(field.count_field)].name
                                     : std::to_string(field.count));
  }
  return hash;
}

}  // namespace

std::size_t sizeOf(Kind kind) {
  for (const KindName& known : kKinds) {
    if (known.kind == kind) return known.size;
  }
  return 0;
}

int Type::indexOf(std::string_view field) const {
  const auto found = std::ranges::find(fields, field, &Field::name);
  return found == fields.end() ? -1 : static_cast<int>(found - fields.begin());
}

Schema::Schema(const std::vector<std::string>& definitions) {
  for (const std::string& text : definitions) {
    types_.push_back(std::make_unique<Type>(Parser().parse(text)));
  }
  std::ranges::sort(types_, {}, [](const auto& type) { return type->name; });
  for (const auto& type : types_) by_name_[type->name] = type.get();
  for (const auto& type : types_) link(*type);
  for (const auto& type : types_) {
    std::vector<const Type*> parents;
    type->hash = hashOf(*type, parents);
    by_hash_[type->hash] = type.get();
  }
  // A type's size is that of its parts, which may come later in the alphabet.
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& type : types_) {
      std::size_t size = 0;
      for (const Field& field : type->fields) {
        const std::size_t one =
            field.kind == Kind::kStruct ? field.type->fixed_bytes : sizeOf(field.kind);
        size = one == 0 || field.count_field >= 0 ? 0 : size + one * field.count;
        if (size == 0) break;
      }
      changed = changed || size != type->fixed_bytes;
      type->fixed_bytes = size;
    }
  }
}

void Schema::link(Type& type) {
  type.base_hash = baseHash(type);
  for (Field& field : type.fields) {
    if (field.kind != Kind::kStruct) continue;
    field.type = find(field.type_name);
    if (field.type == nullptr) {
      throw std::invalid_argument("definition of " + type.name + ": found the type " +
                                  field.type_name + ", which no definition has");
    }
  }
}

std::int64_t Schema::hashOf(const Type& type, std::vector<const Type*>& parents) const {
  if (std::ranges::find(parents, &type) != parents.end()) return 0;
  parents.push_back(&type);
  auto sum = static_cast<std::uint64_t>(type.base_hash);
  for (const Field& field : type.fields) {
    if (field.type != nullptr) sum += static_cast<std::uint64_t>(hashOf(*field.type, parents));
  }
  parents.pop_back();
  return static_cast<std::int64_t>((sum << 1U) + ((sum >> 63U) & 1U));
}

const Type* Schema::find(std::string_view name) const {
  const auto found = by_name_.find(name);
  return found == by_name_.end() ? nullptr : found->second;
}

const Type* Schema::findHash(std::int64_t hash) const {
  const auto found = by_hash_.find(hash);
  return found == by_hash_.end() ? nullptr : found->second;
}

const Schema& messageSchema() {
  static const Schema schema(definitionTexts());
  return schema;
}

std::int64_t fingerprintOf(const std::uint8_t* data, std::size_t size) {
  if (size < sizeof(std::int64_t)) return 0;
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < sizeof bits; ++i) bits = bits << 8U | data[i];
  return static_cast<std::int64_t>(bits);
}

}  // namespace lab::schema
