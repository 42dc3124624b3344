#include "runner/export/csv_export.hpp"

#include <fmt/format.h>

#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <lab/experiment_event_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/message_values.hpp"
#include "common/bus/received_message.hpp"
#include "common/math/units.hpp"
#include "common/schema/array_groups.hpp"
#include "common/schema/log_tables.hpp"
#include "common/schema/message_table.hpp"

namespace lab::runner {
namespace fs = std::filesystem;
namespace {

using schema::Kind;

constexpr std::size_t kRows = 4096;  // that are collected before they are written
constexpr const char* kColumns = "columns";
constexpr double kMissingRow = 20;  // bytes, about: 1,inf,inf,inf,0.04,1

/// RFC 4180.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string field = "\"";
  for (const char letter : text) {
    if (letter == '"') field += '"';
    field += letter;
  }
  return field + "\"";
}

class CsvFile {
 public:
  explicit CsvFile(fs::path path) : path_(std::move(path)), file_(path_, std::ios::binary) {
    if (file_.is_open()) return;
    throw std::runtime_error("cannot make " + path_.string() + ": " +
                             std::generic_category().message(errno));
  }

  fmt::memory_buffer& buffer() { return buffer_; }

  void endRow() {
    buffer_.push_back('\n');
    constexpr std::size_t kBuffer_bytes = 1U << 18U;
    if (buffer_.size() >= kBuffer_bytes) flush();
  }

  void flush() {
    file_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    file_.flush();
    buffer_.clear();
    if (!file_) throw std::runtime_error("cannot write " + path_.string() + ": is the disk full?");
  }

 private:
  fs::path path_;
  std::ofstream file_;
  fmt::memory_buffer buffer_;
};

template <class Number>
Number numberAt(const std::byte* at) {
  Number value{};
  std::memcpy(&value, at, sizeof value);
  return value;
}

/// Appends a value as text: of floating-point numbers the shortest that is read back exactly.
void append(fmt::memory_buffer& out, const schema::Column& column, std::size_t row) {
  const std::byte* at = column.values.data() + row * column.itemSize();
  const auto to = std::back_inserter(out);
  switch (column.kind) {
    case Kind::kBoolean:
    case Kind::kByte:
      fmt::format_to(to, "{}", numberAt<std::uint8_t>(at));
      break;
    case Kind::kInt8:
      fmt::format_to(to, "{}", numberAt<std::int8_t>(at));
      break;
    case Kind::kInt16:
      fmt::format_to(to, "{}", numberAt<std::int16_t>(at));
      break;
    case Kind::kInt32:
      fmt::format_to(to, "{}", numberAt<std::int32_t>(at));
      break;
    case Kind::kInt64:
      fmt::format_to(to, "{}", numberAt<std::int64_t>(at));
      break;
    case Kind::kFloat:
      fmt::format_to(to, "{}", numberAt<float>(at));
      break;
    case Kind::kDouble:
      fmt::format_to(to, "{}", numberAt<double>(at));
      break;
    default:
      fmt::format_to(
          to, "{}",
          quoted(column.texts.texts()[static_cast<std::size_t>(numberAt<std::int32_t>(at))]));
  }
}

class TableFile {
 public:
  TableFile(const fs::path& folder, const schema::LoggedChannel& logged, const std::string& path)
      : name_(tableTitle(logged.channel, path)),
        table_(*logged.type, path),
        file_(folder / (name_ + ".csv")) {
    const char* separator = "";
    for (const schema::Column& column : table_.columns()) {
      fmt::format_to(std::back_inserter(file_.buffer()), "{}{}", separator, column.name);
      separator = ",";
    }
    file_.endRow();
  }

  bool take(std::int64_t event, const Packet& packet) {
    if (!table_.take(event, packet.received_utime, packet.data)) return false;
    if (table_.rows() >= kRows) writeRows();
    return true;
  }

  void finish() {
    writeRows();
    file_.flush();
  }

  void describe(CsvFile& columns) const {
    for (const schema::Column& column : table_.columns()) {
      fmt::format_to(std::back_inserter(columns.buffer()), "{},{},{},{}", name_, column.name,
                     quoted(column.unit), quoted(column.comment));
      columns.endRow();
    }
  }

 private:
  void writeRows() {
    for (std::size_t row = 0; row < table_.rows(); ++row) {
      bool first = true;
      for (const schema::Column& column : table_.columns()) {
        if (!first) file_.buffer().push_back(',');
        first = false;
        append(file_.buffer(), column, row);
      }
      file_.endRow();
    }
    table_.clear();
  }

  std::string name_;
  schema::MessageTable table_;
  CsvFile file_;
};

/// Calls `take` with every camera frame, without poses that have impossible numbers.
template <class Take>
void readFrames(const std::vector<fs::path>& log, const Take& take) {
  readLog(log, [&](const Packet& packet) {
    if (packet.channel != channels::kTrackedFrame) return;
    const auto frame = receive<tracked_frame_t>(packet);
    if (frame->decoded && (!frame->removed || frame->removed->usable)) take(frame->message);
  });
}

/// @throws std::runtime_error if a folder has not the room for so many bytes
void requireRoom(const fs::path& folder, double bytes, double have) {
  if (have >= bytes) return;
  throw std::runtime_error(fmt::format(
      "too little disk in {}: the files of the robots need about {:.0f} MB, {:.0f} MB are free; "
      "make room, or choose another folder with --out",
      folder.string(), bytes / 1e6, have / 1e6));
}

/// The files of some robots, each with a row per frame.
void writeTrexOf(const std::set<std::int32_t>& robots, const std::vector<fs::path>& log,
                 std::int64_t zero, const std::function<fs::path(std::int32_t)>& path) {
  std::map<std::int32_t, std::unique_ptr<CsvFile>> files;
  for (const std::int32_t id : robots) {
    files[id] = std::make_unique<CsvFile>(path(id));
    fmt::format_to(std::back_inserter(files[id]->buffer()),
                   "frame,X#wcentroid (cm),Y#wcentroid (cm),ANGLE,time,missing");
    files[id]->endRow();
  }
  readFrames(log, [&](const tracked_frame_t& frame) {
    const double time = units::seconds(frame.utime - zero);
    std::set<std::int32_t> missing = robots;
    for (const tracked_pose_t& pose : frame.robots) {
      if (missing.erase(pose.robot_id) == 0) continue;  // of other files, or twice in a frame
      CsvFile& csv = *files.at(pose.robot_id);
      fmt::format_to(std::back_inserter(csv.buffer()), "{},{},{},{},{},0", frame.frame,
                     pose.x / units::kCentimetre, pose.y / units::kCentimetre, pose.theta, time);
      csv.endRow();
    }
    for (const std::int32_t id : missing) {
      CsvFile& csv = *files.at(id);
      fmt::format_to(std::back_inserter(csv.buffer()), "{},inf,inf,inf,{},1", frame.frame, time);
      csv.endRow();
    }
  });
  for (const auto& [id, file] : files) file->flush();
}

}  // namespace

std::int64_t timeZero(const std::vector<fs::path>& log) {
  std::int64_t step = 0;
  std::int64_t start = 0;
  std::int64_t frame = 0;
  std::int64_t message = 0;
  readLog(log, [&](const Packet& packet) {
    if (message == 0) message = packet.received_utime;
    if (packet.channel == channels::kExperimentEvent) {
      experiment_event_t event{};
      if (!decode(packet.data, event) || impossibleValue(event)) return;
      if (event.kind == experiment_event_t::START && start == 0) start = event.utime;
      if (event.kind == experiment_event_t::STEP && event.step == 0) step = event.commanded_utime;
    } else if (packet.channel == channels::kTrackedFrame && frame == 0) {
      tracked_frame_t first{};
      if (decode(packet.data, first) && !impossibleHeader(packet.channel, first.utime, first.seq)) {
        frame = first.utime;
      }
    }
  });
  for (const std::int64_t utime : {step, start, frame}) {
    if (utime != 0) return utime;
  }
  return message;
}

LeftOut writeCsv(const std::vector<fs::path>& log, const fs::path& folder) {
  TableChannels channels = tableChannels(schema::LogIndex(log), {kColumns});
  LeftOut left_out = std::move(channels.left_out);
  std::map<std::string, std::vector<std::unique_ptr<TableFile>>, std::less<>> tables;
  for (const schema::LoggedChannel& logged : channels.kept) {
    for (const std::string& path : schema::tablePaths(*logged.type)) {
      tables[logged.channel].push_back(std::make_unique<TableFile>(folder, logged, path));
    }
  }
  std::int64_t number = 0;
  readLog(log, [&](const Packet& packet) {
    const std::int64_t event = number++;
    const auto found = tables.find(packet.channel);
    bool taken = found != tables.end();
    if (taken) {
      for (const auto& table : found->second) taken = table->take(event, packet) && taken;
    }
    if (!taken) left_out.count(packet.channel);
  });
  CsvFile columns(folder / fmt::format("{}.csv", kColumns));
  fmt::format_to(std::back_inserter(columns.buffer()), "table,column,unit,description");
  columns.endRow();
  for (const auto& [channel, files] : tables) {
    for (const auto& table : files) {
      table->finish();
      table->describe(columns);
    }
  }
  columns.flush();
  return left_out;
}

void writeTrackpy(const std::vector<fs::path>& log, const fs::path& file) {
  const std::int64_t zero = timeZero(log);
  CsvFile csv(file);
  fmt::format_to(std::back_inserter(csv.buffer()), "frame,particle,x,y,t,theta");
  csv.endRow();
  readFrames(log, [&](const tracked_frame_t& frame) {
    for (const tracked_pose_t& pose : frame.robots) {
      fmt::format_to(std::back_inserter(csv.buffer()), "{},{},{},{},{},{}", frame.frame,
                     pose.robot_id, pose.x / units::kCentimetre, pose.y / units::kCentimetre,
                     units::seconds(frame.utime - zero), pose.theta);
      csv.endRow();
    }
  });
  csv.flush();
}

void writeTrex(const std::vector<fs::path>& log, const fs::path& folder, const std::string& name,
               std::optional<double> free_bytes) {
  const std::int64_t zero = timeZero(log);
  std::set<std::int32_t> ids;
  double frames = 0;
  readFrames(log, [&](const tracked_frame_t& frame) {
    ++frames;
    for (const tracked_pose_t& pose : frame.robots) ids.insert(pose.robot_id);
  });
  const double have = free_bytes.value_or(static_cast<double>(fs::space(folder).available));
  requireRoom(folder, frames * static_cast<double>(ids.size()) * kMissingRow, have);
  // A file per robot is open: a process may have 1024 of them.
  constexpr std::size_t kMostFiles = 500;
  while (!ids.empty()) {
    std::set<std::int32_t> robots;
    while (!ids.empty() && robots.size() < kMostFiles) robots.insert(ids.extract(ids.begin()));
    writeTrexOf(robots, log, zero,
                [&](std::int32_t id) { return folder / fmt::format("{}_id{}.csv", name, id); });
  }
}

}  // namespace lab::runner
