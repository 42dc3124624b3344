#include "runner/run_virtual.hpp"

#include <lab/clock_t.hpp>
#include <list>

#include "common/channels.hpp"
#include "common/log_file.hpp"
#include "common/memory_bus.hpp"
#include "common/virtual_loop.hpp"
#include "runner/services.hpp"

namespace lab::runner {
namespace {

constexpr std::int64_t kSecond_us = 1'000'000;
constexpr std::int64_t kSettle_us = 500'000;  // for what is still under way at the end

/// One service with its node, as a process would hold them.
struct Member {
  Member(Bus& bus, Loop& loop, const ServiceDescription& description, const PreparedRun& run)
      : node(bus, loop, {description.name, description.origin, 1}),
        service(description.make({node, loop, run.experiment, run.directory})) {}
  Node node;
  std::unique_ptr<Service> service;
};

}  // namespace

RunOutcome runVirtual(const PreparedRun& run, const ShowProgress& show,
                      const std::function<bool()>& interrupted) {
  VirtualLoop loop;
  MemoryBus bus([&loop] { return loop.now(); });
  loop.drainWith([&bus] { bus.deliver(); });
  LogWriter log(run.directory / files::kLog);
  bus.subscribeAll([&log](const Packet& packet) { log.write(packet); });

  RunOutcome outcome;
  std::list<Member> members;
  for (const ServiceDescription& description : labServices()) {
    members.emplace_back(bus, loop, description, run);
  }
  Node node(bus, loop, {"lab", 0, 1});
  bool over = false;
  Conductor conductor({node, loop, run.experiment, run.directory}, run.effective, [&] {
    over = true;
    loop.stop();
  });
  if (run.experiment.faults.message_loss > 0) {
    bus.loseAtRandom(run.experiment.faults.message_loss, run.experiment.seed);
  }

  for (Member& member : members) member.node.start();
  node.start();
  node.ready();
  loop.every(kSecond_us, loop.now(), [&] {
    clock_t clock{};
    node.publish(channels::kClock, clock);
    show(conductor.progress());
    if (interrupted()) {
      outcome.interrupted = true;
      loop.stop();
    }
  });
  conductor.begin();
  loop.run();

  conductor.conclude(over ? "the script is over" : "ended by the user");
  loop.runUntil(loop.now() + kSettle_us);
  for (Member& member : members) member.node.close();
  node.close();
  bus.deliver();
  log.flush();
  outcome.faults = conductor.faults();
  return outcome;
}

}  // namespace lab::runner
