#include "projector_ctl/replay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace lab::projector::replay_test {
namespace {

using light::Drive;
using light::DrivenLayer;
using light::Follow;
using light::Layer;
using light::LayerKind;

constexpr std::int64_t kStart = 1'000'000'000'000;  // [us]
constexpr std::int64_t kFrame_us = 16'667;

Layer disk() { return {.kind = LayerKind::kDisk, .size = 0.04, .intensity = 1}; }

std::vector<DrivenLayer> layers() {
  Drive trail;
  trail.follow = Follow::kTrail;
  trail.diffusion = 1e-4;
  trail.decay = 0.3;
  Drive spot;
  spot.follow = Follow::kRobots;
  return {{disk(), trail}, {disk(), spot}};
}

/// A minute of commands and camera frames, of which some come late, in bunches, or never; records
/// the inputs of the projector and its reports.
class ReplayTest : public testing::Test {
 protected:
  ReplayTest() {
    config.scene_context.robots = {1, 2};
    config.latency = 0.04;
  }

  void run(int pictures = 3600) {
    ProjectorCore core(config);
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> uniform;
    std::vector<std::pair<std::int64_t, ObservedFrame>> under_way;
    for (int i = 0; i < pictures; ++i) {
      const std::int64_t now = kStart + i * kFrame_us;
      for (const LightCommand& command : commands) {
        if (command.from_utime < now - kFrame_us || command.from_utime >= now) continue;
        EXPECT_EQ(core.apply(command, now).verdict, Verdict::kAccepted);
      }
      const auto delay = static_cast<std::int64_t>(60'000 * uniform(random));
      if (uniform(random) > 0.1) under_way.emplace_back(now + delay, frameAt(now, i));
      for (auto& [arrival, frame] : under_way) {
        if (arrival > now) continue;
        core.addFrame(frame);
        frames.push_back(frame);
        arrival = std::numeric_limits<std::int64_t>::max();
      }
      std::erase_if(under_way, [](const auto& entry) {
        return entry.first == std::numeric_limits<std::int64_t>::max();
      });
      const ShownFrame& shown = core.frame(now);
      ShownRecord& record = records.emplace_back();
      record.projector = 1;
      record.utime = shown.presentation_utime;
      record.latency = config.latency;
      record.commander = shown.commander;
      record.command_instance = shown.instance;
      record.command_seq = shown.seq;
      record.tracker_instance = shown.tracker_instance;
      record.tracked_frames = shown.tracked_frames;
      record.layers = shown.field.layers;
    }
  }

  static ObservedFrame frameAt(std::int64_t utime, int i) {
    const double t = 1e-6 * static_cast<double>(utime - kStart);
    return {4,
            i + 100,
            utime - 5000,
            {{1, 0.6 + 0.3 * std::cos(t), 0.45 + 0.3 * std::sin(t), t, 1e-7, 1e-4, 1},
             {2, 0.3, 0.3 + 0.02 * t, 1.57, 1e-7, 1e-4, 1}}};
  }

  /// Compares all fields for exact equality.
  static void expectSame(const std::vector<Layer>& found, const std::vector<Layer>& shown) {
    ASSERT_EQ(found.size(), shown.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      Layer a = found[i];
      Layer b = shown[i];
      ASSERT_EQ(a.pixels == nullptr, b.pixels == nullptr);
      if (a.pixels) {
        ASSERT_EQ(a.pixels->grey, b.pixels->grey);
      }
      a.pixels = b.pixels = nullptr;
      ASSERT_EQ(a, b);
    }
  }

  ProjectorCore::Config config;
  std::vector<LightCommand> commands{{.sender = "lab",
                                      .instance = 3,
                                      .seq = 1,
                                      .from_utime = kStart + 1'000'000,
                                      .hold_until_utime = kStart + 100'000'000,
                                      .layers = layers()},
                                     // By hand, over the script for a while.
                                     {.sender = "hand",
                                      .instance = 5,
                                      .seq = 1,
                                      .priority = 10,
                                      .from_utime = kStart + 20'000'000,
                                      .hold_until_utime = kStart + 25'000'000,
                                      .layers = {{Layer{.intensity = 0.5}, {}}}},
                                     // The next step, by a fade from the one before.
                                     {.sender = "lab",
                                      .instance = 3,
                                      .seq = 2,
                                      .from_utime = kStart + 40'000'000,
                                      .ramp = 2,
                                      .hold_until_utime = kStart + 100'000'000,
                                      .layers = layers()}};
  std::vector<ObservedFrame> frames;
  std::vector<ShownRecord> records;
};

TEST_F(ReplayTest, RecomputesTheFieldOfEveryStatusExactly) {
  run();
  Replay dut(config.scene_context);
  for (const LightCommand& command : commands) dut.add(command);
  for (const ObservedFrame& frame : frames) dut.add(frame);
  int compared = 0;
  int brightest = 0;
  for (const ShownRecord& record : records) {
    const auto found = dut.layersOf(record);
    ASSERT_EQ(found.has_value(), !record.commander.empty());
    if (!found) continue;
    expectSame(*found, record.layers);
    if (HasFatalFailure()) FAIL() << "at " << record.utime - kStart << " us";
    ++compared;
    if (record.layers[0].pixels) {
      brightest =
          std::max<int>(brightest, *std::ranges::max_element(record.layers[0].pixels->grey));
    }
  }
  EXPECT_GT(compared, 3500);
  EXPECT_GT(brightest, 200);
}

TEST_F(ReplayTest, IsEmptyIfTheLogLacksAFrame) {
  run(1200);
  Replay dut(config.scene_context);
  for (const LightCommand& command : commands) dut.add(command);
  frames.erase(frames.begin() + 500);
  for (const ObservedFrame& frame : frames) dut.add(frame);
  int without = 0;
  for (const ShownRecord& record : records) {
    if (!dut.layersOf(record) && !record.commander.empty()) ++without;
  }
  EXPECT_GT(without, 300);
}

TEST_F(ReplayTest, NeedsTheCommand) {
  run(300);
  Replay dut(config.scene_context);
  for (const ObservedFrame& frame : frames) dut.add(frame);
  for (const ShownRecord& record : records) ASSERT_FALSE(dut.layersOf(record).has_value());
}

}  // namespace
}  // namespace lab::projector::replay_test
