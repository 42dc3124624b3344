#include "common/log_file.hpp"

#include <lcm/lcm.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "common/channels.hpp"
#include "common/contract_upgrade.hpp"

namespace lab {
namespace fs = std::filesystem;

namespace {

using Log = std::unique_ptr<lcm_eventlog_t, decltype(&lcm_eventlog_destroy)>;
using Event = std::unique_ptr<lcm_eventlog_event_t, decltype(&lcm_eventlog_free_event)>;

/// Moves to the first sync word at or behind the file's position. @return false: there is none.
bool findEvent(std::FILE* file) {
  constexpr std::uint32_t kSync = 0xEDA1DA01;
  std::uint32_t word = 0;
  for (int byte = std::fgetc(file); byte != EOF; byte = std::fgetc(file)) {
    word = (word << 8U) | static_cast<std::uint32_t>(byte);
    if (word == kSync) return fseeko(file, -4, SEEK_CUR) == 0;
  }
  return false;
}

/// An event's sync word, number, time and two lengths.
constexpr off_t kHeader_bytes = 28;

void readFile(const fs::path& path, const PacketHandler& handler, LogReadResult& result) {
  const Log log(lcm_eventlog_create(path.c_str(), "r"), &lcm_eventlog_destroy);
  if (!log) throw std::runtime_error("cannot open the log " + path.string());
  off_t whole = 0;  // everything up to here is read or counted
  while (findEvent(log->f)) {
    const off_t start = ftello(log->f);
    const Event event(lcm_eventlog_read_next_event(log.get()), &lcm_eventlog_free_event);
    if (!event) {
      if (fseeko(log->f, start + 1, SEEK_SET) != 0) break;
      continue;
    }
    if (start != whole) ++result.resyncs;
    whole = start + kHeader_bytes + event->channellen + event->datalen;
    const std::string_view channel(event->channel, static_cast<std::size_t>(event->channellen));
    if (channel == channels::kLcmSelfTest) continue;
    ++result.events;
    const Bytes data(static_cast<const std::uint8_t*>(event->data),
                     static_cast<std::size_t>(event->datalen));
    const std::optional<std::vector<std::uint8_t>> newer = upgraded(data);
    handler({channel, newer ? Bytes(*newer) : data, event->timestamp});
  }
  if (std::ferror(log->f) != 0) throw std::runtime_error("cannot read the log " + path.string());
  if (ftello(log->f) != whole) ++result.resyncs;
}

}  // namespace

struct LogWriter::Implementation {
  lcm_eventlog_t* log = nullptr;
  std::string channel;
  std::vector<char> buffer;  // glibc does not make one of the size asked for
};

LogWriter::LogWriter(const fs::path& path)
    : implementation_(std::make_unique<Implementation>()), path_(path) {
  if (fs::exists(path)) {
    throw std::runtime_error(path.string() + " exists: logs are never overwritten");
  }
  implementation_->log = lcm_eventlog_create(path.c_str(), "w");
  if (implementation_->log == nullptr) {
    throw std::runtime_error("cannot write the log " + path.string());
  }
  constexpr std::size_t kBuffer_bytes = 1U << 20U;
  implementation_->buffer.resize(kBuffer_bytes);
  std::setvbuf(implementation_->log->f, implementation_->buffer.data(), _IOFBF, kBuffer_bytes);
}

LogWriter::~LogWriter() { lcm_eventlog_destroy(implementation_->log); }

void LogWriter::write(const Packet& packet) {
  implementation_->channel = packet.channel;
  lcm_eventlog_event_t event{};
  event.timestamp = packet.received_utime;
  event.channellen = static_cast<std::int32_t>(packet.channel.size());
  event.datalen = static_cast<std::int32_t>(packet.data.size());
  event.channel = implementation_->channel.data();
  // LCM's struct has no const; it only reads.
  event.data = const_cast<std::uint8_t*>(packet.data.data());
  if (lcm_eventlog_write_event(implementation_->log, &event) != 0) fail();
}

void LogWriter::flush() {
  if (std::fflush(implementation_->log->f) != 0) fail();
}

void LogWriter::fail() const {
  throw std::runtime_error("cannot go on writing " + path_.string() +
                           ": the disk is full or gone; free some space");
}

LogReadResult readLog(const std::vector<fs::path>& files, const PacketHandler& handler) {
  LogReadResult result;
  for (const fs::path& path : files) readFile(path, handler, result);
  return result;
}

std::vector<fs::path> logSeries(const fs::path& first) {
  std::vector<fs::path> continued;
  const std::string prefix = first.filename().string() + ".";
  const fs::path folder = first.has_parent_path() ? first.parent_path() : fs::path(".");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool numbered =
        name.size() > prefix.size() && name.starts_with(prefix) &&
        std::all_of(name.begin() + static_cast<std::ptrdiff_t>(prefix.size()), name.end(),
                    [](unsigned char letter) { return letter >= '0' && letter <= '9'; });
    if (numbered) continued.push_back(entry.path());
  }
  // .100 comes after .99.
  std::sort(continued.begin(), continued.end(), [](const fs::path& a, const fs::path& b) {
    const std::string& left = a.native();
    const std::string& right = b.native();
    return left.size() != right.size() ? left.size() < right.size() : left < right;
  });
  std::vector<fs::path> files{first};
  files.insert(files.end(), continued.begin(), continued.end());
  return files;
}

}  // namespace lab
