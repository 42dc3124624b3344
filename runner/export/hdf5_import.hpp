/// Reads HDF5 files of lab export, and tables of poses in HDF5.
#pragma once

#include <filesystem>
#include <string>

namespace lab::runner {

[[nodiscard]] bool isHdf5(const std::filesystem::path& file);

/// Whether the file has the tables of a log, as writeHdf5() makes them.
[[nodiscard]] bool hasLogTables(const std::filesystem::path& file);

/// Makes the log again of which the tables were made: the same bytes, if no message was damaged and
/// no row was changed. Rows of lists may have been removed (poses of a robot, say).
/// @throws std::runtime_error if the file cannot be read or its tables do not fit together
void writeLogOfHdf5(const std::filesystem::path& file, const std::filesystem::path& log);

/// Writes a table of poses as CSV with the same columns (analyzer/report/poses/pose_file.hpp): the
/// dataset of records /poses, the table /poses/table of pandas, or the only one in the file.
/// @throws std::runtime_error if there is none
void writePosesOfHdf5(const std::filesystem::path& file, const std::filesystem::path& csv);

}  // namespace lab::runner
