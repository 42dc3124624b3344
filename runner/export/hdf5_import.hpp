/// Reads HDF5 files of lab export, and tables of poses in HDF5.
#pragma once

#include <filesystem>

namespace lab::runner {

/// Whether the file has the signature of HDF5.
[[nodiscard]] bool isHdf5(const std::filesystem::path& file);

enum class Hdf5Content { kLog, kPoses };

/// Reads a file that may come from anyone, in a child process of limited time, memory and output,
/// because the HDF5 library crashes on damaged files. Data outside the file is not read.
///
/// If the file has the tables of a log, as writeHdf5() makes them, it makes that log again: the
/// same bytes, if no message was damaged and no row was changed. Rows of lists may have been
/// removed (poses of a robot, say). Otherwise it writes the table of poses as CSV with the same
/// columns (analyzer/report/poses/pose_file.hpp): the dataset of records /poses, the table
/// /poses/table of pandas, or the only one in the file.
/// @param log,poses new files; the one that does not fit the content stays empty
/// @throws UserError in one line if the file cannot be read, is damaged, refers to other files or
/// has more rows than it can hold
Hdf5Content importHdf5(const std::filesystem::path& file, const std::filesystem::path& log,
                       const std::filesystem::path& poses);

}  // namespace lab::runner
