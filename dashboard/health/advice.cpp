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
constexpr std::int64_t kRivals_us = 2'000'000;
constexpr std::int32_t kManyErrors = 20;  // frames in 10 s
constexpr std::size_t kMostNamed = 12;

/// Robots that share a trouble are said in one line.
class Group {
 public:
  void add(std::int32_t id) { ids_.push_back(id); }
  void tell(std::vector<Advice>& out, Level level, const std::string& what,
            const std::string& way_out) const {
    if (ids_.empty()) return;
    std::string names;
    for (std::size_t i = 0; i < std::min(ids_.size(), kMostNamed); ++i) {
      names += (i == 0 ? "" : ", ") + std::to_string(ids_[i]);
    }
    if (ids_.size() > kMostNamed) names += fmt::format(" and {} more", ids_.size() - kMostNamed);
    out.push_back({level, fmt::format("robot {}: {}", names, what), way_out});
  }

 private:
  std::vector<std::int32_t> ids_;
};

std::string at(const ServiceRow& row) {
  const service_status_t& status = row.status;
  return status.host.empty() ? status.sender : fmt::format("{} on {}", status.sender, status.host);
}

void onServices(const AdviceFacts& facts, std::vector<Advice>& out) {
  for (const auto& [key, row] : facts.health.services()) {
    const service_status_t& status = row.status;
    if (status.contract_version != kContractVersion) {
      out.push_back({Level::kError,
                     fmt::format("{} speaks contract {}, this page {}", at(row),
                                 status.contract_version, kContractVersion),
                     "run programs of one build on all hosts: build again, start the lab again"});
    }
    if (row.hasEnded()) continue;
    const double silent = units::seconds(facts.now - row.heard_utime);
    if (facts.now - row.heard_utime > HealthView::kSilent_us && facts.isLive()) {
      out.push_back({Level::kError,
                     fmt::format("{} has said nothing for {:.0f} s", at(row), silent),
                     fmt::format("the lab starts a service that ended again; if it stays silent, "
                                 "read logs/{}.log in the run's folder, or end the run",
                                 status.sender)});
    } else if (status.state == service_status_t::FAULT) {
      out.push_back({Level::kError, fmt::format("{} is in fault: {}", at(row), status.last_error),
                     fmt::format("repair what it names; more is in logs/{}.log in the run's folder",
                                 status.sender)});
    } else if (!status.last_error.empty()) {
      out.push_back({Level::kWarn, fmt::format("{} says: {}", at(row), status.last_error),
                     "the run goes on and is marked; repair what it names"});
    }
    if (row.starts > 1) {
      out.push_back({Level::kWarn, fmt::format("{} has been started {} times", at(row), row.starts),
                     fmt::format("why is in logs/{}.log in the run's folder", status.sender)});
    }
  }
}

void onStreams(const AdviceFacts& facts, std::vector<Advice>& out) {
  for (const auto& [channel, messages] : facts.health.notUnderstood()) {
    out.push_back(
        {Level::kError,
         fmt::format("{} messages on {} are of another contract, or broken", messages, channel),
         "somebody on this bus runs another version: end it, or give this lab a port of "
         "its own ([network] port)"});
  }
  for (const auto& [key, row] : facts.health.streams()) {
    if (row.new_losses <= 0 || facts.run_info.replay()) continue;
    out.push_back({Level::kWarn,
                   fmt::format("{} messages on {} from {} were lost in the last seconds",
                               row.new_losses, key.channel, key.sender),
                   "the machine is too busy or the receive buffers are small: lab doctor says "
                   "how to enlarge them"});
  }
  for (const auto& [sender, ahead] : facts.health.ahead()) {
    out.push_back(
        {Level::kError,
         fmt::format("the clock of {} is {:.1f} s ahead of this machine's", sender, ahead),
         "set the clocks of all hosts by NTP or PTP; a clock that jumped spoils delays"});
  }
}

void onRobots(const AdviceFacts& facts, std::vector<Advice>& out) {
  Group missing, silent, rivals, rejected, lease, saturated, battery, errors;
  for (const RobotSpec& robot : facts.run_info.experiment().robots) {
    const auto row = facts.robots.rows().find(robot.id);
    const bool heard = row != facts.robots.rows().end() && !row->second.owner.empty();
    if (!heard && facts.isLive()) missing.add(robot.id);
  }
  for (const auto& [id, row] : facts.robots.rows()) {
    if (row.owner.empty()) continue;
    const bool is_silent = facts.now - row.heard_utime > kSilentRobot_us;
    if (is_silent && facts.isLive()) silent.add(id);
    if (is_silent) continue;
    if (row.rival_utime != 0 && facts.now - row.rival_utime < kRivals_us) rivals.add(id);
    const auto says = [&row](std::int32_t flag) { return (row.state.flags & flag) != 0; };
    if (says(robot_state_t::FLAG_REJECTED)) rejected.add(id);
    if (says(robot_state_t::FLAG_LEASE_EXPIRED) && facts.isLive()) lease.add(id);
    if (says(robot_state_t::FLAG_SATURATED)) saturated.add(id);
    if (row.batteryIsLow()) battery.add(id);
    if (row.new_errors >= kManyErrors) errors.add(id);
  }
  rivals.tell(out, Level::kError, "two processes say that they own it",
              "end one of them, or give one robot another id");
  missing.tell(out, Level::kError, "nothing has been heard of it",
               "switch it on and see that its line is plugged in; lab doctor lists the lines");
  silent.tell(out, Level::kError, "has fallen silent",
              "look at its battery and its line; it stops by itself when its lease is over");
  rejected.tell(out, Level::kError, "refused its last order",
                "the service that owns it says why, under Health");
  lease.tell(out, Level::kWarn, "stands because the host was silent",
             "it goes on with the next order; if none comes, see that the lab runs");
  battery.tell(out, Level::kWarn, "battery is low", "charge it");
  errors.tell(out, Level::kWarn, "many frames on its line fail their check",
              "try another cable or radio channel, away from motors");
  saturated.tell(out, Level::kInfo, "a wheel was asked for more than it can do",
                 "lower the program's speed or noise: the law is not the robot's there");
}

void onTracker(const AdviceFacts& facts, std::vector<Advice>& out) {
  const auto& tracker = facts.health.tracker();
  if (!tracker || facts.ended) return;
  if (tracker->state == tracker_status_t::GONE) {
    out.push_back({Level::kError, "the camera is gone: " + tracker->trouble,
                   "plug it in again; the tracker takes it back by itself"});
  } else if (!tracker->trouble.empty()) {
    out.push_back({Level::kError, "tracker: " + tracker->trouble, "see Camera"});
  }
  if (tracker->moved != 0) {
    out.push_back({Level::kError, "the camera is not where it was calibrated",
                   "end the run, fix the camera and calibrate it again: lab calibrate camera"});
  }
  if (!tracker->warning.empty()) out.push_back({Level::kWarn, "tracker: " + tracker->warning, ""});
  if (facts.health.newDark() > 0) {
    out.push_back({Level::kWarn, "pictures are too dark to see robots in",
                   "open the lens or lengthen the exposure ([camera] exposure_ms)"});
  }
  if (facts.health.newSaturated() > 0) {
    out.push_back({Level::kWarn, "pictures have more white than can be measured",
                   "close the lens or shorten the exposure ([camera] exposure_ms)"});
  }
}

void onLight(const AdviceFacts& facts, std::vector<Advice>& out) {
  if (!facts.light || facts.ended) return;
  if (facts.isLive() && facts.now - facts.light_utime > kSilentLight_us) {
    out.push_back({Level::kError, "nothing is heard of the projector's light",
                   "read logs/projector_ctl.log in the run's folder"});
    return;
  }
  if (!facts.light->trouble.empty()) {
    out.push_back({Level::kError, "projector: " + facts.light->trouble,
                   "another light than wanted is shown until that is repaired"});
  }
  if (!facts.light->last_refusal.empty()) {
    out.push_back({Level::kWarn, "the projector refused a light: " + facts.light->last_refusal,
                   "who sent it must send another"});
  }
}

void onLinks(const AdviceFacts& facts, std::vector<Advice>& out) {
  for (const auto& [host, link] : facts.health.links()) {
    for (const link_peer_t& peer : link.peers) {
      if (peer.state == link_peer_t::REFUSED) {
        out.push_back({Level::kError,
                       fmt::format("{} refuses the link to {}: {}", host, peer.host, peer.trouble),
                       "set both clocks by NTP or PTP, and see that both run the same version"});
      } else if (peer.state == link_peer_t::SILENT && facts.isLive()) {
        out.push_back({Level::kError, fmt::format("{} hears nothing of {}", host, peer.host),
                       "look at the cable, the host and its dds_gateway"});
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
    return {{Level::kInfo, "no lab is heard on this bus",
             "start one: lab run FILE, or under Runs on this page"}};
  }
  if (!facts.run_info.trouble().empty()) {
    out.push_back({Level::kError,
                   "the run's experiment cannot be read: " + facts.run_info.trouble(),
                   "the lab runs another version than this page: start both from one build"});
  }
  if (facts.now - facts.bus_utime > kSilentBus_us && !facts.ended) {
    out.push_back({Level::kError,
                   fmt::format("nothing has been heard on the bus for {:.0f} s",
                               units::seconds(facts.now - facts.bus_utime)),
                   "what this page shows is old; see whether the lab still runs (lab spy)"});
    return out;
  }
  onServices(facts, out);
  onStreams(facts, out);
  onRobots(facts, out);
  onTracker(facts, out);
  onLight(facts, out);
  onLinks(facts, out);
  std::ranges::stable_sort(out, {}, &Advice::level);
  return out;
}

Json adviceJson(const std::vector<Advice>& advice) {
  Json json = Json::array();
  for (const Advice& a : advice) {
    json.push_back({{"level", levelName(a.level)}, {"what", a.what}, {"do", a.way_out}});
  }
  return json;
}

}  // namespace lab::dashboard
