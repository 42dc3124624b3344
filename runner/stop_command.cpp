#include <fmt/format.h>

#include <lab/robot_status_t.hpp>
#include <lab/robot_stop_t.hpp>

#include "common/asio_loop.hpp"
#include "common/channels.hpp"
#include "common/lcm_bus.hpp"
#include "common/node.hpp"
#include "common/stop_desk.hpp"
#include "runner/commands.hpp"
#include "runner/lab_registry.hpp"

namespace lab::runner {
namespace {

constexpr std::int64_t kDeskTick_us = 20'000;  // the desk says when it is time

/// Asks one lab's robots to stop (or to go on) until each has said that it does.
class StopRequest {
 public:
  StopRequest(const RunningLab& lab, bool clear)
      : lab_(lab), clear_(clear), bus_(lab.url), node_(bus_, loop_, {"lab_stop", 0, loop_.now()}) {
    node_.subscribe<robot_status_t>(
        channels::kRobotStatus,
        [this](const robot_status_t& status) { desk_.take(status, loop_.now()); });
    node_.subscribe<robot_stop_t>(channels::kRobotStop,
                                  [this](const robot_stop_t& stop) { take(stop); });
  }

  bool execute() {
    const std::int64_t start = loop_.now();
    seq_ = start;
    if (clear_) {
      desk_.release(node_.identity().name, "lab stop --clear", start, start);
    } else {
      desk_.stop(node_.identity().name, "lab stop", start, start);
    }
    loop_.onReadable(bus_.fileDescriptor(), [this] { bus_.drain(); });
    loop_.every(kDeskTick_us, start, [this, start] {
      const std::int64_t waited = loop_.now() - start;
      const bool done = waited >= StopDesk::kMeetEveryRobot_us && desk_.confirmed();
      if (done || waited > StopDesk::kPatience_us) {
        loop_.stop();
        return;
      }
      if (auto request = desk_.due(loop_.now())) {
        node_.publishCommand(channels::kRobotStop, *request);
      }
    });
    loop_.run();
    return tell();
  }

 private:
  /// The newest request holds: who asked for the opposite later is not spoken against. Runners go
  /// on repeating an older one until they have heard of ours.
  void take(const robot_stop_t& stop) {
    const bool older = stop.seq <= seq_;
    if (older) return;
    desk_.take(stop, loop_.now());
    if ((stop.clear != 0) == clear_) return;
    overruled_by_ = stop.sender + (stop.reason.empty() ? "" : " (" + stop.reason + ")");
    loop_.stop();
  }

  [[nodiscard]] bool tell() const {
    if (!overruled_by_.empty()) {
      fmt::print("{}: NOT {}, {} came meanwhile from {}\n", lab_.name,
                 clear_ ? "released" : "stopped", clear_ ? "a newer stop" : "a newer release",
                 overruled_by_);
      return false;
    }
    std::string missing;
    for (const std::int32_t id : desk_.unconfirmed()) {
      missing += (missing.empty() ? "" : ", ") + std::to_string(id);
    }
    if (desk_.total() == 0) {
      fmt::print("{}: no robot answers\n", lab_.name);
      return false;
    }
    if (!missing.empty()) {
      fmt::print("{}: NOT confirmed by robot {}\n", lab_.name, missing);
      return false;
    }
    fmt::print("{}: {} by {} robot{}\n", lab_.name,
               clear_ ? "stop released, confirmed" : "stopped, confirmed", desk_.total(),
               desk_.total() == 1 ? "" : "s");
    return true;
  }

  const RunningLab& lab_;
  bool clear_;
  std::int64_t seq_ = 0;  ///< of our request, as everybody's the time it was made
  std::string overruled_by_;
  AsioLoop loop_;
  LcmBus bus_;
  Node node_;
  StopDesk desk_;
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
