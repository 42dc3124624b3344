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
  Program program;
  ProgramLaw law = analysis::lawOf(program, analysis::kPaperWheelBase);
};

std::array<Step, 3> lightSwitching() {
  return {Step{.light = 0.2, .band = {102, 358, 0}, .program = test::bp(0.07, 0.2)},
          Step{.light = 0.5, .band = {409, 665, 1}, .program = test::abp(0.03, 0.5, 3)},
          Step{.light = 0.9, .band = {716, 1024, 2}, .program = test::rtp(0.05, 3, 0.5)}};
}

dynamics::CoreSettings settingsOf(const std::array<Step, 3>& steps) {
  dynamics::CoreSettings settings;
  settings.light.count = static_cast<std::uint8_t>(steps.size());
  settings.light.hysteresis = 20;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    settings.light.bands[i] = steps[i].band;
    settings.programs[i] = sim::always(steps[i].program).programs[0];
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
std::map<std::pair<std::string, std::string>, Count> countIntervals(int recordings) {
  std::map<std::pair<std::string, std::string>, Count> counts;
  for (int i = 0; i < recordings; ++i) {
    for (const analysis::ProgramResult& result : recordSwitching(deriveSeed(1, i, "short films"))) {
      if (result.robot != analysis::kPool) {
        continue;
      }
      for (const analysis::Estimate& estimate : result.estimates) {
        if (!std::isfinite(estimate.value)) {
          continue;
        }
        Count& count = counts[{result.law->name(), estimate.name}];
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
  const std::map<std::string, std::vector<std::string>> expected = {
      {"bp", {"D_r", "v", "V", "D_t", "D"}},
      {"abp", {"D_r", "v", "D", "L_s"}},
      {"rtp", {"v", "gamma", "tau_r", "D", "L_s"}}};
  for (const auto& [law, names] : expected) {
    for (const std::string& name : names) {
      const Count count = counts.at({law, name});
      const double share = static_cast<double>(count.covered) / count.recordings;
      std::printf("%s %-6s %d of %d intervals (%.1f %%)\n", law.c_str(), name.c_str(),
                  count.covered, count.recordings, 100 * share);
      EXPECT_EQ(count.recordings, kRecordings) << name;
      EXPECT_GE(share, 0.90) << name;
      EXPECT_LE(share, 0.98) << name;
    }
  }
}

}  // namespace
}  // namespace lab::system_test
