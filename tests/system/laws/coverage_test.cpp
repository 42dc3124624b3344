// Coverage of the confidence intervals: short recordings through the whole analysis. The 95 %
// intervals must contain the programmed value in about 95 % of them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "analyzer/service/analysis.hpp"
#include "tests/support/world_fixture.hpp"
#include "tests/system/laws/reference_set.hpp"
#include "tests/system/laws/world_recording.hpp"

namespace lab::system_test {
namespace {

using analysis::ProgramKind;
using analysis::ProgramLaw;

/// Uniform light, relative to full scale.
class UniformLight : public sim::LightSampler {
 public:
  void set(double level) { level_ = level; }
  [[nodiscard]] double at(double, double) const override { return level_; }

 private:
  double level_ = 0;
};

// The programs, the bands and the light of experiments/light_switching.toml.
struct Step {
  double light;
  dynamics::LightBand band;
  ProgramLaw law;
};

std::array<Step, 3> lightSwitching() {
  ProgramLaw bp{dynamics::RobotProgram{.kind = ProgramKind::kBp, .V = 0.07, .epsilon = 0.2}};
  ProgramLaw abp{
      dynamics::RobotProgram{.kind = ProgramKind::kAbp, .v = 0.03, .epsilon = 0.5, .eta = 3}};
  ProgramLaw rtp{
      dynamics::RobotProgram{.kind = ProgramKind::kRtp, .v = 0.05, .gamma = 3, .tau_t = 0.5}};
  return {Step{0.2, {102, 358, 0}, bp}, Step{0.5, {409, 665, 1}, abp},
          Step{0.9, {716, 1024, 2}, rtp}};
}

dynamics::CoreSettings settingsOf(const std::array<Step, 3>& steps) {
  dynamics::CoreSettings settings;
  settings.light.count = static_cast<std::uint8_t>(steps.size());
  settings.light.hysteresis = 20;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    settings.light.bands[i] = steps[i].band;
    settings.programs[i] = paramsOf(steps[i].law);
  }
  return settings;
}

/// One recording with 30 s of each program and a good tracker. The robot has exact wheels and a
/// clock error of 0.5 %.
std::vector<analysis::ProgramResult> recordSwitching(std::uint64_t seed) {
  constexpr std::int64_t kBoot = sim::kSecond;
  constexpr std::int64_t kStep = 30 * sim::kSecond;
  const std::array<Step, 3> steps = lightSwitching();
  sim::WorldSettings settings;
  settings.pwm_steps = false;
  settings.seed = seed;
  sim::World world(settings, sim::robotAt(0.60, 0.45, 0));
  UniformLight light;
  world.setLight(&light);
  world.advanceTo(kBoot);
  sim::startAll(world, settingsOf(steps));

  analysis::Analysis result{analysis::AnalysisConfig{}};
  RecordingSettings recording;
  recording.position_noise = 0.0003;
  recording.heading_noise = 0.6 * std::numbers::pi / 180;
  recording.noise_seed = deriveSeed(seed, 1, "tracker noise");
  recording.start_us = kBoot;
  WorldRecording recorder(world, recording);
  std::int64_t end = kBoot;
  for (const Step& step : steps) {
    light.set(step.light);
    end += kStep;
    recorder.recordUntil(
        end,
        [&](const analysis::TrackPoint& p) {
          result.addFrame(
              {p.time, p.frame, {{1, p.x, p.y, p.theta, p.sigma, p.sigma_theta, p.valid}}});
        },
        [&](const analysis::RobotTelemetry& telemetry) {
          const bool runs = telemetry.program >= 0;
          const ProgramLaw law =
              runs ? steps[static_cast<std::size_t>(telemetry.program)].law : ProgramLaw{};
          result.addTelemetry(1, law, telemetry);
        });
  }
  result.flush();
  return result.results();
}

struct Count {
  int recordings = 0;  ///< in which the estimate was determined
  int covered = 0;     ///< whose interval contains the programmed value
};

/// Counts by program and estimate.
std::map<std::pair<ProgramKind, std::string>, Count> countIntervals(int recordings) {
  std::map<std::pair<ProgramKind, std::string>, Count> counts;
  for (int i = 0; i < recordings; ++i) {
    for (const analysis::ProgramResult& result : recordSwitching(deriveSeed(1, i, "short films"))) {
      if (result.robot != analysis::kPool) {
        continue;
      }
      for (const analysis::Estimate& estimate : result.estimates) {
        if (!std::isfinite(estimate.value)) {
          continue;
        }
        Count& count = counts[{result.law.kind, estimate.name}];
        ++count.recordings;
        count.covered += estimate.low95 <= estimate.theory && estimate.theory <= estimate.high95;
      }
    }
  }
  return counts;
}

TEST(Coverage, IntervalsContainTheProgrammedValues) {
  constexpr int kRecordings = 500;
  const auto counts = countIntervals(kRecordings);
  const std::map<ProgramKind, std::vector<std::string>> expected = {
      {ProgramKind::kBp, {"D_r", "v", "V", "D_t", "D"}},
      {ProgramKind::kAbp, {"D_r", "v", "D", "L_s"}},
      {ProgramKind::kRtp, {"v", "gamma", "tau_r", "D", "L_s"}}};
  for (const auto& [kind, names] : expected) {
    for (const std::string& name : names) {
      const Count count = counts.at({kind, name});
      const double share = static_cast<double>(count.covered) / count.recordings;
      std::printf("program %d %-6s %d of %d intervals (%.1f %%)\n", static_cast<int>(kind),
                  name.c_str(), count.covered, count.recordings, 100 * share);
      EXPECT_EQ(count.recordings, kRecordings) << name;
      EXPECT_GE(share, 0.90) << name;
      EXPECT_LE(share, 0.98) << name;
    }
  }
}

}  // namespace
}  // namespace lab::system_test
