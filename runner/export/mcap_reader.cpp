#include "runner/export/mcap_reader.hpp"

#include <zlib.h>
#include <zstd.h>

#include <fstream>
#include <map>

#include "runner/command_line/exit_code.hpp"
#include "runner/export/mcap_records.hpp"

namespace lab::runner::mcap {
namespace {

constexpr std::uint64_t kMostUnpacked = std::uint64_t{1}
                                        << 28U;  // bytes of a chunk; writers make 1 to 8 MB

class FileReader {
 public:
  FileReader(const std::filesystem::path& file, const std::function<void(const Message&)>& handler)
      : name_(file.string()),
        size_(std::filesystem::file_size(file)),
        stream_(file, std::ios::binary),
        handler_(handler) {}

  ReadResult read() {
    std::string magic(kMagic.size(), '\0');
    if (!stream_.read(magic.data(), static_cast<std::streamsize>(magic.size())) ||
        magic != kMagic) {
      fail("this is no MCAP file: it does not begin as one");
    }
    while (!result_.whole) {
      std::string head(1 + 8, '\0');
      if (!stream_.read(head.data(), static_cast<std::streamsize>(head.size()))) break;
      RecordReader fields(head);
      const auto opcode = fields.number<Opcode>();
      const auto length = fields.number<std::uint64_t>();
      if (length > left()) break;  // the file was cut short
      std::string content(static_cast<std::size_t>(length), '\0');
      if (!stream_.read(content.data(), static_cast<std::streamsize>(length))) break;
      take(opcode, content);
    }
    return result_;
  }

 private:
  struct Schema {
    std::string name;
    std::string encoding;
  };
  struct Channel {
    std::string topic;
    std::string encoding;
    std::uint16_t schema = 0;
  };

  /// Bytes of the file that have not been read.
  [[nodiscard]] std::uint64_t left() { return size_ - static_cast<std::uint64_t>(stream_.tellg()); }

  [[noreturn]] void fail(const std::string& what) const { throw UserError(name_ + ": " + what); }

  void take(Opcode opcode, std::string_view content) {
    RecordReader fields(content);
    switch (opcode) {
      case Opcode::kSchema: {
        const auto id = fields.number<std::uint16_t>();
        Schema& schema = schemas_[id];
        schema.name = fields.text();
        schema.encoding = fields.text();
        break;
      }
      case Opcode::kChannel: {
        const auto id = fields.number<std::uint16_t>();
        Channel& channel = channels_[id];
        channel.schema = fields.number<std::uint16_t>();
        channel.topic = fields.text();
        channel.encoding = fields.text();
        break;
      }
      case Opcode::kMessage:
        takeMessage(fields);
        break;
      case Opcode::kChunk:
        takeChunk(fields);
        break;
      case Opcode::kDataEnd:
        result_.whole = true;
        break;
      default:
        break;
    }
    if (!fields.possible()) fail("a record is shorter than its fields: the file is damaged");
  }

  void takeMessage(RecordReader& fields) {
    const auto id = fields.number<std::uint16_t>();
    static_cast<void>(fields.number<std::uint32_t>());
    Message message;
    message.log_time = fields.number<std::uint64_t>();
    message.publish_time = fields.number<std::uint64_t>();
    message.data = fields.rest();
    const auto channel = channels_.find(id);
    if (!fields.possible() || channel == channels_.end()) {
      fail("a message is of a channel that is not in the file: it is damaged");
    }
    const Schema& schema = schemas_[channel->second.schema];
    message.topic = channel->second.topic;
    message.encoding = channel->second.encoding;
    message.schema = schema.name;
    message.schema_encoding = schema.encoding;
    ++result_.messages;
    handler_(message);
  }

  void takeChunk(RecordReader& fields) {
    static_cast<void>(fields.number<std::uint64_t>());
    static_cast<void>(fields.number<std::uint64_t>());
    const auto size = fields.number<std::uint64_t>();
    const auto crc = fields.number<std::uint32_t>();
    const std::string compression(fields.text());
    const std::string_view stored = fields.take(fields.number<std::uint64_t>());
    if (size > kMostUnpacked) {
      fail("found a chunk of " + std::to_string(size) + " bytes, expected at most " +
           std::to_string(kMostUnpacked) + ": the file is damaged");
    }
    std::string unpacked;
    std::string_view records = stored;
    if (compression == "zstd") {
      unpacked.resize(static_cast<std::size_t>(size));
      const std::size_t found =
          ZSTD_decompress(unpacked.data(), unpacked.size(), stored.data(), stored.size());
      if (ZSTD_isError(found) != 0 || found != size) fail("a chunk cannot be decompressed");
      records = unpacked;
    } else if (!compression.empty()) {
      fail("found a chunk compressed with " + compression +
           ", expected zstd or none; convert it with: mcap compress --compression zstd");
    }
    const auto* data = reinterpret_cast<const unsigned char*>(records.data());
    if (crc != 0 && ::crc32_z(0, data, records.size()) != crc) {
      fail("a chunk has a wrong checksum: the file is damaged");
    }
    RecordReader inner(records);
    while (!inner.rest().empty() && inner.possible()) {
      const auto opcode = inner.number<Opcode>();
      const std::string_view content = inner.take(inner.number<std::uint64_t>());
      if (opcode == Opcode::kChunk) fail("found a chunk in a chunk: the file is damaged");
      if (inner.possible()) take(opcode, content);
    }
  }

  std::string name_;
  std::uint64_t size_;
  std::ifstream stream_;
  const std::function<void(const Message&)>& handler_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  ReadResult result_;
};

}  // namespace

ReadResult read(const std::filesystem::path& file,
                const std::function<void(const Message&)>& handler) {
  return FileReader(file, handler).read();
}

bool isMcap(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string magic(kMagic.size(), '\0');
  return stream.read(magic.data(), static_cast<std::streamsize>(magic.size())) && magic == kMagic;
}

}  // namespace lab::runner::mcap
