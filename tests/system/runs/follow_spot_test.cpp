// Accuracy of a spot that follows a robot, through the whole chain in virtual time: world, camera,
// bus, prediction, projector. Prints the results.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <iostream>
#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/sim_truth_t.hpp>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/experiment/experiment_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/loop/virtual_loop.hpp"
#include "projector_ctl/projector_service.hpp"
#include "sim_svc/sim_service.hpp"

namespace lab::system_test {
namespace {

constexpr int kRobots = 4;

Experiment chain() {
  return parseExperiment(R"(
fileversion = 1
name = "follow"
duration_s = 600
program = "abp"
[[robots]]
id = 1
count = 4
[programs.abp]
model = "abp"
v_cm_s = 10
epsilon_s = 0.5
eta_rad_s = 3
[light]
frame_rate_hz = 60
[projector]
latency_ms = 40
[camera]
fps = 60
delay_ms = 20
position_noise_cm = 0.03
heading_noise_deg = 0.6
)",
                         "follow");
}

/// Simulator, projector and a sender of commands.
class Chain {
 public:
  explicit Chain(const light::Drive& drive) {
    loop_.drainWith([this] { bus_.deliver(); });
    other_.subscribe<light_status_t>(channels::kLightStatus, [this](const light_status_t& status) {
      statuses_.push_back(status);
    });
    other_.subscribe<sim_truth_t>(channels::kSimTruth,
                                  [this](const sim_truth_t& truth) { compare(truth); });
    sim_node_.start();
    projector_node_.start();
    light::Layer spot{.kind = light::LayerKind::kDisk, .size = 0.04, .intensity = 1};
    setLayers(light_, {{spot, drive}});
    light_.seq = 1;
    loop_.every(500'000, loop_.now(), [this] {
      light_.utime = 0;
      other_.publishCommand(channels::kLightCommand, light_);
    });
    orders_ = lightTableCommand(experiment_);
    orders_.seq = 1;
    orders_.lease_ms = 1000;
    loop_.every(200'000, loop_.now(), [this] {
      orders_.utime = 0;
      other_.publishCommand(channels::kRobotCommand, orders_);
    });
  }

  void run(double duration_s) {
    loop_.runUntil(loop_.now() + static_cast<std::int64_t>(1e6 * duration_s));
  }

  /// Root mean square distance between the centres of robot and spot [m].
  [[nodiscard]] double rms() const { return std::sqrt(square_ / compared_); }
  [[nodiscard]] int compared() const { return compared_; }

 private:
  void compare(const sim_truth_t& truth) {
    // The light on the arena is that of the last status before this time.
    while (statuses_.size() > 1 && statuses_[1].utime <= truth.utime) statuses_.pop_front();
    const bool started = loop_.now() - VirtualLoop::kEpoch > 2'000'000;
    if (!started || statuses_.empty() || statuses_[0].layers.size() != kRobots) return;
    for (std::size_t i = 0; i < kRobots; ++i) {
      const light_layer_t& spot = statuses_[0].layers[i];
      square_ += std::pow(spot.x - truth.robots[i].x, 2) + std::pow(spot.y - truth.robots[i].y, 2);
      ++compared_;
    }
  }

  VirtualLoop loop_;
  MemoryBus bus_{[this] { return loop_.now(); }};
  Experiment experiment_ = chain();
  Node sim_node_{bus_, loop_, {"sim_svc", 2, 1}};
  Node projector_node_{bus_, loop_, {"projector_ctl", 2, 1}};
  Node other_{bus_, loop_, {"lab", 0, 1}};
  sim::SimService sim_{{sim_node_, loop_, experiment_, {}}};
  projector::ProjectorService projector_{{projector_node_, loop_, experiment_, {}}};
  light_command_t light_{};
  robot_command_t orders_{};
  std::deque<light_status_t> statuses_;
  double square_ = 0;
  int compared_ = 0;
};

TEST(FollowSpot, StaysOnARobotWithPredictionAndLagsWithout) {
  const double duration_s = std::getenv("LAB_LONG") != nullptr ? 600 : 60;
  double rms[2];
  for (const bool predict : {false, true}) {
    light::Drive drive;
    drive.follow = light::Follow::kRobots;
    drive.predict = predict;
    Chain chain(drive);
    chain.run(duration_s);
    EXPECT_GT(chain.compared(), 0.8 * kRobots * 10 * (duration_s - 2));
    rms[predict ? 1 : 0] = chain.rms();
  }
  std::cout << "spot on a robot of 10 cm/s, camera 20 ms, projector 40 ms, " << duration_s
            << " s of " << kRobots << " robots: " << 100 * rms[1] << " cm RMS with prediction, "
            << 100 * rms[0] << " cm without\n";
  EXPECT_LT(rms[1], 0.005);
  EXPECT_GT(rms[0], 2 * rms[1]);
}

}  // namespace
}  // namespace lab::system_test
