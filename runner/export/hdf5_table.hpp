/// Tables of records in an HDF5 file, which may come from anyone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/schema/message_table.hpp"
#include "runner/export/hdf5_handles.hpp"

namespace lab::runner::hdf5 {

/// A file of which tables are read.
struct ReadFile {
  hid_t id = -1;
  std::uint64_t bytes = 0;
};

/// H5I_GROUP, H5I_DATASET; H5I_BADID: there is nothing of this name.
/// @throws std::runtime_error if a part of the name is a soft or external link, which is not
/// followed
[[nodiscard]] H5I_type_t kindOf(const ReadFile& file, const std::string& name);

/// Opens a dataset whose data is in the file itself.
/// @throws std::runtime_error if there is none, or it takes its data from other files or datasets
[[nodiscard]] Handle openTable(const ReadFile& file, const std::string& name);

/// The number of rows of a dataset of one dimension.
/// @throws std::runtime_error if it has more dimensions, or more rows than the file can hold
[[nodiscard]] hsize_t rowsOf(const ReadFile& file, const Handle& dataset, const std::string& name,
                             std::size_t row_bytes);

/// The rows of a table, read in blocks.
class TableReader {
 public:
  static constexpr int kNone = -1;

  /// @throws std::runtime_error if the table does not have these columns, or more rows than the
  /// file can hold
  TableReader(const ReadFile& file, const std::string& name,
              const std::vector<schema::ColumnInfo>& columns);

  [[nodiscard]] hsize_t rows() const { return rows_; }

  /// Makes rows available from `begin` on, until `end`; those before are given up.
  void require(hsize_t begin, hsize_t end);

  [[nodiscard]] std::uint64_t bits(hsize_t row, std::size_t column) const;
  [[nodiscard]] std::string_view text(hsize_t row, std::size_t column) const;

  /// Index of a column, kNone: there is none.
  [[nodiscard]] int indexOf(std::string_view column) const;

  /// The first column whose name begins so.
  [[nodiscard]] int firstWith(std::string_view begin) const;

  /// The number of rows from `row` on that belong to `parent`.
  hsize_t children(hsize_t row, std::uint64_t parent);

  [[noreturn]] void fail(const std::string& what) const;

 private:
  [[nodiscard]] const std::byte* at(hsize_t row, std::size_t column) const {
    return records_.data() + static_cast<std::size_t>(row - begin_) * record_bytes_ +
           offsets_[column];
  }

  std::string name_;
  Handle dataset_;
  std::vector<schema::ColumnInfo> columns_;
  std::vector<std::size_t> offsets_, sizes_;
  std::size_t record_bytes_ = 0;
  std::optional<Handle> record_;
  hsize_t rows_ = 0;
  std::vector<std::byte> records_;
  hsize_t begin_ = 0, loaded_ = 0;
};

}  // namespace lab::runner::hdf5
