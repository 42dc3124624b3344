// The core on the host and the firmware on the host, with random programs and the shipped ones:
// every hold and every motor command is the same.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <deque>
#include <iostream>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "common/programs/shipped_programs.hpp"
#include "robot/wire/config.hpp"
#include "tests/robot/firmware/host_robot.hpp"
#include "tests/robot/programs.hpp"
#include "tests/robot/random_programs.hpp"

namespace lab::firmware {
namespace {

constexpr std::uint32_t kRunMs = 20000;

/// One hold as the core of the host began it.
struct Begun {
  std::uint32_t draw_count, at_ms, duration_ms, rng;
  dynamics::WheelSpeedsUmS held;
  std::uint8_t slot, phase;
};

struct Tally {
  std::uint64_t holds = 0;
  std::uint64_t interrupted = 0;
  std::uint64_t reversals = 0;
  std::uint64_t saturated = 0;
  std::uint64_t unsent = 0;  ///< STEPs for which the robot's queue had no room
  std::uint64_t motors = 0;  ///< milliseconds with equal motor commands
};

/// A core that gets the same scans, senses and orders as the firmware, without its wire.
class Comparison {
 public:
  Comparison(std::vector<std::vector<std::uint8_t>> programs, std::uint64_t seed)
      : random_(seed), core_(library_) {
    std::vector<std::uint8_t> image(kStoreSize, 0xFF);
    Settings calibrated;
    calibrated.uid = 42;
    encodeStore(calibrated, image.data());
    settings_.light.count = static_cast<std::uint8_t>(programs.size());
    for (std::uint8_t slot = 0; slot < programs.size(); ++slot) {
      const auto size = static_cast<std::uint8_t>(programs[slot].size());
      encodeProgram(programs[slot].data(), size, slot, image.data());
      settings_.programs[slot] = library_.add(programs[slot]);
      settings_.light.bands[slot] = {static_cast<std::uint16_t>(256 * slot),
                                     static_cast<std::uint16_t>(256 * (slot + 1)), slot};
    }
    settings_.reversal.enabled = below(2) == 0;
    settings_.reversal.distance_um = 50000;
    settings_.robot_id = static_cast<std::uint16_t>(below(2000));
    settings_.half_wheel_base_um = 20000 + static_cast<std::int32_t>(below(40000));
    settings_.sensor_period_ms = static_cast<std::uint16_t>(10 + below(20));
    robot_ = std::make_unique<HostRobot>(image);
  }

  void run(std::uint32_t ms, Tally& tally) {
    tell();
    while (robot_->now() < ms && !testing::Test::HasFailure()) {
      if (below(700) == 0) surroundings();
      if (below(400) == 0) senses();
      const std::uint32_t now = robot_->now() + 1;
      robot_->tick(sensors_);
      advance(now);
      if (robot_->scanned()) {
        const std::uint32_t draws = core_.record().draw_count;
        core_.sense(now, sensors_);
        record(draws);
        advance(now);
      }
      compareMotors(tally);
      compareSteps(tally);
    }
    EXPECT_EQ(robot_->refusals(), 0);
    EXPECT_EQ(robot_->device().core().rng().digest(), core_.rng().digest());
    EXPECT_EQ(robot_->device().core().runTimeMs(ms), core_.runTimeMs(ms));
    EXPECT_EQ(robot_->device().core().odometry().headingTurns(), core_.odometry().headingTurns());
    tally.reversals += core_.record().reversal_count;
    tally.saturated += core_.record().saturation_count;
  }

 private:
  unsigned below(unsigned count) { return static_cast<unsigned>(random_() % count); }

  /// The same commands to both.
  void tell() {
    for (std::uint8_t slot = 0; slot < dynamics::kSlots; ++slot) {
      robot_->receive(wire::programMessage(settings_, slot));
    }
    robot_->receive(wire::lightMessage(settings_));
    robot_->receive(wire::motionMessage(settings_));
    robot_->receive(wire::Apply{wire::configCrc(settings_)});
    core_.configure(robot_->now(), settings_);
    const auto seed = static_cast<std::uint32_t>(random_());
    robot_->receive(wire::SetSeed{1, seed});
    core_.seed(std::uint64_t{1} << 32 | seed);
    wire::Order order;
    order.mode = wire::Order::kTable;
    order.config = wire::configCrc(settings_);
    order.lease_ms = dynamics::RobotCore::kNoEventMs;
    robot_->receive(order);
    core_.runPrograms(robot_->now());
    core_.renewLease(robot_->now(), order.lease_ms);
    surroundings();
    senses();
    draws_before_ = core_.record().draw_count;
  }

  void surroundings() {
    if (below(3) == 0) {
      sensors_.light_front = static_cast<std::uint16_t>(below(1024));
      sensors_.light_back = static_cast<std::uint16_t>(below(1024));
    }
    sensors_.ir[below(dynamics::kIrSensors)] =
        static_cast<std::uint16_t>(below(4) == 0 ? below(1024) : 0);
  }

  void senses() {
    wire::SetSenses message;
    message.id = static_cast<std::uint8_t>(random_());
    for (std::int32_t& sense : message.sense) {
      sense = static_cast<std::int32_t>(static_cast<std::uint32_t>(random_())) >> below(28);
    }
    robot_->receive(message);
    advance(robot_->now());
    for (std::uint8_t i = 0; i < dynamics::kSenses; ++i) core_.setSense(i, message.sense[i]);
  }

  void advance(std::uint32_t now) {
    for (;;) {
      const std::uint32_t draws = core_.record().draw_count;
      if (!core_.advanceOne(now)) return;
      record(draws);
    }
  }

  void record(std::uint32_t draws_before) {
    const dynamics::CoreReport& report = core_.record();
    if (report.draw_count == draws_before) return;
    EXPECT_EQ(report.draw_count, draws_before + 1) << "more than one hold began in one call";
    begun_.push_back({report.draw_count, core_.holdStartMs(), core_.holdDurationMs(),
                      core_.rng().digest(), report.held, report.slot, report.phase});
  }

  void compareMotors(Tally& tally) {
    const dynamics::WheelSpeedsUmS wheels = core_.wheels();
    ASSERT_EQ(robot_->left(), dynamics::dutyForSpeed(wheels.left, settings_.max_wheel_um_s));
    ASSERT_EQ(robot_->right(), dynamics::dutyForSpeed(wheels.right, settings_.max_wheel_um_s));
    ++tally.motors;
  }

  void compareSteps(Tally& tally) {
    for (const wire::Step& step : robot_->steps()) {
      if (step.draw_count <= draws_before_) continue;  // standing, before the programs
      while (!begun_.empty() && begun_.front().draw_count < step.draw_count) {
        ++tally.unsent;
        begun_.pop_front();
      }
      ASSERT_FALSE(begun_.empty());
      const Begun begun = begun_.front();
      begun_.pop_front();
      ASSERT_EQ(step.draw_count, begun.draw_count);
      ASSERT_EQ(step.t_ms, begun.at_ms);
      ASSERT_EQ(step.duration_ms, begun.duration_ms);
      ASSERT_EQ(step.left_um_s, begun.held.left);
      ASSERT_EQ(step.right_um_s, begun.held.right);
      ASSERT_EQ(step.rng, begun.rng);
      ASSERT_EQ(step.slot, begun.slot);
      ASSERT_EQ(step.phase, begun.phase);
      tally.interrupted += step.t_ms < expected_ms_ ? 1U : 0U;
      expected_ms_ =
          step.duration_ms == dynamics::kEndless ? 0xFFFFFFFFU : step.t_ms + step.duration_ms;
      ++tally.holds;
    }
    robot_->steps().clear();
  }

  std::mt19937_64 random_;
  MemoryPrograms library_;
  dynamics::RobotCore core_;
  dynamics::CoreSettings settings_;
  dynamics::Sensors sensors_;
  std::unique_ptr<HostRobot> robot_;
  std::deque<Begun> begun_;
  std::uint32_t draws_before_ = 0;
  std::uint32_t expected_ms_ = 0;
};

/// In robot-seconds; the long tier sets it.
int secondsOr(int standard) {
  const char* seconds = std::getenv("LAB_ROBOT_SECONDS");
  return seconds == nullptr ? standard : std::atoi(seconds);
}

TEST(EqualMotion, OfCoreAndFirmwareWithRandomProgramsAndTheLibrary) {
  const int runs = secondsOr(20000) / static_cast<int>(kRunMs / 1000);
  RandomPrograms random(11);
  std::vector<std::vector<std::uint8_t>> library;
  for (const std::string& name : shippedProgramNames()) {
    library.push_back(shippedProgram(name).code);
  }
  Tally tally;
  for (int run = 0; run < runs && !testing::Test::HasFailure(); ++run) {
    std::vector<std::vector<std::uint8_t>> programs;
    for (std::size_t slot = 0; slot < dynamics::kSlots; ++slot) {
      const bool shipped = run % 8 == 7;
      programs.push_back(
          shipped ? library[(static_cast<std::size_t>(run) / 8 * 4 + slot) % library.size()]
                  : random.next());
    }
    Comparison comparison(std::move(programs), static_cast<std::uint64_t>(run));
    comparison.run(kRunMs, tally);
    EXPECT_FALSE(testing::Test::HasFailure()) << "run " << run;
  }
  std::cout << static_cast<unsigned>(runs) * (kRunMs / 1000) << " robot-seconds: " << tally.holds
            << " holds, " << tally.interrupted
            << " of them after an interruption or a change of the light, " << tally.reversals
            << " reversals, " << tally.saturated << " holds limited, " << tally.unsent
            << " STEPs without room, " << tally.motors << " ms with equal motors; "
            << random.rejected() << " programs drawn again\n";
  EXPECT_GT(tally.holds, static_cast<std::uint64_t>(runs) * 20);
  EXPECT_GT(tally.interrupted, static_cast<std::uint64_t>(runs));
  EXPECT_GT(tally.reversals, static_cast<std::uint64_t>(runs) / 10);
  EXPECT_GT(tally.saturated, static_cast<std::uint64_t>(runs));
  EXPECT_LT(tally.unsent, tally.holds / 20);
}

}  // namespace
}  // namespace lab::firmware
