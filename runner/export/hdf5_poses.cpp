#include "runner/export/hdf5_poses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "common/schema/schema.hpp"

namespace lab::runner::hdf5 {
namespace {

using schema::ColumnInfo;
using schema::Kind;

constexpr const char* kPosesName = "poses";
constexpr const char* kExpectedPoses =
    "expected the tables of lab export --hdf5, or \"poses\": records, or a group with a list of "
    "numbers for each column, frame, id, x_cm, y_cm, theta_rad (docs/formats.md)";

/// Columns of numbers with a number for each row.
struct NumberRows {
  std::vector<ColumnInfo> columns;  ///< Of kind kInt64 or kDouble.
  hsize_t rows = 0;
  /// The bytes of a number. Rows are read one after the other.
  std::function<std::uint64_t(hsize_t row, std::size_t column)> bits;
};

std::optional<Kind> numberKind(H5T_class_t type) {
  if (type == H5T_INTEGER) return Kind::kInt64;
  if (type == H5T_FLOAT) return Kind::kDouble;
  return std::nullopt;
}

/// The columns of a table of records that are numbers.
std::vector<ColumnInfo> numberColumns(const ReadFile& file, const std::string& name) {
  const Handle dataset = openTable(file, name);
  const Handle type(H5Dget_type(dataset.get()), &H5Tclose, name);
  std::vector<ColumnInfo> columns;
  if (H5Tget_class(type.get()) != H5T_COMPOUND) return columns;
  for (unsigned i = 0; i < static_cast<unsigned>(H5Tget_nmembers(type.get())); ++i) {
    const auto kind = numberKind(H5Tget_member_class(type.get(), i));
    char* member = kind ? H5Tget_member_name(type.get(), i) : nullptr;
    if (member == nullptr) continue;
    columns.push_back({member, *kind, "", ""});
    H5free_memory(member);
  }
  return columns;
}

NumberRows recordsIn(const ReadFile& file, const std::string& name) {
  NumberRows records;
  records.columns = numberColumns(file, name);
  const auto table = std::make_shared<TableReader>(file, name, records.columns);
  records.rows = table->rows();
  records.bits = [table](hsize_t row, std::size_t column) {
    table->require(row, row + 1);
    return table->bits(row, column);
  };
  return records;
}

/// A dataset of one dimension with numbers, read in blocks.
class NumberList {
 public:
  NumberList(const ReadFile& file, std::string name, Kind kind)
      : name_(std::move(name)), kind_(kind), dataset_(openTable(file, name_)) {
    const Handle type(H5Dget_type(dataset_.get()), &H5Tclose, name_);
    rows_ = rowsOf(file, dataset_, name_, H5Tget_size(type.get()));
  }

  [[nodiscard]] hsize_t rows() const { return rows_; }

  [[nodiscard]] std::uint64_t bits(hsize_t row) {
    if (row < begin_ || row >= begin_ + block_.size()) load(row);
    return block_[static_cast<std::size_t>(row - begin_)];
  }

 private:
  void load(hsize_t row) {
    constexpr hsize_t kBlock = 1U << 16U;
    const hsize_t count = std::min(rows_ - row, kBlock);
    block_.resize(static_cast<std::size_t>(count));
    const Handle space(H5Dget_space(dataset_.get()), &H5Sclose, "no space");
    const Handle part(H5Screate_simple(1, &count, nullptr), &H5Sclose, "no space");
    check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, &row, nullptr, &count, nullptr),
          "no rows");
    check(H5Dread(dataset_.get(), kind_ == Kind::kInt64 ? H5T_NATIVE_INT64 : H5T_NATIVE_DOUBLE,
                  part.get(), space.get(), H5P_DEFAULT, block_.data()),
          "cannot read " + name_ + ": the file is damaged");
    begin_ = row;
  }

  std::string name_;
  Kind kind_;
  Handle dataset_;
  hsize_t rows_ = 0;
  hsize_t begin_ = 0;
  std::vector<std::uint64_t> block_;
};

/// The lists of numbers in a group.
/// @param prefix "poses/"; empty: in the file itself
NumberRows listsIn(const ReadFile& file, hid_t group, const std::string& prefix) {
  NumberRows result;
  std::vector<std::shared_ptr<NumberList>> lists;
  for (const std::string& link : linksOf(group)) {
    const std::string name = prefix + link;
    if (kindOf(file, name) != H5I_DATASET) continue;
    const Handle dataset = openTable(file, name);
    const Handle type(H5Dget_type(dataset.get()), &H5Tclose, name);
    const Handle space(H5Dget_space(dataset.get()), &H5Sclose, name);
    const auto kind = numberKind(H5Tget_class(type.get()));
    if (!kind || H5Sget_simple_extent_ndims(space.get()) != 1) continue;
    lists.push_back(std::make_shared<NumberList>(file, name, *kind));
    result.columns.push_back({link, *kind, "", ""});
    if (lists.back()->rows() == lists.front()->rows()) continue;
    throw std::runtime_error(fmt::format(
        "found {} numbers in {}{} and {} in {}, expected as many: a row for each pose",
        lists.front()->rows(), prefix, result.columns.front().name, lists.back()->rows(), name));
  }
  if (!lists.empty()) result.rows = lists.front()->rows();
  result.bits = [lists](hsize_t row, std::size_t column) { return lists[column]->bits(row); };
  return result;
}

bool hasList(const ReadFile& file, const std::string& name) {
  return kindOf(file, name) == H5I_DATASET && numberColumns(file, name).empty();
}

NumberRows posesIn(const ReadFile& file) {
  const std::string pandas = std::string(kPosesName) + "/table";
  if (kindOf(file, kPosesName) == H5I_DATASET) {
    if (!numberColumns(file, kPosesName).empty()) return recordsIn(file, kPosesName);
    throw std::runtime_error(
        fmt::format("found {} without names of columns, {}", kPosesName, kExpectedPoses));
  }
  if (kindOf(file, pandas) == H5I_DATASET) return recordsIn(file, pandas);
  if (kindOf(file, kPosesName) == H5I_GROUP) {
    const Handle group(H5Gopen2(file.id, kPosesName, H5P_DEFAULT), &H5Gclose, kPosesName);
    NumberRows lists = listsIn(file, group.get(), std::string(kPosesName) + "/");
    if (!lists.columns.empty()) return lists;
    throw std::runtime_error(
        fmt::format("found no list of numbers in the group {}, {}", kPosesName, kExpectedPoses));
  }
  if (hasList(file, "frame")) return listsIn(file, file.id, "");
  std::vector<std::string> found;
  for (const std::string& link : linksOf(file.id)) {
    for (const std::string& candidate : {link, link + "/table"}) {
      if (kindOf(file, candidate) == H5I_DATASET && !numberColumns(file, candidate).empty()) {
        found.push_back(candidate);
      }
    }
  }
  if (found.size() == 1) return recordsIn(file, found.front());
  throw std::runtime_error(
      fmt::format("found {} tables of records, {}", found.size(), kExpectedPoses));
}

}  // namespace

std::vector<std::string> linksOf(hid_t group) {
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* all) -> herr_t {
    static_cast<std::vector<std::string>*>(all)->emplace_back(name);
    return 0;
  };
  check(H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names), "cannot list a group");
  return names;
}

void writePoses(const ReadFile& file, std::ostream& out) {
  const NumberRows poses = posesIn(file);
  for (std::size_t i = 0; i < poses.columns.size(); ++i) {
    out << (i == 0 ? "" : ",") << poses.columns[i].name;
  }
  out << "\n";
  for (hsize_t row = 0; row < poses.rows; ++row) {
    for (std::size_t i = 0; i < poses.columns.size(); ++i) {
      const std::uint64_t bits = poses.bits(row, i);
      double number = 0;
      std::memcpy(&number, &bits, sizeof number);
      out << (i == 0 ? "" : ",");
      out << (poses.columns[i].kind == Kind::kInt64
                  ? fmt::format("{}", static_cast<std::int64_t>(bits))
                  : fmt::format("{}", number));
    }
    out << "\n";
  }
  out.flush();
  if (!out) throw std::runtime_error("cannot write its poses as CSV: is the disk full?");
}

}  // namespace lab::runner::hdf5
