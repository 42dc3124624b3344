// Feeds messages to the services that the input selects, never dds_gateway, and to the runner's
// ExperimentController, on one bus in virtual time. An exception that leaves a handler ends a
// service, so it counts as a crash.
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/analyzer_service.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/camera/memory_cameras.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/serial/memory_serial.hpp"
#include "common/service/service_main.hpp"
#include "dashboard/dashboard_service.hpp"
#include "projector_ctl/projector_service.hpp"
#include "robot_bridge/bridge_service.hpp"
#include "runner/live/experiment_controller.hpp"
#include "sim_svc/sim_service.hpp"
#include "tests/fuzz/input.hpp"
#include "tests/fuzz/messages.hpp"
#include "tests/support/robustness_experiment.hpp"
#include "tracker_svc/tracker_service.hpp"

namespace lab::fuzz {
namespace {

/// What runs beside the services that bits 0 to 4 of the first byte leave out.
enum class Beside { kNothing, kRunner, kTracker };

/// By bits 5 to 7. Few inputs have a tracker: its pictures take ten times as long as everything
/// else.
Beside besideOf(unsigned chosen) {
  switch (chosen >> 5U) {
    case 6:
      return Beside::kRunner;
    case 7:
      return Beside::kTracker;
    default:
      return Beside::kNothing;
  }
}

/// kRobustnessExperiment, long enough and with rates at which many inputs run per second.
Experiment experimentWith(const std::vector<std::string>& more) {
  std::vector<std::string> overrides{"duration_s=600", "robot.status_rate_hz=5", "camera.fps=5",
                                     "light.frame_rate_hz=10"};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return parseExperiment(kRobustnessExperiment, "fuzz", overrides);
}

constexpr const char* kWithWire =
    "robots=[{id=1, x_cm=30, y_cm=45, theta_deg=0},"
    "{id=2, x_cm=60, y_cm=45, theta_deg=90, body=\"wire\"}]";

/// With all that the runner decides by messages. No robot is on a wire: the script would begin
/// later than an input ends.
Experiment conducted() {
  return experimentWith(
      {"robots=[{id=1, x_cm=30, y_cm=45, theta_deg=0}, {id=2, x_cm=60, y_cm=45, theta_deg=90}]",
       "stop_when=[{estimate=\"D_r\", program=\"abp\", relative_error_percent=5},"
       "{observable=\"largest_cluster\", relative_error_percent=5}]",
       "senses={rate_hz=5, values=[{sense=0, is=\"neighbours\", radius_cm=30}]}",
       "light.repeat=true",
       "light.steps=["
       "{hold_s=2, until={observable=\"polar_order\", above=0.5, over_s=0},"
       " layers=[{kind=\"uniform\", intensity=0.5,"
       " crowd={hold=\"polar_order\", target=0.5, gain=1, integral_time_s=5}}]},"
       "{hold_s=2, until={estimate=\"D_r\", program=\"abp\", relative_error=0.1},"
       " layers=[{kind=\"uniform\", intensity=0.5, crowd={gate=\"largest_cluster\", above=1}}]},"
       "{hold_s=2, until={tumbles=2}, layers=[{kind=\"disk\", radius_cm=5, intensity=0.5,"
       " follow=\"robots\", crowd={quorum=true, above=0.1}}]},"
       "{hold_s=2, until={region=\"circle\", robots=\"all\", x_cm=60, y_cm=45, radius_cm=20},"
       " layers=[{kind=\"uniform\", intensity=0.2}]}]"});
}

const Experiment& experimentOf(Beside beside) {
  static const Experiment kPoses = experimentWith({kWithWire});
  static const Experiment kConducted = conducted();
  static const Experiment kPictures = experimentWith(
      {kWithWire, "camera.tracker=\"camera\"", "camera.width_px=160", "camera.height_px=120",
       "camera.fps=1", "camera.exposure_ms=10", "camera.handshake=false"});
  return beside == Beside::kTracker ? kPictures : beside == Beside::kRunner ? kConducted : kPoses;
}

/// A service and its node.
struct Member {
  Member(Bus& bus, Loop& loop, SerialPorts& ports, Cameras& cameras, const Experiment& experiment,
         const ServiceDescription& description)
      : node(bus, loop, {description.name, description.origin, 1}),
        service(description.make({node, loop, experiment, "/", ports, "/", cameras})) {
    node.start();
  }
  Node node;
  std::unique_ptr<Service> service;
};

/// The dashboard without its web server.
struct Page {
  Page(Bus& bus, Loop& loop, const Experiment& experiment)
      : node(bus, loop, {"dashboard", 0, 1}),
        context{node, loop, experiment, "/"},
        dashboard(context, hub, "/runs",
                  {.viewers = [] { return 1; }, .facts = [] { return dashboard::ServerFacts{}; }}) {
    node.start();
  }
  Node node;
  ServiceContext context;
  dashboard::Hub hub;
  dashboard::DashboardBus dashboard;
};

/// The runner without processes. It begins its run at once.
struct Runner {
  Runner(Bus& bus, Loop& loop, const Experiment& experiment)
      : node(bus, loop, {"lab", 0, 1}),
        controller({node, loop, experiment, "/"}, writeExperiment(experiment),
                   [this](runner::Ending, const std::string& because) { over = because; }) {
    controller.announceMarks([](const std::string&, const std::string&) {});
    node.start();
    controller.begin();
  }
  Node node;
  std::optional<std::string> over;  ///< why the run shall end
  runner::ExperimentController controller;
};

void run(Input& input) {
  constexpr int kMostMessages = 60;
  constexpr std::int64_t kLongest_us = 10'000'000;
  // Longer than the time after which the script begins without robots that do not answer.
  constexpr std::int64_t kScriptBegins_us = 3'100'000;
  const unsigned chosen = input.number<std::uint8_t>();
  // Bits 0 to 4 each leave out one service, because fewer run faster.
  const auto has = [chosen](unsigned bit) { return (chosen >> bit & 1U) == 0; };
  const Beside beside = besideOf(chosen);
  const Experiment& experiment = experimentOf(beside);
  VirtualLoop loop;
  MemoryBus bus([&loop] { return loop.now(); });
  loop.drainWith([&bus] { bus.deliver(); });
  MemorySerial ports(loop);
  MemoryCameras cameras(loop);
  std::list<Member> members;
  std::unique_ptr<Page> page;
  std::unique_ptr<Runner> runner;
  const auto add = [&](const ServiceDescription& description) {
    members.emplace_back(bus, loop, ports, cameras, experiment, description);
  };
  if (has(0)) add(analysis::serviceDescription());
  if (has(1)) add(projector::serviceDescription());
  if (has(2)) add(bridge::serviceDescription());
  if (beside == Beside::kTracker) add(tracker::serviceDescription());
  if (has(3)) add(sim::serviceDescription());
  if (has(4)) page = std::make_unique<Page>(bus, loop, experiment);
  if (beside == Beside::kRunner) {
    runner = std::make_unique<Runner>(bus, loop, experiment);
    loop.runUntil(loop.now() + kScriptBegins_us);
  }
  const std::int64_t end = loop.now() + kLongest_us;
  for (int i = 0; i < kMostMessages && !input.empty() && loop.now() < end; ++i) {
    const TimedMessage message = nextMessage(input);
    bus.publish(message.channel, message.data);
    bus.deliver();
    loop.runUntil(loop.now() + message.wait_us);
    if (runner && runner->over) runner->controller.conclude(*runner->over);
  }
  // Longer than the second in which the analyzer publishes its results.
  loop.runUntil(loop.now() + 1'100'000);
  if (page) {
    for (const char* what : {"analysis", "trails", "robot", "speeds"}) {
      for (const char* which : {"", "1", "abp"}) {
        static_cast<void>(page->dashboard.query(what, which));
      }
    }
  }
  if (runner) {
    static_cast<void>(runner->controller.progress());
    runner->controller.conclude("the input is over");
  }
  for (Member& member : members) member.node.close();
  bus.deliver();
}

}  // namespace
}  // namespace lab::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  lab::fuzz::Input input(bytes, size);
  lab::fuzz::run(input);
  return 0;
}
