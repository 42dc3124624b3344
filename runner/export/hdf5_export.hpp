/// Writes a log as an HDF5 file that h5py, pandas, MATLAB and R read.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "runner/export/table_channels.hpp"

namespace lab::runner {

/// Every table of every channel becomes a dataset of records: /CHANNEL/messages has a row per
/// message, /CHANNEL/robots a row per element of the list `robots` (MessageTable). Texts have a
/// fixed length and are padded with zeros; a text that repeats costs almost nothing, because
/// datasets are compressed. The attributes `units` and `descriptions` of a dataset are JSON.
/// /poses, /states, /truth, /light, /events, /analysis and /collective are further names of the
/// datasets that most users want.
/// @param about attributes of the file
/// @return the messages that are not in the file
/// @throws std::runtime_error if the file cannot be written
LeftOut writeHdf5(const std::vector<std::filesystem::path>& log, const std::filesystem::path& file,
                  const std::map<std::string, std::string>& about);

}  // namespace lab::runner
