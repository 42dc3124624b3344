/// Poses in HDF5 files that other programs have made.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "runner/export/hdf5_table.hpp"

namespace lab::runner::hdf5 {

/// Writes the poses of a file as CSV with the same columns (analyzer/report/poses/pose_file.hpp).
/// They are the dataset of records /poses, the table /poses/table of pandas, the lists of numbers
/// in the group /poses, one for each column, or such lists in the file itself, or the only table of
/// records in the file. What is no number is left out.
/// @throws std::runtime_error in one line if there are none, or they do not fit each other
void writePoses(const ReadFile& file, std::ostream& out);

/// The names in a group.
[[nodiscard]] std::vector<std::string> linksOf(hid_t group);

}  // namespace lab::runner::hdf5
