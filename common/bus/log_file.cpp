#include "common/bus/log_file.hpp"

#include <lcm/lcm.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/contract_upgrade.hpp"
#include "common/bus/value_checker.hpp"
#include "common/files/file_text.hpp"
#include "common/files/mapped_file.hpp"

namespace lab {
namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kSync = 0xEDA1DA01;
/// The header of an event holds a sync word, its number, its time and two lengths, big-endian.
constexpr std::size_t kHeader_bytes = 28;
constexpr std::size_t kTime_at = 12;
constexpr std::size_t kChannelLength_at = 20;
constexpr std::size_t kDataLength_at = 24;
constexpr std::int32_t kLongestChannel = 999;  // the limit of LCM's own reader

template <class Integer>
Integer bigEndian(Bytes file, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(Integer); ++i) value = (value << 8U) | file[at + i];
  return static_cast<Integer>(value);
}

bool syncAt(Bytes file, std::size_t at) { return bigEndian<std::uint32_t>(file, at) == kSync; }

/// The position of the first sync word at or after `at`; the file's size if there is none.
std::size_t findEvent(Bytes file, std::size_t at) {
  for (; at + sizeof kSync <= file.size(); ++at) {
    if (syncAt(file, at)) return at;
  }
  return file.size();
}

struct Event {
  std::string_view channel;
  Bytes data;
  std::int64_t utime = 0;
  std::size_t end = 0;  ///< position in the file after the event
};

/// The event that begins at a sync word.
/// @return nothing if its lengths are impossible, or if neither a sync word nor the end of the file
///   follows it
std::optional<Event> eventAt(Bytes file, std::size_t at) {
  if (file.size() - at < kHeader_bytes) return std::nullopt;
  const auto channel_length = bigEndian<std::int32_t>(file, at + kChannelLength_at);
  const auto data_length = bigEndian<std::int32_t>(file, at + kDataLength_at);
  if (channel_length <= 0 || channel_length > kLongestChannel || data_length < 0) {
    return std::nullopt;
  }
  const std::size_t channel_at = at + kHeader_bytes;
  const std::size_t data_at = channel_at + static_cast<std::size_t>(channel_length);
  const std::size_t end = data_at + static_cast<std::size_t>(data_length);
  if (end > file.size()) return std::nullopt;
  if (end + sizeof kSync <= file.size() && !syncAt(file, end)) return std::nullopt;
  const Bytes channel = file.subspan(channel_at, data_at - channel_at);
  return Event{{reinterpret_cast<const char*>(channel.data()), channel.size()},
               file.subspan(data_at, end - data_at),
               bigEndian<std::int64_t>(file, at + kTime_at),
               end};
}

/// The whole events of a file, one after the other.
class EventReader {
 public:
  explicit EventReader(Bytes file) : file_(file), at_(findEvent(file, 0)) {}

  /// @return nothing at the end of the file
  std::optional<Event> next() {
    while (at_ < file_.size()) {
      const std::optional<Event> event = eventAt(file_, at_);
      if (!event) {
        at_ = findEvent(file_, at_ + 1);
        continue;
      }
      if (at_ != whole_) ++resyncs_;
      whole_ = event->end;
      at_ = findEvent(file_, whole_);
      if (event->channel != channels::kLcmSelfTest) return event;
    }
    if (whole_ != file_.size()) ++resyncs_;
    whole_ = file_.size();
    return std::nullopt;
  }

  [[nodiscard]] std::int64_t resyncs() const { return resyncs_; }

 private:
  Bytes file_;
  std::size_t at_;
  std::size_t whole_ = 0;  ///< the end of the last whole event
  std::int64_t resyncs_ = 0;
};

/// The times of arrival of a log's events. A time is damaged if it is far from that of the event
/// before, and farther from that of the event after than these two are from each other. A step that
/// is none is a silence of the bus, or one of the logger's clock.
class ArrivalTimes {
 public:
  /// @param following the next events, at least two where the file has them
  /// @return the time of the event, or of one beside it if its own is damaged
  std::int64_t of(const Event& event, std::span<const Event> following, LogReadResult& result) {
    if (!before_ && !following.empty()) before_ = firstBefore(event, following);
    if (isPossible(event.utime) && fits(event.utime, following)) {
      before_ = event.utime;
    } else {
      ++result.bad_times;
    }
    return before_.value_or(0);
  }

 private:
  static constexpr std::int64_t kNear_us = 10'000'000;
  static constexpr std::int64_t kLongestSilence_us = 3'600'000'000;

  static bool isPossible(std::int64_t utime) {
    return utime >= 0 && utime <= ValueChecker::kLatestUtime;
  }

  /// The time that stands for the event before the first one.
  static std::optional<std::int64_t> firstBefore(const Event& event,
                                                 std::span<const Event> following) {
    const std::int64_t next = following.front().utime;
    if (following.size() < 2 || !isPossible(next) || !isPossible(following[1].utime) ||
        std::abs(following[1].utime - next) > kNear_us) {
      return std::nullopt;
    }
    const bool far = !isPossible(event.utime) || std::abs(event.utime - next) > kLongestSilence_us;
    return far ? std::optional(next) : std::nullopt;
  }

  [[nodiscard]] bool fits(std::int64_t utime, std::span<const Event> following) const {
    if (!before_ || std::abs(utime - *before_) <= kNear_us) return true;
    if (following.empty() || !isPossible(following.front().utime)) {
      return utime > *before_ && utime - *before_ <= kLongestSilence_us;
    }
    const std::int64_t next = following.front().utime;
    return std::abs(next - utime) <= std::abs(next - *before_);
  }

  std::optional<std::int64_t> before_;
};

}  // namespace

struct LogWriter::Implementation {
  lcm_eventlog_t* log = nullptr;
  std::string channel;
  std::vector<char> buffer;  // setvbuf(): glibc ignores the size without a buffer
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
  // LCM only reads the data, but its struct has no const.
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

class LogReader::Implementation {
 public:
  explicit Implementation(std::vector<fs::path> files) : files_(std::move(files)) {}

  std::optional<Packet> next() {
    while (true) {
      if (!file_) {
        if (opened_ == files_.size()) return std::nullopt;
        file_ = std::make_unique<File>(files_[opened_++]);
      }
      if (const std::optional<Packet> packet = nextOf(*file_)) return packet;
      file_->mapped.requireWhole();
      result_.resyncs += file_->reader.resyncs();
      file_.reset();
    }
  }

  [[nodiscard]] const LogReadResult& result() const { return result_; }
  [[nodiscard]] const LogPosition& position() const { return position_; }

 private:
  struct File {
    explicit File(const fs::path& path) : mapped(path, "log"), reader(mapped.bytes()) {}
    MappedFile mapped;
    EventReader reader;
    std::vector<Event> ahead;
  };

  std::optional<Packet> nextOf(File& file) {
    constexpr std::size_t kAhead = 2;  // events that are read before one is handled
    while (file.ahead.size() <= kAhead) {
      const std::optional<Event> event = file.reader.next();
      if (!event) break;
      file.ahead.push_back(*event);
    }
    if (file.ahead.empty()) return std::nullopt;
    const Event event = file.ahead.front();
    file.ahead.erase(file.ahead.begin());
    ++result_.events;
    position_ = {opened_ - 1,
                 static_cast<std::uint64_t>(event.data.data() - file.mapped.bytes().data()),
                 event.data.size()};
    const std::int64_t utime = times_.of(event, file.ahead, result_);
    file.mapped.release(event.data.data());
    newer_ = upgraded(event.data);
    return Packet{event.channel, newer_ ? Bytes(*newer_) : event.data, utime};
  }

  std::vector<fs::path> files_;
  std::size_t opened_ = 0;
  std::unique_ptr<File> file_;
  ArrivalTimes times_;
  std::optional<std::vector<std::uint8_t>> newer_;
  LogReadResult result_;
  LogPosition position_;
};

LogReader::LogReader(std::vector<fs::path> files)
    : implementation_(std::make_unique<Implementation>(std::move(files))) {}
LogReader::~LogReader() = default;
std::optional<Packet> LogReader::next() { return implementation_->next(); }
const LogReadResult& LogReader::result() const { return implementation_->result(); }
const LogPosition& LogReader::position() const { return implementation_->position(); }

LogReadResult readLog(const std::vector<fs::path>& files, const PacketHandler& handler) {
  LogReader reader(files);
  while (const std::optional<Packet> packet = reader.next()) handler(*packet);
  return reader.result();
}

bool isLog(const fs::path& file) {
  if (!regularFileProblem(file, file_kinds::kLog).empty()) return false;
  std::vector<std::uint8_t> head(1U << 16U);
  std::ifstream stream(file, std::ios::binary);
  stream.read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(stream.gcount()));
  return findEvent(head, 0) < head.size();
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
