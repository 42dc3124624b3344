#include "dashboard/health/advice.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/bus/channels.hpp"
#include "common/math/units.hpp"
#include "common/process/version.hpp"

namespace lab::dashboard {
namespace {

using Level = Advice::Level;

constexpr std::int64_t kSilentBus_us = 3'000'000;
constexpr std::int64_t kSilentRobot_us = 1'000'000;
constexpr std::int64_t kSilentLight_us = 2'000'000;
constexpr std::int64_t kTwoSenders_us = 2'000'000;
constexpr std::int32_t kManyErrors = 20;  // frames in 10 s
constexpr std::size_t kMaxNamed = 12;

/// Robots with the same problem, which share one text.
class Group {
 public:
  void add(std::int32_t id) { ids_.push_back(id); }
  void report(std::vector<Advice>& out, Level level, const std::string& what,
              const std::string& remedy) const {
    if (ids_.empty()) return;
    std::string names;
    for (std::size_t i = 0; i < std::min(ids_.size(), kMaxNamed); ++i) {
      names += (i == 0 ? "" : ", ") + std::to_string(ids_[i]);
    }
    if (ids_.size() > kMaxNamed) names += fmt::format(" and {} more", ids_.size() - kMaxNamed);
    out.push_back({level, fmt::format("robot {}: {}", names, what), remedy});
  }

 private:
  std::vector<std::int32_t> ids_;
};

std::string serviceName(const ServiceRow& row) {
  const service_status_t& status = row.status;
  return status.host.empty() ? status.sender : fmt::format("{} on {}", status.sender, status.host);
}

void adviseOnServices(const AdviceFacts& facts, std::vector<Advice>& out) {
  for (const auto& [key, row] : facts.health.services()) {
    const service_status_t& status = row.status;
    if (status.contract_version != kContractVersion) {
      out.push_back({Level::kError,
                     fmt::format("{} uses message contract {}, this page {}", serviceName(row),
                                 status.contract_version, kContractVersion),
                     "use programs of one build on all hosts, then start the lab again"});
    }
    if (row.hasEnded()) continue;
    const double silent = units::seconds(facts.now - row.heard_utime);
    if (facts.now - row.heard_utime > HealthView::kSilent_us && facts.isLive()) {
      out.push_back({Level::kError,
                     fmt::format("no message from {} for {:.0f} s", serviceName(row), silent),
                     fmt::format("the lab restarts services that have ended; if it stays silent, "
                                 "read logs/{}.txt in the run's folder, or end the run",
                                 status.sender)});
    } else if (status.state == service_status_t::FAULT) {
      out.push_back(
          {Level::kError, fmt::format("{} has a fault: {}", serviceName(row), status.last_error),
           fmt::format("repair the named cause; details are in logs/{}.txt in the run's folder",
                       status.sender)});
    } else if (!status.last_error.empty()) {
      out.push_back({Level::kWarn,
                     fmt::format("{} reports: {}", serviceName(row), status.last_error),
                     "the run continues, with a fault in its record; repair the named cause"});
    }
    if (row.starts > 1) {
      out.push_back({Level::kWarn,
                     fmt::format("{} has been started {} times", serviceName(row), row.starts),
                     fmt::format("logs/{}.txt in the run's folder has the reason", status.sender)});
    }
  }
}

void adviseOnStreams(const AdviceFacts& facts, std::vector<Advice>& out) {
  for (const auto& [channel, messages] : facts.health.notUnderstood()) {
    out.push_back(
        {Level::kError,
         fmt::format("{} messages on {} have another contract or are damaged", messages, channel),
         "a program on this bus has another version: end it, or give this lab its own port "
         "([network] port)"});
  }
  for (const auto& [key, row] : facts.health.streams()) {
    if (row.new_losses <= 0 || facts.run_info.replay()) continue;
    out.push_back(
        {Level::kWarn,
         fmt::format("{} messages on {} from {} were lost in the last seconds", row.new_losses,
                     key.channel, key.sender),
         "the host is overloaded or its receive buffers are small: lab doctor explains how "
         "to enlarge them"});
  }
  for (const auto& [sender, ahead] : facts.health.ahead()) {
    out.push_back({Level::kError,
                   fmt::format("the clock of {} is {:.1f} s ahead of this host's", sender, ahead),
                   "set the clocks of all hosts by NTP or PTP; a clock that jumps makes measured "
                   "delays wrong"});
  }
}

void adviseOnRobots(const AdviceFacts& facts, std::vector<Advice>& out) {
  Group missing, silent, two_senders, rejected, lease, saturated, battery, errors;
  for (const RobotSpec& robot : facts.run_info.experiment().robots) {
    const auto row = facts.robots.rows().find(robot.id);
    const bool heard = row != facts.robots.rows().end() && !row->second.sender.empty();
    if (!heard && facts.isLive()) missing.add(robot.id);
  }
  for (const auto& [id, row] : facts.robots.rows()) {
    if (row.sender.empty()) continue;
    const bool is_silent = facts.now - row.status_utime > kSilentRobot_us;
    if (is_silent && facts.isLive()) silent.add(id);
    if (is_silent) continue;
    if (row.other_sender_utime != 0 && facts.now - row.other_sender_utime < kTwoSenders_us) {
      two_senders.add(id);
    }
    const auto says = [&row = row](std::int32_t flag) { return (row.state.flags & flag) != 0; };
    if (says(robot_state_t::FLAG_REJECTED)) rejected.add(id);
    if (says(robot_state_t::FLAG_LEASE_EXPIRED) && facts.isLive()) lease.add(id);
    if (says(robot_state_t::FLAG_SATURATED)) saturated.add(id);
    if (row.batteryIsLow()) battery.add(id);
    if (row.recent_errors >= kManyErrors) errors.add(id);
  }
  two_senders.report(out, Level::kError, "two services report its state",
                     "end one of them, or give one of two robots another id");
  missing.report(out, Level::kError, "no status received",
                 "switch it on and check its serial connection; lab doctor lists the serial ports");
  silent.report(out, Level::kError, "does not respond any more",
                "check its battery and its connection; it stops by itself when its lease expires");
  rejected.report(out, Level::kError, "rejected its last command",
                  "the reason is under Health, at the service that controls the robot");
  lease.report(out, Level::kWarn, "stopped because its lease expired without a command",
               "it continues with the next command; if none comes, check that the lab is running");
  battery.report(out, Level::kWarn, "battery is low", "charge it");
  errors.report(out, Level::kWarn, "many corrupted frames on its connection",
                "try another cable or radio channel, away from motors");
  saturated.report(out, Level::kInfo, "a wheel speed, or a result of its program, is limited",
                   "reduce the program's speed or noise, and see the warnings of ./lab check: the "
                   "robot does not "
                   "follow its exact law now");
}

void adviseOnTracker(const AdviceFacts& facts, std::vector<Advice>& out) {
  const auto& tracker = facts.health.tracker();
  if (!tracker || facts.ended) return;
  if (tracker->state == tracker_status_t::GONE) {
    out.push_back({Level::kError, "the camera is disconnected: " + tracker->trouble,
                   "connect it again; the tracker continues by itself"});
  } else if (!tracker->trouble.empty()) {
    out.push_back({Level::kError, "tracker: " + tracker->trouble, "the Camera panel has details"});
  }
  if (tracker->moved != 0) {
    out.push_back({Level::kError, "the camera has moved since its calibration",
                   "end the run, fix the camera and calibrate it again: lab calibrate camera"});
  }
  if (!tracker->warning.empty()) out.push_back({Level::kWarn, "tracker: " + tracker->warning, ""});
  if (facts.health.newDark() > 0) {
    out.push_back({Level::kWarn, "pictures are too dark to detect robots",
                   "open the aperture or increase the exposure time ([camera] exposure_ms)"});
  }
  if (facts.health.newSaturated() > 0) {
    out.push_back({Level::kWarn, "too many pixels of the pictures are saturated",
                   "close the aperture or reduce the exposure time ([camera] exposure_ms)"});
  }
}

void adviseOnLight(const AdviceFacts& facts, std::vector<Advice>& out) {
  if (!facts.light || facts.ended) return;
  if (facts.isLive() && facts.now - facts.light_utime > kSilentLight_us) {
    out.push_back({Level::kError, "no status from the projector",
                   "read logs/projector_ctl.txt in the run's folder"});
    return;
  }
  if (!facts.light->trouble.empty()) {
    out.push_back({Level::kError, "projector: " + facts.light->trouble,
                   "until that is repaired, the projected light is not the commanded one"});
  }
  if (!facts.light->last_refusal.empty()) {
    out.push_back({Level::kWarn,
                   "the projector rejected a light command: " + facts.light->last_refusal,
                   "correct the light and send it again"});
  }
}

void adviseOnLinks(const AdviceFacts& facts, std::vector<Advice>& out) {
  for (const auto& [host, link] : facts.health.links()) {
    for (const link_peer_t& peer : link.peers) {
      if (peer.state == link_peer_t::REFUSED) {
        out.push_back({Level::kError,
                       fmt::format("{} refuses the link to {}: {}", host, peer.host, peer.trouble),
                       "set both clocks by NTP or PTP, and use the same version on both hosts"});
      } else if (peer.state == link_peer_t::SILENT && facts.isLive()) {
        out.push_back({Level::kError, fmt::format("{} receives nothing from {}", host, peer.host),
                       "check the cable, the host and its dds_gateway"});
      }
    }
  }
}

const char* levelName(Level level) {
  switch (level) {
    case Level::kError:
      return "error";
    case Level::kWarn:
      return "warn";
    case Level::kInfo:
      return "info";
  }
  return "";
}

}  // namespace

std::vector<Advice> adviceOn(const AdviceFacts& facts) {
  std::vector<Advice> out;
  if (facts.bus_utime == 0) {
    return {{Level::kInfo, "no lab is active on this bus",
             "start one with lab run FILE or under Runs on this page"}};
  }
  if (!facts.run_info.trouble().empty()) {
    out.push_back({Level::kError,
                   "the run's experiment cannot be read: " + facts.run_info.trouble(),
                   "the lab has another version than this page: start both from one build"});
  }
  if (facts.now - facts.bus_utime > kSilentBus_us && !facts.ended) {
    out.push_back(
        {Level::kError,
         fmt::format("no message on the bus for {:.0f} s",
                     units::seconds(facts.now - facts.bus_utime)),
         "this page shows old data; check with lab spy whether the lab is still running"});
    return out;
  }
  adviseOnServices(facts, out);
  adviseOnStreams(facts, out);
  adviseOnRobots(facts, out);
  adviseOnTracker(facts, out);
  adviseOnLight(facts, out);
  adviseOnLinks(facts, out);
  std::ranges::stable_sort(out, {}, &Advice::level);
  return out;
}

Json adviceJson(const std::vector<Advice>& advice) {
  Json json = Json::array();
  for (const Advice& a : advice) {
    json.push_back({{"level", levelName(a.level)}, {"what", a.what}, {"do", a.remedy}});
  }
  return json;
}

}  // namespace lab::dashboard
