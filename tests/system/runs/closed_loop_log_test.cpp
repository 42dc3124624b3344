// Reconstructs the light of a run from its messages: bit-identical, in virtual time and live.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/loop/virtual_loop.hpp"
#include "projector_ctl/projector_messages.hpp"
#include "projector_ctl/projector_service.hpp"
#include "projector_ctl/replay.hpp"
#include "sim_svc/sim_service.hpp"

namespace lab::system_test {
namespace {

struct Logged {
  std::string channel;
  std::vector<std::uint8_t> data;
};

/// Simulator, projector and a sender that shows the first light step, each on its own bus.
class Lab {
 public:
  Lab(const Experiment& experiment, Loop& loop, Bus& sim_bus, Bus& projector_bus, Bus& other_bus)
      : sim_node_(sim_bus, loop, {"sim_svc", 2, 11}),
        projector_node_(projector_bus, loop, {"projector_ctl", 2, 12}),
        other_(other_bus, loop, {"lab", 0, 13}),
        sim_{{sim_node_, loop, experiment, {}}},
        projector_{{projector_node_, loop, experiment, {}}} {
    sim_node_.start();
    projector_node_.start();
    setLayers(light_, toDrivenLayers(experiment.light.steps.at(0).layers, {}));
    light_.seq = 1;
    loop.every(500'000, loop.now() + 300'000, [this] {
      light_.utime = 0;
      other_.publishCommand(channels::kLightCommand, light_);
    });
    orders_ = lightTableCommand(experiment);
    orders_.seq = 1;
    orders_.lease_ms = 1000;
    loop.every(200'000, loop.now(), [this] {
      orders_.utime = 0;
      other_.publishCommand(channels::kRobotCommand, orders_);
    });
  }

 private:
  Node sim_node_;
  Node projector_node_;
  Node other_;
  sim::SimService sim_;
  projector::ProjectorService projector_;
  light_command_t light_{};
  robot_command_t orders_{};
};

void logInto(std::vector<Logged>& log, Bus& bus) {
  bus.subscribeAll([&log](const Packet& packet) {
    log.push_back({std::string(packet.channel), {packet.data.begin(), packet.data.end()}});
  });
}

struct Comparison {
  int statuses = 0;   ///< number of LIGHT_STATUS with the light of the script
  int same = 0;       ///< reconstructed with identical bytes
  int unknown = 0;    ///< could not be reconstructed
  int brightest = 0;  ///< largest byte of a trail
};

Comparison replay(const Experiment& experiment, const std::vector<Logged>& log) {
  const projector::SceneContext scene_context = projector::sceneContextOf(experiment, {});
  projector::Replay dut(scene_context);
  Comparison comparison;
  for (const Logged& message : log) {
    light_command_t command{};
    tracked_frame_t frame{};
    light_status_t status{};
    if (message.channel == channels::kLightCommand && decode(message.data, command)) {
      dut.add(projector::toCommand(command, experiment, {}));
    } else if (message.channel == channels::kTrackedFrame && decode(message.data, frame)) {
      dut.add(projector::toObservedFrame(frame));
    } else if (message.channel == channels::kLightStatus && decode(message.data, status)) {
      const auto found = dut.layersOf(projector::toShownRecord(status));
      if (status.commander.empty()) continue;
      ++comparison.statuses;
      if (!found) {
        ++comparison.unknown;
        continue;
      }
      light_status_t again = status;
      again.layers = toMessages(*found);
      again.num_layers = static_cast<std::int32_t>(again.layers.size());
      if (encode(again) == encode(status)) ++comparison.same;
      for (const light_layer_t& layer : status.layers) {
        for (const std::uint8_t byte : layer.grid) {
          comparison.brightest = std::max<int>(comparison.brightest, byte);
        }
      }
    }
  }
  return comparison;
}

Experiment example(const std::string& name) {
  return loadExperiment(std::string(LAB_EXPERIMENTS) + "/" + name + ".toml");
}

class ClosedLoopLog : public testing::TestWithParam<std::string> {};

TEST_P(ClosedLoopLog, GivesTheSameFieldInVirtualTime) {
  const Experiment experiment = example(GetParam());
  std::vector<Logged> log;
  VirtualLoop loop;
  MemoryBus bus{[&loop] { return loop.now(); }};
  loop.drainWith([&bus] { bus.deliver(); });
  logInto(log, bus);
  const Lab lab(experiment, loop, bus, bus, bus);
  loop.runUntil(loop.now() + 20'000'000);

  const Comparison comparison = replay(experiment, log);
  EXPECT_GT(comparison.statuses, 19 * 55);
  EXPECT_EQ(comparison.unknown, 0);
  EXPECT_EQ(comparison.same, comparison.statuses);
  if (GetParam() == "pheromone") {
    EXPECT_GT(comparison.brightest, 50);
  }
}

TEST_P(ClosedLoopLog, GivesTheSameFieldLive) {
  constexpr int kPort = 7846;
  const Experiment experiment = example(GetParam());
  std::vector<Logged> log;
  AsioLoop loop;
  const std::string url = lcmUrl(kPort);
  LcmBus logger(url);
  LcmBus sim_bus(url);
  LcmBus projector_bus(url);
  LcmBus other_bus(url);
  logInto(log, logger);
  const Lab lab(experiment, loop, sim_bus, projector_bus, other_bus);
  for (LcmBus* bus : {&logger, &sim_bus, &projector_bus, &other_bus}) {
    loop.onReadable(bus->fileDescriptor(), [bus] { bus->drain(); });
  }
  loop.at(loop.now() + 4'000'000, [&loop] { loop.stop(); });
  loop.run();

  const Comparison comparison = replay(experiment, log);
  EXPECT_GT(comparison.statuses, 50);  // a busy machine skips frames
  EXPECT_EQ(comparison.unknown, 0);
  EXPECT_EQ(comparison.same, comparison.statuses);
}

INSTANTIATE_TEST_SUITE_P(Examples, ClosedLoopLog, testing::Values("follow_spot", "pheromone"));

}  // namespace
}  // namespace lab::system_test
