#include "robot_bridge/lines/port_manager.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>
#include <vector>

namespace lab::bridge {
namespace {

constexpr std::int64_t kScanPeriod_us = 500'000;
constexpr std::int64_t kShortestBackOff_us = 100'000;
constexpr std::int64_t kLongestBackOff_us = 2'000'000;
constexpr std::int64_t kLeaveAlone_us = 10'000'000;  // a line without a robot of the experiment
// A robot that was silent for so long on one line may be taken over by another line.
constexpr std::int64_t kAbandoned_us = 1'000'000;

}  // namespace

PortManager::PortManager(Loop& loop, SerialPorts& ports, PortSettings settings, Robots robots,
                         Note note)
    : loop_(loop),
      ports_(ports),
      settings_(std::move(settings)),
      robots_(std::move(robots)),
      note_(std::move(note)) {}

PortManager::~PortManager() {
  for (auto& [path, line] : lines_) {
    if (line.robot != nullptr) line.robot->unplug();
  }
}

void PortManager::tick() {
  const std::int64_t now = loop_.now();
  if (now - scan_utime_ >= kScanPeriod_us) scan(now);
  for (Entry& entry : lines_) {
    Line& line = entry.second;
    if (!line.port) {
      if (line.found && now >= line.retry_utime) open(entry, now);
      continue;
    }
    // After a stall of this machine, answers may be waiting; read them before timeouts are checked.
    read(entry);
    if (!line.port) continue;
    line.session->tick(now);
    if (line.robot != nullptr) line.robot->tick(now);
    closeIfUnusable(entry, now);
    write(entry);
  }
}

void PortManager::flush() {
  for (Entry& entry : lines_) write(entry);
}

void PortManager::scan(std::int64_t now) {
  scan_utime_ = now;
  std::set<std::string> found;
  if (settings_.offered) {
    for (std::string& path : ports_.offered()) found.insert(std::move(path));
  }
  if (!settings_.patterns.empty()) {
    for (std::string& path : ports_.matching(settings_.patterns)) found.insert(std::move(path));
  }
  std::erase_if(lines_, [&found](const Entry& entry) {
    return !entry.second.port && !found.contains(entry.first);
  });
  for (const std::string& path : found) lines_[path].found = true;
}

void PortManager::open(Entry& entry, std::int64_t now) {
  Line& line = entry.second;
  line.back_off_us = std::clamp(2 * line.back_off_us, kShortestBackOff_us, kLongestBackOff_us);
  line.retry_utime = now + line.back_off_us;
  try {
    line.port = ports_.open(entry.first, settings_.baud);
  } catch (const SerialError& error) {
    reportFault(entry, "open", error.what());
    return;
  }
  line.session.emplace(now);
  line.refusal.clear();
  line.port->onReadable([this, &entry] { read(entry); });
}

void PortManager::read(Entry& entry) {
  Line& line = entry.second;
  const std::int64_t now = loop_.now();
  std::array<std::uint8_t, 512> bytes;
  try {
    while (const std::size_t count = line.port->read(bytes)) {
      const std::int64_t errors = line.session->errors();
      line.session->receive({bytes.data(), count}, now,
                            [&](const wire::Frame& frame) { handle(entry, frame, now); });
      if (line.robot != nullptr) line.robot->noteErrors(line.session->errors() - errors);
      if (count < bytes.size()) break;
    }
  } catch (const SerialError& error) {
    handleLoss(entry, error.what());
    return;
  }
  closeIfUnusable(entry, now);
  write(entry);
}

void PortManager::handle(Entry& entry, const wire::Frame& frame, std::int64_t now) {
  Line& line = entry.second;
  if (!line.refusal.empty()) return;
  wire::Hello hello;
  const bool is_hello = wire::unpack(frame, hello);
  if (line.robot != nullptr && is_hello && hello.uid != line.robot->hello()->uid) {
    line.robot->unplug();  // the board was exchanged
    line.robot = nullptr;
  }
  if (line.robot != nullptr) {
    line.robot->receive(frame, now);
  } else if (is_hello) {
    attachRobot(entry, hello, now);
  }
}

void PortManager::attachRobot(Entry& entry, const wire::Hello& hello, std::int64_t now) {
  Line& line = entry.second;
  const auto found = robots_.find(hello.uid);
  if (found == robots_.end()) {
    line.refusal = hello.uid == 0
                       ? std::string("a robot without uid; give it one: robot_bridge --set-uid")
                       : fmt::format(
                             "a robot with uid {}, which is not in the experiment; add [[robots]] "
                             "body = \"serial\", uid = {}, or unplug it",
                             hello.uid, hello.uid);
    return;
  }
  RobotLink& robot = *found->second;
  if (Entry* other = lineWith(robot)) {
    if (now - robot.heardUtime() <= kAbandoned_us) {
      line.refusal = fmt::format(
          "uid {} of robot {}, which is on {} already; unplug one of the two, or store another uid "
          "in it",
          hello.uid, robot.settings().id, other->first);
      return;
    }
    close(*other, now + kLongestBackOff_us);  // it was unplugged there, which is noticed only now
  }
  line.robot = &robot;
  line.back_off_us = 0;
  line.last_fault.clear();
  robot.plug(hello, now);
}

/// Closes a line that has no robot of this experiment.
void PortManager::closeIfUnusable(Entry& entry, std::int64_t now) {
  Line& line = entry.second;
  if (!line.port) return;
  if (!line.refusal.empty()) {
    reportFault(entry, line.refusal, entry.first + ": " + line.refusal);
    close(entry, now + kLeaveAlone_us);
    return;
  }
  using Verdict = LineSession::Verdict;
  const Verdict verdict = line.session->verdict();
  if (verdict == Verdict::kWaiting || verdict == Verdict::kRobot) return;
  reportFault(entry, "verdict " + std::to_string(static_cast<int>(verdict)),
              entry.first + ": " + line.session->reason(settings_.baud));
  close(entry, now + kLeaveAlone_us);
}

void PortManager::write(Entry& entry) {
  Line& line = entry.second;
  if (!line.port) return;
  const auto pass = [&line](std::vector<std::uint8_t>& bytes) {
    // Bytes that the line does not accept are dropped; the protocol repeats lost messages.
    if (!bytes.empty()) static_cast<void>(line.port->write(bytes));
    bytes.clear();
  };
  try {
    pass(line.session->outgoing());
    if (line.robot != nullptr) pass(line.robot->outgoing());
  } catch (const SerialError& error) {
    handleLoss(entry, error.what());
  }
}

void PortManager::close(Entry& entry, std::int64_t retry_utime) {
  Line& line = entry.second;
  if (line.robot != nullptr) line.robot->unplug();
  line.robot = nullptr;
  line.port.reset();
  line.session.reset();
  line.refusal.clear();
  line.retry_utime = retry_utime;
}

void PortManager::handleLoss(Entry& entry, const std::string& why) {
  Line& line = entry.second;
  const std::string robot_text =
      line.robot == nullptr ? "" : fmt::format("; robot {} was on it", line.robot->settings().id);
  reportFault(entry, "lost", why + robot_text);
  line.last_fault.clear();  // the next loss is another one
  line.found = false;
  const std::int64_t retry_utime = loop_.now() + std::max(line.back_off_us, kShortestBackOff_us);
  scan_utime_ = std::min(scan_utime_, retry_utime - kScanPeriod_us);
  close(entry, retry_utime);
}

void PortManager::reportFault(Entry& entry, const std::string& kind, const std::string& text) {
  if (entry.second.last_fault == kind) return;
  entry.second.last_fault = kind;
  note_(text);
}

PortManager::Entry* PortManager::lineWith(const RobotLink& robot) {
  const auto found = std::find_if(lines_.begin(), lines_.end(), [&robot](const Entry& entry) {
    return entry.second.robot == &robot;
  });
  return found == lines_.end() ? nullptr : &*found;
}

std::string PortManager::lineOf(const RobotLink& robot) const {
  for (const auto& [path, line] : lines_) {
    if (line.robot == &robot) return path;
  }
  return {};
}

}  // namespace lab::bridge
