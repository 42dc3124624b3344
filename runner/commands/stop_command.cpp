#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <lab/robot_status_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/bus_error.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/service/node.hpp"
#include "common/service/stop_coordinator.hpp"
#include "common/text/printable.hpp"
#include "runner/commands/commands.hpp"
#include "runner/runs/lab_registry.hpp"

namespace lab::runner {
namespace {

constexpr std::int64_t kStopTick_us = 20'000;  // StopCoordinator decides when to repeat

void printNotAsked(const RunningLab& lab, bool clear, const BusError& error) {
  fmt::print("{}: NOT {}, {}\n", lab.name, clear ? "released" : "stopped", printable(error.what()));
}

/// Asks the robots of one lab to stop (or releases the stop) until each has confirmed it.
class StopRequest {
 public:
  /// Opens the lab's bus and sends the first request.
  /// @throws BusError when the bus cannot be opened or nothing can be sent
  StopRequest(RunningLab lab, bool clear, AsioLoop& loop)
      : lab_(std::move(lab)),
        clear_(clear),
        loop_(loop),
        seq_(loop.now()),
        bus_(lab_.url),
        node_(bus_, loop_, {"lab_stop", 0, seq_}) {
    if (clear_) {
      stop_.release(node_.identity().name, "lab stop --clear", seq_, seq_);
    } else {
      stop_.stop(node_.identity().name, "lab stop", seq_, seq_);
    }
    repeat();
    node_.subscribe<robot_status_t>(channels::kRobotStatus, [this](const robot_status_t& status) {
      stop_.take(status, loop_.now());
    });
    node_.subscribe<robot_stop_t>(channels::kRobotStop,
                                  [this](const robot_stop_t& stop) { take(stop); });
    bus_watch_ = loop_.watch(bus_.fileDescriptor(), [this] { guarded([this] { bus_.drain(); }); });
  }

  /// Repeats the request when due. @return whether it has ended; then its result was printed
  bool attend() {
    if (finished_) return true;
    const std::int64_t waited = loop_.now() - seq_;
    const bool answered = waited >= StopCoordinator::kDiscovery_us && stop_.confirmed();
    if (answered || waited > StopCoordinator::kTimeout_us || !overruled_by_.empty()) {
      finish(tell());
      sayLastCounts();
    } else {
      guarded([this] { repeat(); });
    }
    return finished_;
  }

  [[nodiscard]] bool succeeded() const { return succeeded_; }

 private:
  void repeat() {
    if (auto request = stop_.due(loop_.now())) {
      node_.publishCommand(channels::kRobotStop, *request);
    }
  }

  /// An error on this lab's bus is printed and does not delay the stop of other labs.
  void guarded(const std::function<void()>& part) {
    try {
      part();
    } catch (const BusError& error) {
      printNotAsked(lab_, clear_, error);
      finish(false);
    }
  }

  void sayLastCounts() {
    try {
      node_.close();
    } catch (const BusError&) {
      // The result was printed, and the final counts only matter for the report.
    }
  }

  void finish(bool succeeded) {
    finished_ = true;
    succeeded_ = succeeded;
    bus_watch_.reset();
  }

  /// The newest request is in force, so a later opposite request ends this one. Older requests are
  /// ignored: runners repeat them until they have received this one.
  void take(const robot_stop_t& stop) {
    const bool older = stop.seq <= seq_;
    if (older) return;
    stop_.take(stop, loop_.now());
    if ((stop.clear != 0) == clear_) return;
    overruled_by_ = stop.sender + (stop.reason.empty() ? "" : " (" + stop.reason + ")");
  }

  [[nodiscard]] bool tell() const {
    if (!overruled_by_.empty()) {
      fmt::print("{}: NOT {}, {} came from {}\n", lab_.name, clear_ ? "released" : "stopped",
                 clear_ ? "a newer stop" : "a newer release", printable(overruled_by_));
      return false;
    }
    std::string missing;
    for (const std::int32_t id : stop_.unconfirmed()) {
      missing += (missing.empty() ? "" : ", ") + std::to_string(id);
    }
    if (stop_.total() == 0) {
      fmt::print("{}: NOT confirmed: no robot answers\n", lab_.name);
      return false;
    }
    if (!missing.empty()) {
      fmt::print("{}: NOT confirmed by robot {}\n", lab_.name, missing);
      return false;
    }
    fmt::print("{}: {} by {} robot{}\n", lab_.name,
               clear_ ? "stop released, confirmed" : "stopped, confirmed", stop_.total(),
               stop_.total() == 1 ? "" : "s");
    return true;
  }

  RunningLab lab_;
  bool clear_;
  AsioLoop& loop_;
  std::int64_t seq_;  ///< of this request: the time at which it was made [us since 1970]
  std::string overruled_by_;
  bool finished_ = false;
  bool succeeded_ = false;
  LcmBus bus_;
  Node node_;
  StopCoordinator stop_;
  std::unique_ptr<AsioLoop::Watch> bus_watch_;
};

}  // namespace

ExitCode stop(const StopOptions& options) {
  std::vector<RunningLab> labs = runningLabs();
  std::erase_if(labs, [](const RunningLab& lab) { return lab.replay; });
  if (!options.lab.empty() || labs.empty()) labs = {findLab(options.lab)};
  // All labs at once: one that does not answer must not delay the stop of the others.
  AsioLoop loop;
  bool all = true;
  std::list<StopRequest> requests;
  for (const RunningLab& lab : labs) {
    try {
      requests.emplace_back(lab, options.clear, loop);
    } catch (const BusError& error) {
      printNotAsked(lab, options.clear, error);
      all = false;
    }
  }
  loop.every(kStopTick_us, loop.now(), [&] {
    bool over = true;
    for (StopRequest& request : requests) over = request.attend() && over;
    if (over) loop.stop();
  });
  loop.run();
  return all && std::ranges::all_of(requests, &StopRequest::succeeded) ? kDone : kFailed;
}

}  // namespace lab::runner
