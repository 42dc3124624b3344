#include "runner/export/mcap_writer.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <stdexcept>

namespace lab::runner::mcap {
namespace {

constexpr int kZstdLevel = 3;  // Zstandard's default

std::uint32_t crcOf(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      ::crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

std::string compressed(std::string_view bytes) {
  std::string result(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), kZstdLevel);
  if (ZSTD_isError(size) != 0) throw std::runtime_error(ZSTD_getErrorName(size));
  result.resize(size);
  return result;
}

std::string indexOf(std::uint16_t channel,
                    const std::vector<std::pair<std::uint64_t, std::uint64_t>>& entries) {
  RecordWriter list;
  for (const auto& [time, offset] : entries) list.number(time).number(offset);
  return RecordWriter().number(channel).text(list.bytes()).bytes();
}

}  // namespace

Writer::Writer(const std::filesystem::path& file, std::string_view library, const Options& options)
    : options_(options), path_(file), file_(file, std::ios::binary | std::ios::trunc) {
  write(kMagic);
  writeRecord(Opcode::kHeader, RecordWriter().text("ros2").text(library).bytes());
}

Writer::~Writer() = default;

std::uint16_t Writer::addSchema(std::string_view name, std::string_view encoding,
                                std::string_view data) {
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);
  RecordWriter content;
  content.number(id).text(name).text(encoding).text(data);
  schemas_.push_back(RecordWriter().record(Opcode::kSchema, content.bytes()).bytes());
  chunk_.raw(schemas_.back());
  return id;
}

std::uint16_t Writer::addChannel(std::uint16_t schema, std::string_view topic,
                                 std::string_view message_encoding, const Text& metadata) {
  const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
  RecordWriter content;
  content.number(id).number(schema).text(topic).text(message_encoding).texts(metadata);
  channels_.push_back(RecordWriter().record(Opcode::kChannel, content.bytes()).bytes());
  chunk_.raw(channels_.back());
  counts_[id] = 0;
  return id;
}

void Writer::addMessage(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time,
                        std::span<const std::uint8_t> data) {
  const bool first = chunk_index_.empty();
  chunk_begin_ = first ? log_time : std::min(chunk_begin_, log_time);
  chunk_end_ = first ? log_time : std::max(chunk_end_, log_time);
  begin_ = any_ ? std::min(begin_, log_time) : log_time;
  end_ = any_ ? std::max(end_, log_time) : log_time;
  any_ = true;
  chunk_index_[channel].emplace_back(log_time, chunk_.bytes().size());
  constexpr std::size_t kHead = 2 + 4 + 8 + 8;
  chunk_.number(Opcode::kMessage).number(static_cast<std::uint64_t>(kHead + data.size()));
  chunk_.number(channel).number(sequences_[channel]++).number(log_time).number(publish_time);
  chunk_.raw({reinterpret_cast<const char*>(data.data()), data.size()});
  ++counts_[channel];
  if (chunk_.bytes().size() >= options_.chunk_bytes) closeChunk();
}

void Writer::addAttachment(std::string_view name, std::string_view media_type,
                           std::string_view data, std::uint64_t time) {
  closeChunk();
  RecordWriter content;
  content.number(time).number(time).text(name).text(media_type);
  content.number(static_cast<std::uint64_t>(data.size())).raw(data);
  content.number(crcOf(content.bytes()));
  const std::uint64_t offset = offset_;
  writeRecord(Opcode::kAttachment, content.bytes());
  attachments_.push_back(
      {offset, offset_ - offset, time, data.size(), std::string(name), std::string(media_type)});
}

void Writer::addMetadata(std::string_view name, const Text& values) {
  closeChunk();
  const std::uint64_t offset = offset_;
  writeRecord(Opcode::kMetadata, RecordWriter().text(name).texts(values).bytes());
  metadata_.push_back({offset, offset_ - offset, std::string(name)});
}

void Writer::closeChunk() {
  if (chunk_.bytes().empty()) return;
  const std::string& plain = chunk_.bytes();
  ChunkEntry entry{.begin = chunk_begin_, .end = chunk_end_, .offset = offset_};
  entry.uncompressed = plain.size();
  std::string packed;
  if (options_.compress) {
    packed = compressed(plain);
    entry.compression = "zstd";
  }
  const std::string& stored = options_.compress ? packed : plain;
  entry.compressed = stored.size();
  RecordWriter content;
  content.number(entry.begin).number(entry.end).number(entry.uncompressed).number(crcOf(plain));
  content.text(entry.compression).number(entry.compressed).raw(stored);
  writeRecord(Opcode::kChunk, content.bytes());
  entry.length = offset_ - entry.offset;
  const std::uint64_t indices = offset_;
  for (const auto& [channel, entries] : chunk_index_) {
    entry.index_offsets[channel] = offset_;
    writeRecord(Opcode::kMessageIndex, indexOf(channel, entries));
  }
  entry.index_length = offset_ - indices;
  chunk_entries_.push_back(std::move(entry));
  chunk_.clear();
  chunk_index_.clear();
  chunk_begin_ = chunk_end_ = 0;
}

void Writer::write(std::string_view bytes) {
  file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file_) {
    throw std::runtime_error("cannot write " + path_.string() +
                             ": the disk is full, or the folder is not there or not yours");
  }
  offset_ += bytes.size();
}

void Writer::writeRecord(Opcode opcode, std::string_view content) {
  const std::string head =
      RecordWriter().number(opcode).number(static_cast<std::uint64_t>(content.size())).bytes();
  write(head);
  write(content);
}

void Writer::close() {
  if (closed_) return;
  closed_ = true;
  closeChunk();
  writeRecord(Opcode::kDataEnd, RecordWriter().number(std::uint32_t{0}).bytes());
  writeSummary();
  write(kMagic);
  file_.flush();
  write({});
}

void Writer::writeSummary() {
  const std::uint64_t summary_start = offset_;
  RecordWriter summary;
  RecordWriter offsets;
  const auto group = [&](Opcode opcode, const auto& entries, const auto& add) {
    const std::uint64_t begin = summary_start + summary.bytes().size();
    for (const auto& entry : entries) add(entry);
    const std::uint64_t length = summary_start + summary.bytes().size() - begin;
    if (length == 0) return;
    RecordWriter content;
    content.number(opcode).number(begin).number(length);
    offsets.record(Opcode::kSummaryOffset, content.bytes());
  };
  group(Opcode::kSchema, schemas_, [&](const std::string& record) { summary.raw(record); });
  group(Opcode::kChannel, channels_, [&](const std::string& record) { summary.raw(record); });
  group(Opcode::kStatistics, std::vector<int>{0}, [&](int) {
    RecordWriter counts;
    std::uint64_t messages = 0;
    for (const auto& [channel, count] : counts_) {
      counts.number(channel).number(count);
      messages += count;
    }
    RecordWriter content;
    content.number(messages).number(static_cast<std::uint16_t>(schemas_.size()));
    content.number(static_cast<std::uint32_t>(channels_.size()));
    content.number(static_cast<std::uint32_t>(attachments_.size()));
    content.number(static_cast<std::uint32_t>(metadata_.size()));
    content.number(static_cast<std::uint32_t>(chunk_entries_.size()));
    content.number(begin_).number(end_).text(counts.bytes());
    summary.record(Opcode::kStatistics, content.bytes());
  });
  group(Opcode::kChunkIndex, chunk_entries_, [&](const ChunkEntry& entry) {
    RecordWriter indices;
    for (const auto& [channel, offset] : entry.index_offsets)
      indices.number(channel).number(offset);
    RecordWriter content;
    content.number(entry.begin).number(entry.end).number(entry.offset).number(entry.length);
    content.text(indices.bytes()).number(entry.index_length).text(entry.compression);
    content.number(entry.compressed).number(entry.uncompressed);
    summary.record(Opcode::kChunkIndex, content.bytes());
  });
  group(Opcode::kAttachmentIndex, attachments_, [&](const AttachmentEntry& entry) {
    RecordWriter content;
    content.number(entry.offset).number(entry.length).number(entry.time).number(entry.time);
    content.number(entry.size).text(entry.name).text(entry.media_type);
    summary.record(Opcode::kAttachmentIndex, content.bytes());
  });
  group(Opcode::kMetadataIndex, metadata_, [&](const MetadataEntry& entry) {
    RecordWriter content;
    content.number(entry.offset).number(entry.length).text(entry.name);
    summary.record(Opcode::kMetadataIndex, content.bytes());
  });
  const std::uint64_t offset_start = summary_start + summary.bytes().size();
  write(summary.bytes());
  write(offsets.bytes());
  // The checksum covers everything from the summary to the footer's own checksum.
  RecordWriter footer;
  footer.number(Opcode::kFooter).number(std::uint64_t{8 + 8 + 4});
  footer.number(summary_start).number(offset_start);
  std::uint32_t crc = crcOf(summary.bytes());
  crc = crcOf(offsets.bytes(), crc);
  crc = crcOf(footer.bytes(), crc);
  footer.number(crc);
  write(footer.bytes());
}

}  // namespace lab::runner::mcap
