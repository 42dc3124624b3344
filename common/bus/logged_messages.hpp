/// Messages of log files in any order.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/log_file.hpp"
#include "common/files/mapped_file.hpp"

namespace lab {

/// Reads single messages of log files. Those in the order of a file are read fastest; the memory
/// that they take does not grow with the log.
class LoggedMessages {
 public:
  explicit LoggedMessages(const std::vector<std::filesystem::path>& files);

  /// @param at as LogReader::position() gave it for the same files
  /// @return as LogReader gives it: of the present contract version. Valid until the next call.
  /// @throws std::runtime_error if a file cannot be opened, or has become shorter
  [[nodiscard]] Bytes at(const LogPosition& at);

 private:
  std::vector<std::filesystem::path> files_;
  std::vector<std::unique_ptr<MappedFile>> mapped_;  ///< of each of files_; nullptr: not yet needed
  std::optional<std::vector<std::uint8_t>> newer_;
};

}  // namespace lab
