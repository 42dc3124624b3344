#include "runner/export/hdf5_import.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/log_file.hpp"
#include "common/schema/array_groups.hpp"
#include "common/schema/lcm_writer.hpp"
#include "common/schema/message_table.hpp"
#include "common/schema/schema.hpp"
#include "runner/export/hdf5_handles.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

using hdf5::check;
using hdf5::Handle;
using schema::ColumnInfo;
using schema::Field;
using schema::Kind;
using schema::Type;

constexpr int kNone = -1;

Handle openFile(const fs::path& file) {
  hdf5::silence();
  return {H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), &H5Fclose,
          "cannot read " + file.string()};
}

/// The rows of a table, read in blocks.
class TableReader {
 public:
  TableReader(hid_t file, const std::string& name, const std::vector<ColumnInfo>& columns)
      : name_(name),
        dataset_(H5Dopen2(file, name.c_str(), H5P_DEFAULT), &H5Dclose, "there is no " + name),
        columns_(columns) {
    const Handle stored(H5Dget_type(dataset_.get()), &H5Tclose, name + " has no type");
    if (H5Tget_class(stored.get()) != H5T_COMPOUND) fail("is no table of records");
    std::vector<Handle> types;
    for (const ColumnInfo& column : columns_) {
      const int member = H5Tget_member_index(stored.get(), column.name.c_str());
      if (member < 0) fail("has no column " + column.name);
      offsets_.push_back(record_bytes_);
      std::size_t size = column.itemSize();
      if (column.kind == Kind::kString) {
        const Handle text(H5Tget_member_type(stored.get(), static_cast<unsigned>(member)),
                          &H5Tclose, "no type");
        if (H5Tget_class(text.get()) != H5T_STRING || H5Tis_variable_str(text.get()) > 0) {
          fail("has in " + column.name + " no text of fixed length");
        }
        size = H5Tget_size(text.get());
        types.emplace_back(H5Tcopy(text.get()), &H5Tclose, "no type");
      } else {
        types.emplace_back(H5Tcopy(hdf5::numberType(column.kind)), &H5Tclose, "no type");
      }
      sizes_.push_back(size);
      record_bytes_ += size;
    }
    record_.emplace(H5Tcreate(H5T_COMPOUND, record_bytes_), &H5Tclose, "no type of records");
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      check(H5Tinsert(record_->get(), columns_[i].name.c_str(), offsets_[i], types[i].get()),
            "no column");
    }
    const Handle space(H5Dget_space(dataset_.get()), &H5Sclose, name + " has no space");
    check(H5Sget_simple_extent_dims(space.get(), &rows_, nullptr) == 1 ? 0 : -1,
          name + " is no list of records");
  }

  [[nodiscard]] hsize_t rows() const { return rows_; }
  [[nodiscard]] const std::string& name() const { return name_; }

  /// Makes rows available from `begin` on, until `end`; those before are given up.
  void require(hsize_t begin, hsize_t end) {
    if (begin >= begin_ && end <= begin_ + loaded_) return;
    constexpr std::size_t kBlock_bytes = 1U << 20U;
    const hsize_t least = end - begin;
    const hsize_t count =
        std::min(rows_ - begin, std::max<hsize_t>(least, kBlock_bytes / record_bytes_ + 1));
    records_.resize(static_cast<std::size_t>(count) * record_bytes_);
    const Handle space(H5Dget_space(dataset_.get()), &H5Sclose, "no space");
    const Handle part(H5Screate_simple(1, &count, nullptr), &H5Sclose, "no space");
    check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, &begin, nullptr, &count, nullptr),
          "no rows");
    check(H5Dread(dataset_.get(), record_->get(), part.get(), space.get(), H5P_DEFAULT,
                  records_.data()),
          "cannot read the table " + name_ + ": the file is damaged");
    begin_ = begin;
    loaded_ = count;
  }

  [[nodiscard]] std::uint64_t bits(hsize_t row, std::size_t column) const {
    std::uint64_t value = 0;
    std::memcpy(&value, at(row, column), sizes_[column]);
    return value;
  }
  [[nodiscard]] std::string_view text(hsize_t row, std::size_t column) const {
    const auto* begin = reinterpret_cast<const char*>(at(row, column));
    const auto* end = static_cast<const char*>(std::memchr(begin, 0, sizes_[column]));
    return {begin, end == nullptr ? sizes_[column] : static_cast<std::size_t>(end - begin)};
  }
  [[nodiscard]] std::size_t sizeOf(std::size_t column) const { return sizes_[column]; }

  [[nodiscard]] int indexOf(std::string_view column) const {
    const auto found = std::ranges::find(columns_, column, &ColumnInfo::name);
    return found == columns_.end() ? kNone : static_cast<int>(found - columns_.begin());
  }

  /// The first column whose name begins so.
  [[nodiscard]] int firstWith(std::string_view begin) const {
    const auto found = std::ranges::find_if(
        columns_, [&](const ColumnInfo& column) { return column.name.starts_with(begin); });
    return found == columns_.end() ? kNone : static_cast<int>(found - columns_.begin());
  }

  /// The number of rows from `row` on that belong to `parent`.
  hsize_t children(hsize_t row, std::uint64_t parent) {
    const auto column = static_cast<std::size_t>(indexOf(schema::columns::kParent));
    hsize_t end = row;
    while (end < rows_) {
      require(row, end + 1);
      if (bits(end, column) != parent) break;
      ++end;
    }
    return end - row;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error("the table " + name_ + " " + what +
                             "; expected the tables that lab export --hdf5 makes");
  }

 private:
  [[nodiscard]] const std::byte* at(hsize_t row, std::size_t column) const {
    return records_.data() + static_cast<std::size_t>(row - begin_) * record_bytes_ +
           offsets_[column];
  }

  std::string name_;
  Handle dataset_;
  std::vector<ColumnInfo> columns_;
  std::vector<std::size_t> offsets_, sizes_;
  std::size_t record_bytes_ = 0;
  std::optional<Handle> record_;
  hsize_t rows_ = 0;
  std::vector<std::byte> records_;
  hsize_t begin_ = 0, loaded_ = 0;
};

/// A table from which messages take their rows, one after the other.
struct Source {
  std::unique_ptr<TableReader> table;
  hsize_t next = 0;   ///< the first row that belongs to no message yet
  hsize_t count = 0;  ///< of the rows of the present list
};

/// How a struct is made of rows.
struct Step {
  enum class Do { kNumber, kText, kCount, kNumbers, kTexts, kStructs };
  Do what = Do::kNumber;
  std::size_t size = 0;
  std::size_t column = 0;
  Source* source = nullptr;  ///< of a list
  std::size_t part = 0;      ///< plan of its elements
};
struct Plan {
  std::vector<Step> steps;
  std::vector<Source*> lists;
};

/// The messages of one channel.
class Channel {
 public:
  Channel(hid_t file, std::string name, const Type& type) : name_(std::move(name)), type_(type) {
    for (const std::string& path : schema::tablePaths(type)) {
      Source& source = sources_[path];
      source.table = std::make_unique<TableReader>(file, "/" + name_ + "/" + hdf5::tableName(path),
                                                   schema::MessageTable::allColumns(type, path));
    }
    messages_ = &sources_.at("");
    root_ = plan(type, "", "", *messages_);
    event_ = static_cast<std::size_t>(messages_->table->indexOf(schema::columns::kEvent));
    received_ = static_cast<std::size_t>(messages_->table->indexOf(schema::columns::kReceived));
  }

  /// Number of the next message in the log; nothing: there is none.
  [[nodiscard]] std::optional<std::int64_t> nextEvent() {
    if (messages_->next == messages_->table->rows()) {
      requireEnd();
      return std::nullopt;
    }
    messages_->table->require(messages_->next, messages_->next + 1);
    return static_cast<std::int64_t>(messages_->table->bits(messages_->next, event_));
  }

  void write(LogWriter& log) {
    const hsize_t row = messages_->next;
    encoding_.clear();
    encoding_.number(static_cast<std::uint64_t>(type_.hash), sizeof type_.hash);
    encode(plans_[root_], *messages_->table, row);
    log.write({name_, encoding_.bytes(),
               static_cast<std::int64_t>(messages_->table->bits(row, received_))});
    ++messages_->next;
  }

 private:
  std::size_t plan(const Type& type, const std::string& prefix, const std::string& path,
                   Source& row) {
    Plan result;
    addSteps(type, prefix, path, row, result);
    plans_.push_back(std::move(result));
    return plans_.size() - 1;
  }

  void addSteps(const Type& type, const std::string& prefix, const std::string& path, Source& row,
                Plan& plan) {
    const std::vector<schema::ArrayGroup> groups = schema::arrayGroups(type);
    std::map<int, Source*> counted;
    for (const schema::ArrayGroup& group : groups) {
      Source& source = sources_.at((path.empty() ? "" : path + ".") + prefix + group.name);
      counted[group.count_field] = &source;
      plan.lists.push_back(&source);
    }
    for (std::size_t i = 0; i < type.fields.size(); ++i) {
      const Field& field = type.fields[i];
      const std::size_t size = schema::sizeOf(field.kind);
      if (field.count_field >= 0) {
        const auto group =
            std::ranges::find(groups, field.count_field, &schema::ArrayGroup::count_field);
        addList(field, *group, (path.empty() ? "" : path + ".") + prefix + group->name,
                *counted.at(field.count_field), plan);
      } else if (const auto list = counted.find(static_cast<int>(i)); list != counted.end()) {
        plan.steps.push_back({.what = Step::Do::kCount, .size = size, .source = list->second});
      } else if (field.type != nullptr) {
        for (std::size_t element = 0; element < field.count; ++element) {
          const std::string index = field.array ? std::to_string(element) + "_" : "";
          addSteps(*field.type, prefix + field.name + "_" + index, path, row, plan);
        }
      } else {
        // The elements of a list of fixed length are columns beside each other, whatever their
        // names.
        const std::size_t first = columnOf(field, prefix, *row.table);
        for (std::size_t element = 0; element < field.count; ++element) {
          plan.steps.push_back(
              {.what = field.kind == Kind::kString ? Step::Do::kText : Step::Do::kNumber,
               .size = size,
               .column = first + element});
        }
      }
    }
  }

  void addList(const Field& field, const schema::ArrayGroup& group, const std::string& path,
               Source& source, Plan& plan) {
    Step step{.what = Step::Do::kNumbers, .size = schema::sizeOf(field.kind), .source = &source};
    if (field.type != nullptr) {
      step.what = Step::Do::kStructs;
      step.part =
          this->plan(*field.type, group.fields.size() > 1 ? field.name + "_" : "", path, source);
    } else {
      if (field.kind == Kind::kString) step.what = Step::Do::kTexts;
      step.column = columnOf(field, "", *source.table);
    }
    plan.steps.push_back(step);
  }

  static std::size_t columnOf(const Field& field, const std::string& prefix,
                              const TableReader& table) {
    const std::string name = prefix + field.name;
    int index = table.indexOf(name);
    const bool elements = field.array && field.count_field < 0;
    if (index == kNone && elements) index = table.firstWith(name + "_");
    if (index == kNone) table.fail("has no column " + name);
    return static_cast<std::size_t>(index);
  }

  void encode(const Plan& plan, TableReader& table, hsize_t row) {
    for (Source* list : plan.lists) list->count = list->table->children(list->next, row);
    for (const Step& step : plan.steps) {
      switch (step.what) {
        case Step::Do::kNumber:
          encoding_.number(table.bits(row, step.column), step.size);
          break;
        case Step::Do::kText:
          encoding_.text(table.text(row, step.column));
          break;
        case Step::Do::kCount:
          encoding_.number(step.source->count, step.size);
          break;
        default:
          encodeList(step);
      }
    }
    for (Source* list : plan.lists) {
      list->next += list->count;
      list->count = 0;
    }
  }

  void encodeList(const Step& step) {
    Source& source = *step.source;
    const hsize_t begin = source.next;
    const hsize_t end = begin + source.count;
    for (hsize_t row = begin; row < end; ++row) {
      source.table->require(begin, end);
      if (step.what == Step::Do::kNumbers) {
        encoding_.number(source.table->bits(row, step.column), step.size);
      } else if (step.what == Step::Do::kTexts) {
        encoding_.text(source.table->text(row, step.column));
      } else {
        encode(plans_[step.part], *source.table, row);
      }
    }
  }

  void requireEnd() const {
    for (const auto& [path, source] : sources_) {
      if (source.next == source.table->rows()) continue;
      source.table->fail(
          fmt::format("has rows that belong to no message, from row {} on", source.next));
    }
  }

  std::string name_;
  const Type& type_;
  std::map<std::string, Source> sources_;
  Source* messages_ = nullptr;
  std::vector<Plan> plans_;
  std::size_t root_ = 0;
  std::size_t event_ = 0, received_ = 0;
  schema::LcmWriter encoding_;
};

std::vector<std::string> linksOf(hid_t group) {
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* all) -> herr_t {
    static_cast<std::vector<std::string>*>(all)->emplace_back(name);
    return 0;
  };
  check(H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names), "cannot list a group");
  return names;
}

/// H5I_GROUP, H5I_DATASET; H5I_BADID: there is nothing of this name.
H5I_type_t kindOf(hid_t file, const std::string& name) {
  const hid_t object = H5Oopen(file, name.c_str(), H5P_DEFAULT);
  if (object < 0) return H5I_BADID;
  const Handle opened(object, &H5Oclose, name);
  return H5Iget_type(object);
}

/// Channels with their types.
std::vector<std::pair<std::string, const Type*>> channelsOf(hid_t file) {
  std::vector<std::pair<std::string, const Type*>> channels;
  for (const std::string& name : linksOf(file)) {
    const std::string table = name + "/messages";
    if (kindOf(file, name) != H5I_GROUP || kindOf(file, table) != H5I_DATASET) continue;
    const Handle dataset(H5Dopen2(file, table.c_str(), H5P_DEFAULT), &H5Dclose, table);
    const Type* type = schema::messageSchema().find(hdf5::readText(dataset.get(), "type"));
    if (type != nullptr) channels.emplace_back(name, type);
  }
  return channels;
}

/// The columns of a table of numbers.
std::vector<ColumnInfo> numberColumns(hid_t file, const std::string& name) {
  const Handle dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), &H5Dclose, name);
  const Handle type(H5Dget_type(dataset.get()), &H5Tclose, name);
  std::vector<ColumnInfo> columns;
  if (H5Tget_class(type.get()) != H5T_COMPOUND) return columns;
  for (unsigned i = 0; i < static_cast<unsigned>(H5Tget_nmembers(type.get())); ++i) {
    const H5T_class_t kind = H5Tget_member_class(type.get(), i);
    if (kind != H5T_INTEGER && kind != H5T_FLOAT) continue;
    char* member = H5Tget_member_name(type.get(), i);
    columns.push_back({member, kind == H5T_INTEGER ? Kind::kInt64 : Kind::kDouble, "", ""});
    H5free_memory(member);
  }
  return columns;
}

/// The dataset with poses.
std::string posesIn(hid_t file, const fs::path& name) {
  if (kindOf(file, "poses") == H5I_DATASET) return "poses";
  if (kindOf(file, "poses/table") == H5I_DATASET) return "poses/table";
  std::vector<std::string> found;
  for (const std::string& link : linksOf(file)) {
    for (const std::string& candidate : {link, link + "/table"}) {
      if (kindOf(file, candidate) == H5I_DATASET && !numberColumns(file, candidate).empty()) {
        found.push_back(candidate);
      }
    }
  }
  if (found.size() == 1) return found.front();
  throw std::runtime_error(fmt::format(
      "{}: found {} tables of records, expected those of lab export --hdf5, or a table \"poses\" "
      "with the columns of docs/track.md (pandas: to_hdf(FILE, \"poses\", format=\"table\", "
      "data_columns=True))",
      name.string(), found.size()));
}

}  // namespace

bool isHdf5(const fs::path& file) {
  hdf5::silence();
  return fs::is_regular_file(file) && H5Fis_hdf5(file.c_str()) > 0;
}

bool hasLogTables(const fs::path& file) { return !channelsOf(openFile(file).get()).empty(); }

void writeLogOfHdf5(const fs::path& file, const fs::path& log) {
  const Handle opened = openFile(file);
  std::vector<std::unique_ptr<Channel>> channels;
  for (const auto& [name, type] : channelsOf(opened.get())) {
    channels.push_back(std::make_unique<Channel>(opened.get(), name, *type));
  }
  LogWriter writer(log);
  std::vector<std::optional<std::int64_t>> events;
  for (const auto& channel : channels) events.push_back(channel->nextEvent());
  while (true) {
    std::size_t first = channels.size();
    for (std::size_t i = 0; i < channels.size(); ++i) {
      if (events[i] && (first == channels.size() || *events[i] < *events[first])) first = i;
    }
    if (first == channels.size()) break;
    channels[first]->write(writer);
    events[first] = channels[first]->nextEvent();
  }
  writer.flush();
}

void writePosesOfHdf5(const fs::path& file, const fs::path& csv) {
  const Handle opened = openFile(file);
  const std::string name = posesIn(opened.get(), file);
  const std::vector<ColumnInfo> columns = numberColumns(opened.get(), name);
  TableReader table(opened.get(), name, columns);
  std::ofstream out(csv);
  for (std::size_t i = 0; i < columns.size(); ++i) out << (i == 0 ? "" : ",") << columns[i].name;
  out << "\n";
  for (hsize_t row = 0; row < table.rows(); ++row) {
    table.require(row, row + 1);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const std::uint64_t bits = table.bits(row, i);
      double number = 0;
      std::memcpy(&number, &bits, sizeof number);
      out << (i == 0 ? "" : ",");
      out << (columns[i].kind == Kind::kInt64 ? fmt::format("{}", static_cast<std::int64_t>(bits))
                                              : fmt::format("{}", number));
    }
    out << "\n";
  }
  out.flush();
  if (!out) throw std::runtime_error("cannot write " + csv.string() + ": is the disk full?");
}

}  // namespace lab::runner
