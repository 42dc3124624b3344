#include "runner/virtual_time/run_virtual.hpp"

#include <cstdint>
#include <filesystem>
#include <lab/clock_t.hpp>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analyzer/analyzer_service.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/camera/memory_cameras.hpp"
#include "common/experiment/service_placement.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/math/units.hpp"
#include "common/serial/memory_serial.hpp"
#include "projector_ctl/projector_service.hpp"
#include "robot_bridge/bridge_service.hpp"
#include "runner/live/experiment_controller.hpp"
#include "runner/user_program/lockstep.hpp"
#include "sim_svc/sim_service.hpp"
#include "tracker_svc/tracker_service.hpp"

namespace lab::runner {
namespace {

// Messages under way at the end are delivered and logged within this time.
constexpr std::int64_t kSettle_us = 500'000;

/// Who reads the results of the analyzer while the experiment runs.
analysis::ResultReaders resultReaders(const PreparedRun& run) {
  const bool waited_for = waitsForEstimates(run.experiment) || needsCrowd(run.experiment);
  return waited_for || run.user_program ? analysis::ResultReaders::kLive
                                        : analysis::ResultReaders::kLogOnly;
}

/// The services that the experiment needs, except those that run in real time only.
std::vector<ServiceDescription> virtualServices(const PreparedRun& run) {
  const Experiment& experiment = run.experiment;
  std::vector<ServiceDescription> services = {
      analysis::serviceDescription(resultReaders(run)), projector::serviceDescription(),
      bridge::serviceDescription(), tracker::serviceDescription(), sim::serviceDescription()};
  std::erase_if(services, [&](const ServiceDescription& service) {
    const bool unread = !run.live_analysis && service.name == std::string("analyzer");
    return unread || !isNeeded(experiment, service.name);
  });
  return services;
}

/// A service and its node, which in real time are one process.
struct Member {
  Member(Bus& bus, Loop& loop, SerialPorts& ports, Cameras& cameras,
         const ServiceDescription& description, const PreparedRun& run)
      : node(bus, loop, {description.name, description.origin, 1}),
        service(description.make(
            {.node = node,
             .loop = loop,
             .experiment = run.experiment,
             .directory = run.directory,
             .ports = ports,
             .programs = std::filesystem::canonical("/proc/self/exe").parent_path(),
             .cameras = cameras,
             .threads = run.threads})) {}
  Node node;
  std::unique_ptr<Service> service;
};

}  // namespace

RunOutcome runVirtual(const PreparedRun& run, const ShowProgress& show,
                      const std::function<bool()>& interrupted, const ProcedureFactory& procedure) {
  VirtualLoop loop;
  MemoryBus bus([&loop] { return loop.now(); });
  loop.drainWith([&bus] { bus.deliver(); });
  LogWriter log(run.directory / files::kLog);
  bus.subscribeAll([&log](const Packet& packet) { log.write(packet); });

  MemorySerial ports(loop);
  MemoryCameras cameras(loop);
  RunOutcome outcome;
  std::list<Member> members;
  for (const ServiceDescription& description : virtualServices(run)) {
    members.emplace_back(bus, loop, ports, cameras, description, run);
  }
  Node node(bus, loop, {"lab", 0, 1});
  std::string why = "ended by the user";
  ExperimentController controller({node, loop, run.experiment, run.directory}, run.effective,
                                  [&](Ending ending, const std::string& because) {
                                    why = because;
                                    outcome.interrupted = ending == Ending::kRequested;
                                    outcome.closed_early =
                                        ending == Ending::kUnmet || ending == Ending::kBroken;
                                    loop.stop();
                                  });
  std::optional<ProcedureNode> procedure_node;
  if (procedure) {
    procedure_node.emplace(bus, loop, cameras, run, 1, procedure, controller, [&] {
      why = kProcedureDone;
      loop.stop();
    });
  }
  std::optional<Lockstep> program;
  if (run.user_program) {
    program.emplace(bus, loop, interrupted, [&](const std::string& problem) {
      controller.mark("the user program has ended");
      if (problem.empty()) return;
      controller.fault(problem);
      why = problem;
      outcome.closed_early = true;
      loop.stop();
    });
  }
  if (run.experiment.faults.message_loss > 0) {
    bus.loseAtRandom(run.experiment.faults.message_loss, run.experiment.seed);
  }

  for (Member& member : members) member.node.start();
  node.start();
  node.ready();
  if (procedure_node) procedure_node->begin();
  loop.every(units::kSecond_us, loop.now(), [&] {
    clock_t clock{};
    node.publish(channels::kClock, clock);
    show(controller.progress());
    if (interrupted()) {
      outcome.interrupted = true;
      loop.stop();
    }
  });
  try {
    controller.begin();
    if (program) {
      controller.mark(describe(*run.user_program));
      program->begin(*run.user_program, run.directory);
    }
    if (!outcome.closed_early) loop.run();
    outcome.ended_because = why;
    controller.conclude(why);
    if (program) program->conclude();
    loop.runUntil(loop.now() + kSettle_us);
    for (Member& member : members) member.node.close();
    if (procedure_node) procedure_node->end();
    node.close();
    bus.deliver();
    log.flush();
    outcome.faults = controller.faults();
    if (const std::string problem = program ? program->end() : ""; !problem.empty()) {
      outcome.faults.push_back(problem);
    }
  } catch (const std::exception& error) {
    // The log could not be written. Its contents so far are kept, and the run gets a fault.
    outcome.faults = controller.faults();
    outcome.faults.emplace_back(error.what());
    outcome.closed_early = true;
  }
  return outcome;
}

}  // namespace lab::runner
