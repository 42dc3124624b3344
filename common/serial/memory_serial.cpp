#include "common/serial/memory_serial.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <iterator>
#include <span>
#include <sstream>
#include <utility>

namespace lab {

/// State shared by both ends of a line.
struct MemorySerial::Line {
  struct End {
    bool there = false;
    bool told = false;  ///< whether a call of the callback is scheduled
    std::deque<std::uint8_t> waiting;
    /// Shared, because the callback may destroy the port that owns it.
    std::shared_ptr<Loop::Callback> callback;
  };

  Line(Loop& the_loop, std::string the_name) : loop(the_loop), name(std::move(the_name)) {}

  /// Schedules a call of an end's callback if it has bytes to read or the other end is gone.
  static void tell(const std::shared_ptr<Line>& line, End Line::*end) {
    End& reader = (*line).*end;
    if (reader.told || !reader.callback) return;
    if (reader.waiting.empty() && !line->goneFor(end)) return;
    reader.told = true;
    line->loop.soon([line, end] {
      End& now = (*line).*end;
      now.told = false;
      const std::shared_ptr<Loop::Callback> callback = now.callback;
      if (!callback || (now.waiting.empty() && !line->goneFor(end))) return;
      (*callback)();
      tell(line, end);
    });
  }

  /// Only the host is told that the other end is gone; a robot cannot detect an unplugged cable.
  [[nodiscard]] bool goneFor(End Line::*end) const { return end == &Line::host && !robot.there; }

  [[nodiscard]] std::size_t read(End& reader, std::span<std::uint8_t> bytes) {
    const std::size_t count = std::min(bytes.size(), reader.waiting.size());
    const auto last = reader.waiting.begin() + static_cast<std::ptrdiff_t>(count);
    std::copy(reader.waiting.begin(), last, bytes.begin());
    reader.waiting.erase(reader.waiting.begin(), last);
    return count;
  }

  [[nodiscard]] std::size_t write(End& reader, std::span<const std::uint8_t> bytes) {
    const std::size_t count = std::min(bytes.size(), kCapacity - reader.waiting.size());
    reader.waiting.insert(reader.waiting.end(), bytes.begin(),
                          bytes.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }

  Loop& loop;
  std::string name;
  End robot;
  End host;
};

class MemorySerial::RobotEnd final : public SerialPort {
 public:
  explicit RobotEnd(std::shared_ptr<Line> line) : line_(std::move(line)) {
    line_->robot.there = true;
  }
  ~RobotEnd() override {
    line_->robot = {};
    Line::tell(line_, &Line::host);
  }

  void onReadable(Loop::Callback callback) override {
    line_->robot.callback = std::make_shared<Loop::Callback>(std::move(callback));
    Line::tell(line_, &Line::robot);
  }
  std::size_t read(std::span<std::uint8_t> bytes) override {
    return line_->read(line_->robot, bytes);
  }
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    if (line_->host.there) static_cast<void>(line_->write(line_->host, bytes));
    Line::tell(line_, &Line::host);
    return bytes.size();
  }

 private:
  std::shared_ptr<Line> line_;
};

class MemorySerial::HostEnd final : public SerialPort {
 public:
  explicit HostEnd(std::shared_ptr<Line> line) : line_(std::move(line)) {
    line_->host.there = true;
    line_->robot.waiting.clear();
  }
  ~HostEnd() override { line_->host = {}; }

  void onReadable(Loop::Callback callback) override {
    line_->host.callback = std::make_shared<Loop::Callback>(std::move(callback));
    Line::tell(line_, &Line::host);
  }
  std::size_t read(std::span<std::uint8_t> bytes) override {
    if (!line_->robot.there) throw gone();
    return line_->read(line_->host, bytes);
  }
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    if (!line_->robot.there) throw gone();
    const std::size_t count = line_->write(line_->robot, bytes);
    Line::tell(line_, &Line::robot);
    return count;
  }

 private:
  [[nodiscard]] SerialError gone() const {
    return SerialError(line_->name + ": gone (unplugged or switched off)");
  }

  std::shared_ptr<Line> line_;
};

std::vector<std::string> MemorySerial::offered() const {
  std::vector<std::string> names;
  for (const auto& [name, entry] : lines_) {
    const std::shared_ptr<Line> line = entry.lock();
    if (line && line->robot.there) names.push_back(name);
  }
  return names;
}

std::vector<std::string> MemorySerial::matching(const std::string& pattern) const {
  std::istringstream words(pattern);
  const std::vector<std::string> patterns{std::istream_iterator<std::string>(words), {}};
  std::vector<std::string> names = offered();
  std::erase_if(names, [&patterns](const std::string& name) {
    return std::none_of(patterns.begin(), patterns.end(), [&name](const std::string& one) {
      return fnmatch(one.c_str(), name.c_str(), FNM_PATHNAME) == 0;
    });
  });
  return names;
}

std::unique_ptr<SerialPort> MemorySerial::open(const std::string& path, int) {
  const auto entry = lines_.find(path);
  const std::shared_ptr<Line> line = entry == lines_.end() ? nullptr : entry->second.lock();
  if (!line || !line->robot.there)
    throw SerialError(path + ": not there; is the robot plugged in?");
  if (line->host.there) throw SerialError(path + ": in use by this process; open it once");
  return std::make_unique<HostEnd>(line);
}

std::unique_ptr<SerialPort> MemorySerial::offer(const std::string& name) {
  std::weak_ptr<Line>& entry = lines_[name];
  if (const std::shared_ptr<Line> old = entry.lock(); old && old->robot.there) {
    throw SerialError(name + ": a line of this name is offered already; take another name");
  }
  auto line = std::make_shared<Line>(loop_, name);
  entry = line;
  return std::make_unique<RobotEnd>(std::move(line));
}

}  // namespace lab
