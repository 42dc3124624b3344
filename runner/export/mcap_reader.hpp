/// Reads MCAP files from beginning to end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace lab::runner::mcap {

/// One message of a file. The views are valid during the call.
struct Message {
  std::string_view topic;
  std::string_view schema;           ///< its name
  std::string_view schema_encoding;  ///< "ros2msg"
  std::string_view encoding;         ///< "cdr"
  std::uint64_t log_time = 0;        ///< [ns since 1970]
  std::uint64_t publish_time = 0;
  std::string_view data;
};

struct ReadResult {
  std::int64_t messages = 0;
  bool whole = false;  ///< the file has its end
};

/// Calls `handler` for every message, in the order of the file. A file that was cut short is read
/// as far as it goes.
/// @throws UserError if it cannot be read, is no MCAP file, or has a chunk with a checksum
///   that is wrong or a compression other than none, zstd
ReadResult read(const std::filesystem::path& file,
                const std::function<void(const Message&)>& handler);

/// Whether a file begins as MCAP files do.
[[nodiscard]] bool isMcap(const std::filesystem::path& file);

}  // namespace lab::runner::mcap
