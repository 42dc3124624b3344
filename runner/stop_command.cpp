#include <fmt/format.h>

#include <lab/robot_status_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <map>

#include "common/asio_loop.hpp"
#include "common/channels.hpp"
#include "common/lcm_bus.hpp"
#include "common/node.hpp"
#include "runner/commands.hpp"
#include "runner/lab_registry.hpp"

namespace lab::runner {
namespace {

constexpr std::int64_t kRepeat_us = 100'000;
constexpr std::int64_t kPatience_us = 5'000'000;
constexpr std::int64_t kMeetEveryRobot_us = 300'000;  // every owner reports at 20 Hz or faster

/// Asks one lab's robots to stop (or to go on) until each has said that it does.
class StopRequest {
 public:
  StopRequest(const RunningLab& lab, bool clear)
      : lab_(lab), clear_(clear), bus_(lab.url), node_(bus_, loop_, {"lab_stop", 0, loop_.now()}) {
    request_.seq = loop_.now();
    request_.clear = clear ? 1 : 0;
    request_.reason = clear ? "lab stop --clear" : "lab stop";
    node_.subscribe<robot_status_t>(channels::kRobotStatus, [this](const robot_status_t& status) {
      for (const robot_state_t& robot : status.robots) obeys_[robot.robot_id] = obeys(robot);
    });
  }

  bool execute() {
    const std::int64_t start = loop_.now();
    loop_.onReadable(bus_.fileDescriptor(), [this] { bus_.drain(); });
    loop_.every(kRepeat_us, start, [this, start] {
      const std::int64_t waited = loop_.now() - start;
      const bool done = waited >= kMeetEveryRobot_us && unmoved().empty() && !obeys_.empty();
      if (done || waited > kPatience_us) {
        loop_.stop();
        return;
      }
      request_.utime = loop_.now();
      node_.publishCommand(channels::kRobotStop, request_);
    });
    loop_.run();
    return tell();
  }

 private:
  [[nodiscard]] bool obeys(const robot_state_t& robot) const {
    const bool stopped = (robot.flags & robot_state_t::FLAG_STOPPED) != 0;
    return stopped != clear_ && robot.stop_seq == request_.seq;
  }

  [[nodiscard]] std::string unmoved() const {
    std::string ids;
    for (const auto& [id, obeyed] : obeys_) {
      if (!obeyed) ids += (ids.empty() ? "" : ", ") + std::to_string(id);
    }
    return ids;
  }

  [[nodiscard]] bool tell() const {
    const std::string missing = unmoved();
    if (obeys_.empty()) {
      fmt::print("{}: no robot answers\n", lab_.name);
      return false;
    }
    if (!missing.empty()) {
      fmt::print("{}: NOT confirmed by robot {}\n", lab_.name, missing);
      return false;
    }
    fmt::print("{}: {} by {} robot{}\n", lab_.name,
               clear_ ? "stop released, confirmed" : "stopped, confirmed", obeys_.size(),
               obeys_.size() == 1 ? "" : "s");
    return true;
  }

  const RunningLab& lab_;
  bool clear_;
  AsioLoop loop_;
  LcmBus bus_;
  Node node_;
  robot_stop_t request_{};
  std::map<std::int32_t, bool> obeys_;
};

}  // namespace

ExitCode stop(const StopOptions& options) {
  std::vector<RunningLab> labs = runningLabs();
  std::erase_if(labs, [](const RunningLab& lab) { return lab.replay; });
  if (!options.lab.empty() || labs.empty()) labs = {findLab(options.lab)};
  bool all = true;
  for (const RunningLab& lab : labs) all = StopRequest(lab, options.clear).execute() && all;
  return all ? kDone : kFailed;
}

}  // namespace lab::runner
