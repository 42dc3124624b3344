#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

#include "tests/support/lab_process.hpp"

namespace lab::system_test {
namespace {

constexpr double kFrame_ms = 25;  // camera at 40 fps
constexpr double kDisplayFrame_ms = 1000.0 / 60;
constexpr double kLatency_ms = 40;
constexpr double kSensor_ms = 20;
constexpr double kExposure_ms = 10;

constexpr const char* kSteps = R"(
fileversion = 1
name = "delivery"
seed = 3
duration_s = 16
[[robots]]
id = 1
[[robots]]
id = 2
[programs.slow]
model = "abp"
v_cm_s = 3
epsilon_s = 0.5
eta_rad_s = 3
[programs.fast]
model = "abp"
v_cm_s = 9
epsilon_s = 0.5
eta_rad_s = 3
[light_table]
bands = [{light = [0.2, 0.5], program = "slow"}, {light = [0.5, 1.0], program = "fast"}]
[light]
repeat = true
[[light.steps]]
label = "dim"
hold_s = 1.23
layers = [{kind = "uniform", intensity = 0.3}]
[[light.steps]]
label = "bright"
hold_s = 1.37
layers = [{kind = "uniform", intensity = 0.9}]
[[light.steps]]
label = "moving"
hold_s = 0.91
layers = [{kind = "wave", period_cm = 30, speed_cm_s = 10, intensity = 0.9, intensity2 = 0.3}]
[projector]
latency_ms = 40
[camera]
tracker = "camera"
camera = "sim"
fps = 40
width_px = 640
height_px = 360
exposure_ms = 10
)";

/// Time from the command to the event `key` [ms].
double after(const nlohmann::json& step, const char* key) {
  return 1000 * (step.at(key).get<double>() - step.at("commanded_s").get<double>());
}

TEST(Delivery, FourTimesOfEveryStepAreConsistent) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "delivery.toml") << kSteps;
  const Finished finished = run("lab run " + (folder.path() / "delivery.toml").string() +
                                    " --virtual-time --out " + (folder.path() / "runs").string(),
                                std::chrono::seconds(120));
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  std::ifstream file(onlyRun(folder.path() / "runs") / "summary.json");
  const nlohmann::json summary = nlohmann::json::parse(file);
  int seen = 0;
  int acted = 0;
  int steps = 0;
  for (const nlohmann::json& step : summary.at("steps")) {
    ++steps;
    ASSERT_TRUE(step.at("presented_s").is_number()) << step;
    const double presented = after(step, "presented_s");
    EXPECT_GE(presented, kLatency_ms) << step;
    EXPECT_LE(presented, kLatency_ms + kDisplayFrame_ms + 1) << step;
    if (step.at("seen_s").is_number()) {
      ++seen;
      EXPECT_GE(after(step, "seen_s"), presented) << step;
      EXPECT_LE(after(step, "seen_s"), presented + kFrame_ms + kExposure_ms) << step;
    }
    if (step.at("first_acted_s").is_number()) {
      ++acted;
      EXPECT_GE(after(step, "first_acted_s"), presented) << step;
      EXPECT_LE(after(step, "first_acted_s"), presented + kSensor_ms + 2) << step;
    }
  }
  EXPECT_GE(steps, 12);
  EXPECT_GE(seen, steps - 2);
  EXPECT_GE(acted, 6);
  EXPECT_EQ(summary.at("latency").at("seen").at("steps"), seen);
  EXPECT_TRUE(summary.at("latency").at("seen").at("p95_ms").is_number());
}

}  // namespace
}  // namespace lab::system_test
