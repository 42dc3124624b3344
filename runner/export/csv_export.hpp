/// Writes a log as CSV files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runner/export/table_channels.hpp"

namespace lab::runner {

/// Time 0 of a run, as in its report: the command of the first step of the light script, else the
/// START of the experiment, the first camera frame, or the first message [us since 1970].
[[nodiscard]] std::int64_t timeZero(const std::vector<std::filesystem::path>& log);

/// One file per table of every channel (MessageTable): CHANNEL.csv with a row per message,
/// CHANNEL.robots.csv with a row per element of the list `robots`; and columns.csv with unit and
/// meaning of every column. Numbers have as many digits as they need to be read back exactly.
/// @param folder exists
/// @return the messages that are not in the files
/// @throws std::runtime_error if a file cannot be written
LeftOut writeCsv(const std::vector<std::filesystem::path>& log,
                 const std::filesystem::path& folder);

/// The poses for trackpy: frame, particle, x, y [cm], t [s since time 0], theta [rad].
/// @throws std::runtime_error if the file cannot be written
void writeTrackpy(const std::vector<std::filesystem::path>& log, const std::filesystem::path& file);

/// The poses as TRex exports them: NAME_id1.csv, ... with a row for every frame, frames without the
/// robot included. `lab analyze FOLDER` reads them.
/// @param free_bytes room in the folder; none: what the file system says
/// @throws std::runtime_error if there is not the room for a row per robot and frame, or a file
/// cannot be written
void writeTrex(const std::vector<std::filesystem::path>& log, const std::filesystem::path& folder,
               const std::string& name, std::optional<double> free_bytes = {});

}  // namespace lab::runner
