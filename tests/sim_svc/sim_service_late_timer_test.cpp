// Timers that are late and out of order, as on a busy machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <lab/service_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <list>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "sim_svc/sim_service.hpp"

namespace lab::sim {
namespace {

/// Real time that the test controls. Repeating timers are never called, as if they were late.
class LateLoop final : public Loop {
 public:
  [[nodiscard]] std::int64_t now() const override { return now_; }
  [[nodiscard]] bool isVirtual() const override { return false; }
  void at(std::int64_t /*utime*/, Callback callback) override {
    once_.push_back(std::move(callback));
  }
  void every(std::int64_t /*period*/, std::int64_t /*first*/, Callback /*callback*/) override {}
  void stop() override {}

  void moveTo(std::int64_t utime) { now_ = utime; }
  void runOnce() {
    while (!once_.empty()) {
      const Callback callback = std::move(once_.front());
      once_.pop_front();
      callback();
    }
  }

 private:
  std::int64_t now_ = 1'000'000'000;
  std::list<Callback> once_;
};

Experiment oneRobot() {
  Experiment experiment;
  experiment.name = "late";
  experiment.duration = 10;
  experiment.hardware.pwm_steps = false;
  experiment.hardware.clock_error = 0;
  experiment.camera.fps = 50;
  experiment.robots.resize(1);
  experiment.robots[0].id = 1;
  experiment.robots[0].start = StartPose{0.3, 0.45, 0};
  return experiment;
}

TEST(LateTimer, FramesDoNotShowLaterEvents) {
  LateLoop loop;
  MemoryBus bus([&loop] { return loop.now(); });
  Node node(bus, loop, {"sim_svc", 0, 1});
  Node other(bus, loop, {"lab", 0, 1});
  std::vector<tracked_frame_t> frames;
  other.subscribe<tracked_frame_t>(
      channels::kTrackedFrame,
      [&frames](const tracked_frame_t& frame) { frames.push_back(frame); });
  const Experiment experiment = oneRobot();
  const SimService dut({node, loop, experiment, {}});
  const std::int64_t start = loop.now();

  robot_command_t drive{};
  drive.seq = 1;
  drive.lease_ms = 1000;
  drive.num_orders = 1;
  drive.orders.resize(1);
  drive.orders[0].mode = robot_order_t::DRIVE;
  drive.orders[0].robot_ids = {1};
  drive.orders[0].num_robots = 1;
  drive.orders[0].wheel_left = drive.orders[0].wheel_right = 0.1;
  other.publishCommand(channels::kRobotCommand, drive);
  bus.deliver();
  // The next event is a repeated command 95 ms later, when five frames are overdue.
  loop.moveTo(start + 95'000);
  other.publishCommand(channels::kRobotCommand, drive);
  bus.deliver();
  loop.runOnce();
  bus.deliver();

  ASSERT_EQ(frames.size(), 5U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].utime, start + static_cast<std::int64_t>(i) * 20'000);
    EXPECT_NEAR(frames[i].robots.at(0).x, 0.3 + 0.1 * 0.02 * static_cast<double>(i), 1e-9);
  }
}

TEST(LateTimer, AStallIsReportedOnceASecondWithAllItsFrames) {
  LateLoop loop;
  MemoryBus bus([&loop] { return loop.now(); });
  Node node(bus, loop, {"sim_svc", 0, 1});
  Node other(bus, loop, {"lab", 0, 1});
  std::vector<std::string> errors;
  other.subscribe<service_status_t>(
      channels::kServiceStatus,
      [&errors](const service_status_t& status) { errors.push_back(status.last_error); });
  const Experiment experiment = oneRobot();
  const SimService dut({node, loop, experiment, {}});
  const std::int64_t start = loop.now();
  robot_command_t drive{};
  drive.seq = 1;
  const auto wakeAt = [&](std::int64_t utime) {
    loop.moveTo(utime);
    other.publishCommand(channels::kRobotCommand, drive);
    bus.deliver();
    node.ready();  // a heartbeat
    bus.deliver();
  };

  wakeAt(start + 1'010'000);  // the frames of 800 ms are too old
  wakeAt(start + 1'510'000);  // those of a further 300 ms
  wakeAt(start + 2'030'000);

  ASSERT_EQ(errors.size(), 3U);
  EXPECT_EQ(errors[0], "stalled: 41 camera frames up to number 40 were skipped");
  EXPECT_EQ(errors[1], errors[0]) << "the next report is due a second later";
  EXPECT_EQ(errors[2], "stalled: 31 camera frames up to number 91 were skipped");
}

}  // namespace
}  // namespace lab::sim
