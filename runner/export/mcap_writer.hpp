/// Writes MCAP files: chunks compressed with Zstandard, with all indices.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "runner/export/mcap_records.hpp"

namespace lab::runner::mcap {

class Writer {
 public:
  struct Options {
    bool compress = true;
    std::size_t chunk_bytes = 1U << 20U;  ///< uncompressed, from which a chunk is closed
  };

  /// @param library name and version of this software
  /// @throws std::runtime_error if the file cannot be written
  Writer(const std::filesystem::path& file, std::string_view library, const Options& options);
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer();

  /// @return its id
  std::uint16_t addSchema(std::string_view name, std::string_view encoding, std::string_view data);

  /// @return its id
  std::uint16_t addChannel(std::uint16_t schema, std::string_view topic,
                           std::string_view message_encoding, const Text& metadata = {});

  /// Times in ns since 1970.
  void addMessage(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time,
                  std::span<const std::uint8_t> data);

  void addAttachment(std::string_view name, std::string_view media_type, std::string_view data,
                     std::uint64_t time);
  void addMetadata(std::string_view name, const Text& values);

  /// Writes summary and footer.
  /// @throws std::runtime_error if the disk is full or gone
  void close();

 private:
  struct ChunkEntry {
    std::uint64_t begin = 0, end = 0;  ///< of its messages [ns]
    std::uint64_t offset = 0, length = 0;
    std::map<std::uint16_t, std::uint64_t> index_offsets{};
    std::uint64_t index_length = 0;
    std::uint64_t compressed = 0, uncompressed = 0;
    std::string compression{};
  };
  struct AttachmentEntry {
    std::uint64_t offset = 0, length = 0, time = 0, size = 0;
    std::string name{}, media_type{};
  };
  struct MetadataEntry {
    std::uint64_t offset = 0, length = 0;
    std::string name{};
  };

  void closeChunk();
  void write(std::string_view bytes);
  void writeRecord(Opcode opcode, std::string_view content);
  void writeSummary();

  Options options_;
  std::filesystem::path path_;
  std::ofstream file_;
  std::uint64_t offset_ = 0;
  bool closed_ = false;

  std::vector<std::string> schemas_;   ///< records
  std::vector<std::string> channels_;  ///< records
  std::map<std::uint16_t, std::uint64_t> counts_;
  std::map<std::uint16_t, std::uint32_t> sequences_;
  std::uint64_t begin_ = 0, end_ = 0;
  bool any_ = false;

  RecordWriter chunk_;
  std::uint64_t chunk_begin_ = 0, chunk_end_ = 0;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> chunk_index_;
  std::vector<ChunkEntry> chunk_entries_;
  std::vector<AttachmentEntry> attachments_;
  std::vector<MetadataEntry> metadata_;
};

}  // namespace lab::runner::mcap
