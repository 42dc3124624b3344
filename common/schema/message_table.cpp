#include "common/schema/message_table.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <new>
#include <stdexcept>
#include <utility>

namespace lab::schema {
namespace {

static_assert(std::endian::native == std::endian::little, "columns are little-endian");

constexpr int kNone = -1;  // no column: the value is skipped
constexpr std::size_t kFewRows = 256;
constexpr std::size_t kMostLists = 8;  // of different lengths, in one struct

template <class Bits>
void storeSwapped(const std::uint8_t* from, std::byte* to) {
  Bits bits{};
  std::memcpy(&bits, from, sizeof bits);
  if constexpr (sizeof bits == 2) bits = __builtin_bswap16(bits);
  if constexpr (sizeof bits == 4) bits = __builtin_bswap32(bits);
  if constexpr (sizeof bits == 8) bits = __builtin_bswap64(bits);
  std::memcpy(to, &bits, sizeof bits);
}

template <class Bits>
void storeMany(const std::uint8_t* from, std::size_t stride, std::size_t count, std::byte* to) {
  for (std::size_t i = 0; i < count; ++i) {
    storeSwapped<Bits>(from + i * stride, to + i * sizeof(Bits));
  }
}

/// Copies `count` numbers of `size` bytes, `stride` bytes apart in the encoding.
void storeNumbers(const std::uint8_t* from, std::size_t stride, std::size_t size, std::size_t count,
                  std::byte* to) {
  switch (size) {
    case 1:
      storeMany<std::uint8_t>(from, stride, count, to);
      return;
    case 2:
      storeMany<std::uint16_t>(from, stride, count, to);
      return;
    case 4:
      storeMany<std::uint32_t>(from, stride, count, to);
      return;
    default:
      storeMany<std::uint64_t>(from, stride, count, to);
      return;
  }
}

/// The bytes of an encoding that are left. After an impossible length every call does nothing.
class Cursor {
 public:
  explicit Cursor(Bytes bytes) : left_(bytes) {}

  [[nodiscard]] bool possible() const { return possible_; }
  [[nodiscard]] bool complete() const { return possible_ && left_.empty(); }

  [[nodiscard]] const std::uint8_t* peek() const { return left_.data(); }

  /// `count` times `size` bytes; nullptr if there are not as many left.
  const std::uint8_t* take(std::size_t size, std::size_t count = 1) {
    if (!possible_ || (size > 0 && count > left_.size() / size)) {
      possible_ = false;
      return nullptr;
    }
    const std::uint8_t* at = left_.data();
    left_ = left_.subspan(size * count);
    return at;
  }

  std::int64_t number(std::size_t size) {
    const std::uint8_t* at = take(size);
    if (at == nullptr) return 0;
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) bits = bits << 8U | at[i];
    const auto unused = static_cast<unsigned>(64 - 8 * size);
    return static_cast<std::int64_t>(bits << unused) >> unused;
  }

  /// A length that is counted in elements of at least one byte each.
  std::size_t count(std::size_t size) {
    const std::int64_t value = number(size);
    if (value < 0 || static_cast<std::uint64_t>(value) > left_.size()) possible_ = false;
    return possible_ ? static_cast<std::size_t>(value) : 0;
  }

  std::string_view text() {
    const std::size_t length = count(sizeof(std::int32_t));
    const std::uint8_t* at = take(1, length);
    if (at == nullptr || length == 0 || std::memchr(at, 0, length) != at + length - 1) {
      possible_ = false;
      return {};
    }
    return {reinterpret_cast<const char*>(at), length - 1};
  }

 private:
  Bytes left_;
  bool possible_ = true;
};

/// What is done with one field of a struct.
struct Step {
  enum class Do { kNumber, kCount, kText, kNumbers, kTexts, kStructs };
  Do what = Do::kNumber;  ///< from kNumbers on: a list
  std::size_t size = 0;   ///< [bytes] of a number
  int column = kNone;
  std::size_t slot = 0;  ///< of a list and of the number that counts it
  bool first = false;    ///< the first of the lists whose elements are the rows
  bool rows = false;     ///< a list whose elements are rows
  int above = kNone;     ///< of a list whose elements have the rows in them: its depth
  std::size_t part = 0;  ///< index of the plan of an element
};

struct FixedNumber {
  std::size_t offset;
  std::size_t size;
  int column;
};

struct Plan {
  std::vector<Step> steps;
  std::size_t slots = 0;
  std::size_t fixed_bytes = 0;       ///< of an element; 0: it varies
  std::vector<FixedNumber> fixed{};  ///< the columns of such an element
};

std::vector<std::string> splitPath(std::string_view path) {
  std::vector<std::string> parts;
  while (!path.empty()) {
    const std::size_t end = path.find('.');
    parts.emplace_back(path.substr(0, end));
    path.remove_prefix(end == std::string_view::npos ? path.size() : end + 1);
  }
  return parts;
}

std::vector<std::string> splitList(std::string_view text) {
  std::vector<std::string> words;
  while (true) {
    const std::size_t end = text.find(',');
    std::string_view word = text.substr(0, end);
    while (word.starts_with(' ')) word.remove_prefix(1);
    words.emplace_back(word);
    if (end == std::string_view::npos) return words;
    text.remove_prefix(end + 1);
  }
}

bool isWord(const std::string& text) {
  return !text.empty() &&
         std::ranges::all_of(text, [](char letter) { return letter >= 'a' && letter <= 'z'; });
}

}  // namespace

void ColumnMemory::reserve(std::size_t bytes) {
  if (bytes <= capacity_) return;
  auto* larger = static_cast<std::byte*>(std::realloc(memory_.get(), bytes));
  if (larger == nullptr) throw std::bad_alloc();
  static_cast<void>(memory_.release());
  memory_.reset(larger);
  capacity_ = bytes;
}

ColumnMemory::Block ColumnMemory::release(std::size_t bytes) {
  if (bytes > 0 && bytes < capacity_) {
    auto* smaller = static_cast<std::byte*>(std::realloc(memory_.get(), bytes));
    if (smaller != nullptr) {
      static_cast<void>(memory_.release());
      memory_.reset(smaller);
    }
  }
  capacity_ = 0;
  return std::move(memory_);
}

std::int32_t TextPool::codeOf(std::string_view text) {
  if (const auto known = codes_.find(text); known != codes_.end()) return known->second;
  const auto code = static_cast<std::int32_t>(texts_.size());
  texts_.emplace_back(text);
  codes_.emplace(text, code);
  return code;
}

class MessageTable::Implementation {
 public:
  Implementation(const Type& type, std::string_view path,
                 const std::optional<std::vector<std::string>>& selection)
      : type_(type), path_(splitPath(path)), selection_(selection) {
    const bool messages = path_.empty();
    event_ = addOwn(columns::kEvent, "", "number of the message in the log, from 0");
    received_ =
        addOwn(columns::kReceived, "us since 1970", "arrival of the message at the recorder");
    const bool timed = !type.fields.empty() && type.fields.front().name == columns::kUtime;
    if (!messages) {
      parent_ = addOwn(columns::kParent, "", "row of the table one level above, from 0");
      if (timed) {
        const Field& field = type.fields.front();
        utime_ = addOwn(rowHasUtime() ? columns::kMessageUtime : columns::kUtime, field.unit,
                        field.comment);
      }
    }
    above_.resize(path_.empty() ? 0 : path_.size() - 1);
    root_ = plan(type, "", 0);
    if (!found_ && !messages) {
      throw std::invalid_argument(type.name + " has no table \"" + std::string(path) + "\"");
    }
    if (selection_) {
      for (const std::string& name : *selection_) {
        if (std::ranges::find(columns_, name, &Column::name) == columns_.end()) {
          throw std::invalid_argument("the table \"" + std::string(path) + "\" of " + type.name +
                                      " has no column " + name);
        }
      }
    }
  }

  bool take(std::int64_t event, std::int64_t received_utime, Bytes encoding) {
    const std::size_t rows_before = rows_;
    const std::vector<std::int64_t> above_before = above_;
    Cursor cursor(encoding);
    if (cursor.number(sizeof(std::int64_t)) != type_.hash) return false;
    event_now_ = event;
    received_now_ = received_utime;
    utime_now_ = 0;
    if (encoding.size() >= 2 * sizeof(std::int64_t)) {
      utime_now_ = fingerprintOf(encoding.data() + sizeof(std::int64_t), sizeof(std::int64_t));
    }
    if (path_.empty()) addRows(1, messages_);
    run(plans_[root_], cursor, rows_before);
    if (!cursor.complete()) {
      rows_ = rows_before;
      above_ = above_before;
      return false;
    }
    ++messages_;
    return true;
  }

  [[nodiscard]] std::size_t rows() const { return rows_; }
  void clear() { rows_ = 0; }
  std::vector<Column>& columns() { return columns_; }
  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }

  void reserve(std::size_t rows) {
    if (rows <= capacity_) return;
    capacity_ = rows;
    for (Column& column : columns_) column.values.reserve(rows * column.itemSize());
  }

 private:
  // --- the plan ---

  int addColumn(ColumnInfo column) {
    if (std::ranges::find(all_names_, column.name) != all_names_.end()) {
      throw std::logic_error(type_.name + ": two columns are named " + column.name);
    }
    all_names_.push_back(column.name);
    if (selection_ && std::ranges::find(*selection_, column.name) == selection_->end())
      return kNone;
    columns_.push_back({std::move(column)});
    return static_cast<int>(columns_.size()) - 1;
  }

  int addOwn(const char* name, const std::string& unit, const std::string& comment) {
    return addColumn({name, Kind::kInt64, unit, comment});
  }

  int addField(const Field& field, const std::string& name) {
    return addColumn({name, field.kind, field.unit, field.comment, &field});
  }

  /// The column of an element of a list of fixed length. Its name and unit are in the comment if
  /// that lists one for each: "[m^2, m^2] xx, xy".
  int addElement(const Field& field, const std::string& name, std::size_t element) {
    const std::vector<std::string> names = splitList(field.comment);
    const std::vector<std::string> units = splitList(field.unit);
    const bool named =
        names.size() == field.count &&
        std::ranges::all_of(names, [](const std::string& word) { return isWord(word); });
    return addColumn({name + "_" + (named ? names[element] : std::to_string(element)), field.kind,
                      units.size() == field.count ? units[element] : field.unit,
                      named ? "" : field.comment, &field});
  }

  /// Whether the rows have a column utime of their own.
  [[nodiscard]] bool rowHasUtime() const {
    const Type* type = &type_;
    for (const std::string& part : path_) {
      const Type* next = nullptr;
      for (const ArrayGroup& group : arrayGroups(*type)) {
        if (group.name == part)
          next = type->fields[static_cast<std::size_t>(group.fields.front())].type;
      }
      if (next == nullptr) return false;
      type = next;
    }
    return type->indexOf(columns::kUtime) >= 0;
  }

  /// Makes the plan of a struct.
  /// @param depth number of the path's lists above it; kSkipped: no row is in it
  std::size_t plan(const Type& type, const std::string& prefix, std::size_t depth) {
    Plan result;
    addSteps(type, prefix, depth, result);
    result.fixed_bytes = type.fixed_bytes;
    if (result.fixed_bytes > 0) collectFixed(result);
    plans_.push_back(std::move(result));
    return plans_.size() - 1;
  }

  static constexpr std::size_t kSkipped = static_cast<std::size_t>(-1);

  void addSteps(const Type& type, const std::string& prefix, std::size_t depth, Plan& plan) {
    const bool is_row = depth == path_.size();
    const std::vector<ArrayGroup> groups = arrayGroups(type);
    std::vector<std::size_t> slots(type.fields.size(), 0);
    std::vector<bool> counts(type.fields.size(), false);
    for (const ArrayGroup& group : groups) {
      if (plan.slots == kMostLists) throw std::logic_error(type.name + " has too many lists");
      counts[static_cast<std::size_t>(group.count_field)] = true;
      slots[static_cast<std::size_t>(group.count_field)] = plan.slots++;
    }
    for (std::size_t i = 0; i < type.fields.size(); ++i) {
      const Field& field = type.fields[i];
      const std::string name = prefix + field.name;
      if (field.count_field >= 0) {
        const auto group = std::ranges::find(groups, field.count_field, &ArrayGroup::count_field);
        addList(type, static_cast<int>(i), *group, prefix, depth, plan,
                slots[static_cast<std::size_t>(field.count_field)]);
      } else if (counts[i]) {
        Step step{.what = Step::Do::kCount, .size = sizeOf(field.kind), .slot = slots[i]};
        if (is_row) step.column = addField(field, name);
        plan.steps.push_back(step);
      } else if (field.type != nullptr) {
        for (std::size_t element = 0; element < field.count; ++element) {
          const std::string index = field.array ? std::to_string(element) + "_" : "";
          addSteps(*field.type, name + "_" + index, depth, plan);
        }
      } else {
        addScalars(field, name, is_row, plan);
      }
    }
  }

  void addScalars(const Field& field, const std::string& name, bool is_row, Plan& plan) {
    const bool text = field.kind == Kind::kString;
    for (std::size_t element = 0; element < field.count; ++element) {
      Step step{.what = text ? Step::Do::kText : Step::Do::kNumber, .size = sizeOf(field.kind)};
      if (is_row) {
        step.column = field.array ? addElement(field, name, element) : addField(field, name);
      }
      plan.steps.push_back(step);
    }
  }

  void addList(const Type& type, int index, const ArrayGroup& group, const std::string& prefix,
               std::size_t depth, Plan& plan, std::size_t slot) {
    const Field& field = type.fields[static_cast<std::size_t>(index)];
    Step step{.what = Step::Do::kNumbers, .size = sizeOf(field.kind), .slot = slot};
    const bool on_path =
        depth != kSkipped && depth < path_.size() && path_[depth] == prefix + group.name;
    step.rows = on_path && depth + 1 == path_.size();
    step.first = step.rows && group.fields.front() == index;
    found_ = found_ || step.rows;
    if (field.type != nullptr) {
      step.what = Step::Do::kStructs;
      if (on_path && !step.rows) {
        if (group.fields.size() > 1) {
          throw std::logic_error(type.name + ": lists beside " + field.name + " have its length");
        }
        step.above = static_cast<int>(depth);
      }
      const std::string inner = group.fields.size() > 1 ? field.name + "_" : "";
      step.part = this->plan(*field.type, inner, on_path ? depth + 1 : kSkipped);
    } else {
      if (field.kind == Kind::kString) step.what = Step::Do::kTexts;
      if (step.rows) step.column = addField(field, field.name);
    }
    plan.steps.push_back(step);
  }

  static void collectFixed(Plan& plan) {
    std::size_t offset = 0;
    for (const Step& step : plan.steps) {
      if (step.column != kNone) plan.fixed.push_back({offset, step.size, step.column});
      offset += step.size;
    }
  }

  // --- its execution ---

  void addRows(std::size_t count, std::int64_t parent) {
    const std::size_t rows = rows_ + count;
    if (rows > capacity_) reserve(std::max({rows, 2 * capacity_, kFewRows}));
    fill(event_, count, event_now_);
    fill(received_, count, received_now_);
    fill(parent_, count, parent);
    fill(utime_, count, utime_now_);
    rows_ = rows;
  }

  void fill(int column, std::size_t count, std::int64_t value) {
    if (column == kNone) return;
    std::byte* to = columns_[static_cast<std::size_t>(column)].values.data() + rows_ * sizeof value;
    for (std::size_t i = 0; i < count; ++i)
      std::memcpy(to + i * sizeof value, &value, sizeof value);
  }

  std::byte* at(int column, std::size_t row) {
    Column& values = columns_[static_cast<std::size_t>(column)];
    return values.values.data() + row * values.itemSize();
  }

  void storeText(int column, std::size_t row, std::string_view text) {
    const std::int32_t code = columns_[static_cast<std::size_t>(column)].texts.codeOf(text);
    std::memcpy(at(column, row), &code, sizeof code);
  }

  /// Walks over a struct, whose columns, if it has any, go to `row`.
  void run(const Plan& plan, Cursor& cursor, std::size_t row) {
    std::array<std::size_t, kMostLists> counts{};
    for (const Step& step : plan.steps) {
      if (!cursor.possible()) return;
      switch (step.what) {
        case Step::Do::kNumber: {
          const std::uint8_t* from = cursor.take(step.size);
          if (from != nullptr && step.column != kNone) {
            storeNumbers(from, 0, step.size, 1, at(step.column, row));
          }
          break;
        }
        case Step::Do::kCount: {
          const std::uint8_t* from = cursor.peek();
          counts[step.slot] = cursor.count(step.size);
          if (cursor.possible() && step.column != kNone) {
            storeNumbers(from, 0, step.size, 1, at(step.column, row));
          }
          break;
        }
        case Step::Do::kText: {
          const std::string_view text = cursor.text();
          if (cursor.possible() && step.column != kNone) storeText(step.column, row, text);
          break;
        }
        default:
          runList(step, counts[step.slot], cursor);
      }
    }
  }

  void runList(const Step& step, std::size_t count, Cursor& cursor) {
    if (step.first) {
      list_row_ = rows_;
      addRows(count, path_.size() == 1 ? messages_ : above_[path_.size() - 2]);
    }
    const std::size_t row = list_row_;
    if (step.what == Step::Do::kNumbers) {
      const std::uint8_t* from = cursor.take(step.size, count);
      if (from != nullptr && step.column != kNone) {
        storeNumbers(from, step.size, step.size, count, at(step.column, row));
      }
    } else if (step.what == Step::Do::kTexts) {
      for (std::size_t i = 0; i < count && cursor.possible(); ++i) {
        const std::string_view text = cursor.text();
        if (cursor.possible() && step.column != kNone) storeText(step.column, row + i, text);
      }
    } else if (const Plan& element = plans_[step.part]; element.fixed_bytes > 0) {
      const std::uint8_t* from = cursor.take(element.fixed_bytes, count);
      if (from == nullptr || !step.rows) return;
      for (const FixedNumber& number : element.fixed) {
        storeNumbers(from + number.offset, element.fixed_bytes, number.size, count,
                     at(number.column, row));
      }
    } else {
      for (std::size_t i = 0; i < count && cursor.possible(); ++i) {
        run(element, cursor, row + i);
        if (step.above != kNone) ++above_[static_cast<std::size_t>(step.above)];
      }
      list_row_ = row;
    }
  }

  const Type& type_;
  std::vector<std::string> path_;
  std::optional<std::vector<std::string>> selection_;
  std::vector<std::string> all_names_;
  std::vector<Column> columns_;
  std::vector<Plan> plans_;
  std::size_t root_ = 0;
  bool found_ = false;
  int event_ = kNone, received_ = kNone, parent_ = kNone, utime_ = kNone;

  std::size_t rows_ = 0;
  std::size_t capacity_ = 0;
  std::int64_t messages_ = 0;        ///< taken so far
  std::vector<std::int64_t> above_;  ///< elements so far of the lists above the rows
  std::size_t list_row_ = 0;         ///< first row of the list that is walked
  std::int64_t event_now_ = 0, received_now_ = 0, utime_now_ = 0;
};

MessageTable::MessageTable(const Type& type, std::string_view path,
                           const std::optional<std::vector<std::string>>& selection)
    : implementation_(std::make_unique<Implementation>(type, path, selection)) {}
MessageTable::~MessageTable() = default;
MessageTable::MessageTable(MessageTable&&) noexcept = default;
MessageTable& MessageTable::operator=(MessageTable&&) noexcept = default;

bool MessageTable::take(std::int64_t event, std::int64_t received_utime, Bytes encoding) {
  return implementation_->take(event, received_utime, encoding);
}
std::size_t MessageTable::rows() const { return implementation_->rows(); }
void MessageTable::reserve(std::size_t rows) { implementation_->reserve(rows); }
void MessageTable::clear() { implementation_->clear(); }
std::vector<Column>& MessageTable::columns() { return implementation_->columns(); }
const std::vector<Column>& MessageTable::columns() const { return implementation_->columns(); }

std::vector<ColumnInfo> MessageTable::allColumns(const Type& type, std::string_view path) {
  const Implementation table(type, path, std::nullopt);
  return {table.columns().begin(), table.columns().end()};
}

}  // namespace lab::schema
