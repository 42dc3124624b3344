#include "runner/export/hdf5_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace lab::runner::hdf5 {
namespace {

using schema::ColumnInfo;
using schema::Kind;

/// Deflate makes data at most 1032 times smaller (zlib.net/zlib_tech.html).
constexpr std::uint64_t kMostCompression = 1100;

/// Whether there is a link of this name, one of its parts after the other.
/// @throws std::runtime_error if one is a soft or external link
bool hasLink(const ReadFile& file, const std::string& name) {
  for (std::size_t end = name.find('/', 1);; end = name.find('/', end + 1)) {
    const std::string part = name.substr(0, end);
    H5L_info_t info{};
    if (H5Lget_info(file.id, part.c_str(), &info, H5P_DEFAULT) < 0) return false;
    if (info.type != H5L_TYPE_HARD) {
      throw std::runtime_error(fmt::format(
          "found the link {} to {}, expected tables in the file itself: copy them with h5repack",
          part, info.type == H5L_TYPE_SOFT ? "another name" : "another file"));
    }
    if (end == std::string::npos) return true;
  }
}

[[noreturn]] void failTable(const std::string& name, const std::string& what) {
  throw std::runtime_error("the table " + name + " " + what +
                           "; expected the tables that lab export --hdf5 makes");
}

}  // namespace

H5I_type_t kindOf(const ReadFile& file, const std::string& name) {
  if (!hasLink(file, name)) return H5I_BADID;
  const hid_t object = H5Oopen(file.id, name.c_str(), H5P_DEFAULT);
  if (object < 0) return H5I_BADID;
  const Handle opened(object, &H5Oclose, name);
  return H5Iget_type(object);
}

Handle openTable(const ReadFile& file, const std::string& name) {
  if (!hasLink(file, name)) throw std::runtime_error("HDF5: there is no " + name);
  Handle dataset(H5Dopen2(file.id, name.c_str(), H5P_DEFAULT), &H5Dclose, "there is no " + name);
  const Handle made(H5Dget_create_plist(dataset.get()), &H5Pclose, name + " has no layout");
  const bool elsewhere =
      H5Pget_layout(made.get()) == H5D_VIRTUAL || H5Pget_external_count(made.get()) != 0;
  if (elsewhere) {
    throw std::runtime_error("the table " + name +
                             " takes its data from other files; expected it in the file itself: "
                             "copy it with h5repack");
  }
  return dataset;
}

hsize_t rowsOf(const ReadFile& file, const Handle& dataset, const std::string& name,
               std::size_t row_bytes) {
  const Handle space(H5Dget_space(dataset.get()), &H5Sclose, name + " has no space");
  hsize_t rows = 0;
  const bool list = H5Sget_simple_extent_ndims(space.get()) == 1 &&
                    H5Sget_simple_extent_dims(space.get(), &rows, nullptr) == 1;
  if (!list || row_bytes == 0) failTable(name, "is no list of records");
  const Handle made(H5Dget_create_plist(dataset.get()), &H5Pclose, name + " has no layout");
  const std::uint64_t stored_bytes =
      std::min<std::uint64_t>(H5Dget_storage_size(dataset.get()), file.bytes);
  const std::uint64_t most_bytes =
      stored_bytes * (H5Pget_nfilters(made.get()) > 0 ? kMostCompression : 1);
  if (rows > most_bytes / row_bytes) {
    failTable(name, fmt::format("declares {} rows of {} bytes, and has {} bytes in the file: it is "
                                "damaged",
                                rows, row_bytes, stored_bytes));
  }
  return rows;
}

TableReader::TableReader(const ReadFile& file, const std::string& name,
                         const std::vector<ColumnInfo>& columns)
    : name_(name), dataset_(openTable(file, name)), columns_(columns) {
  const Handle stored(H5Dget_type(dataset_.get()), &H5Tclose, name + " has no type");
  if (H5Tget_class(stored.get()) != H5T_COMPOUND) fail("is no table of records");
  std::vector<Handle> types;
  for (const ColumnInfo& column : columns_) {
    const int member = H5Tget_member_index(stored.get(), column.name.c_str());
    if (member < 0) fail("has no column " + column.name);
    offsets_.push_back(record_bytes_);
    std::size_t size = column.itemSize();
    if (column.kind == Kind::kString) {
      const Handle text(H5Tget_member_type(stored.get(), static_cast<unsigned>(member)), &H5Tclose,
                        "no type");
      if (H5Tget_class(text.get()) != H5T_STRING || H5Tis_variable_str(text.get()) > 0) {
        fail("has in " + column.name + " no text of fixed length");
      }
      size = H5Tget_size(text.get());
      types.emplace_back(H5Tcopy(text.get()), &H5Tclose, "no type");
    } else {
      types.emplace_back(H5Tcopy(numberType(column.kind)), &H5Tclose, "no type");
    }
    sizes_.push_back(size);
    record_bytes_ += size;
  }
  record_.emplace(H5Tcreate(H5T_COMPOUND, record_bytes_), &H5Tclose, "no type of records");
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    check(H5Tinsert(record_->get(), columns_[i].name.c_str(), offsets_[i], types[i].get()),
          "no column");
  }
  rows_ = rowsOf(file, dataset_, name_, H5Tget_size(stored.get()));
}

void TableReader::require(hsize_t begin, hsize_t end) {
  if (begin >= begin_ && end <= begin_ + loaded_) return;
  constexpr std::size_t kBlock_bytes = 1U << 20U;
  // Twice what is needed, so that a long list is not read again for each of its rows.
  const hsize_t least = 2 * (end - begin);
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

std::uint64_t TableReader::bits(hsize_t row, std::size_t column) const {
  std::uint64_t value = 0;
  std::memcpy(&value, at(row, column), sizes_[column]);
  return value;
}

std::string_view TableReader::text(hsize_t row, std::size_t column) const {
  const auto* begin = reinterpret_cast<const char*>(at(row, column));
  const auto* end = static_cast<const char*>(std::memchr(begin, 0, sizes_[column]));
  return {begin, end == nullptr ? sizes_[column] : static_cast<std::size_t>(end - begin)};
}

int TableReader::indexOf(std::string_view column) const {
  const auto found = std::ranges::find(columns_, column, &ColumnInfo::name);
  return found == columns_.end() ? kNone : static_cast<int>(found - columns_.begin());
}

int TableReader::firstWith(std::string_view begin) const {
  const auto found = std::ranges::find_if(
      columns_, [&](const ColumnInfo& column) { return column.name.starts_with(begin); });
  return found == columns_.end() ? kNone : static_cast<int>(found - columns_.begin());
}

hsize_t TableReader::children(hsize_t row, std::uint64_t parent) {
  const auto column = static_cast<std::size_t>(indexOf(schema::columns::kParent));
  hsize_t end = row;
  while (end < rows_) {
    require(row, end + 1);
    if (bits(end, column) != parent) break;
    ++end;
  }
  return end - row;
}

void TableReader::fail(const std::string& what) const { failTable(name_, what); }

}  // namespace lab::runner::hdf5
