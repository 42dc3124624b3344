#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <lab/robot_status_t.hpp>
#include <map>
#include <string>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/calibration/light_file.hpp"
#include "tests/support/lab_process.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A projector far from linear and uniform.
constexpr double kGamma = 2.2;
constexpr double kVignetting = 0.25;  // [1] at the corners

constexpr const char* kDimLab = R"(
fileversion = 1
name = "dim"
seed = 8
duration_s = 40
[[robots]]
id = 1
count = 4
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
bands = [{light = [0.3, 0.5], program = "slow"}, {light = [0.5, 0.7], program = "fast"}]
[[light.steps]]
label = "slow"
at_s = 0
layers = [{kind = "uniform", intensity = 0.4}]
[[light.steps]]
label = "fast"
at_s = 20
layers = [{kind = "uniform", intensity = 0.6}]
[robot]
light_gain_error_percent = 5
light_noise_percent = 0.2
[projector]
gamma = 2.2
vignetting_percent = 25
[camera]
fps = 20
)";

class CalibrateLight : public testing::Test {
 protected:
  CalibrateLight() { std::ofstream(folder_.path() / "dim.toml") << kDimLab; }

  [[nodiscard]] fs::path calibration() const { return folder_.path() / "light.json"; }

  Finished calibrate(const std::string& more = "") {
    return run("lab calibrate light " + (folder_.path() / "dim.toml").string() +
               " --virtual-time --out " + calibration().string() + " --runs " +
               (folder_.path() / "calibrations").string() + " " + more);
  }

  [[nodiscard]] fs::path lastRun() const {
    return folder_.path() / ("run" + std::to_string(runs_));
  }

  /// Share of the status reports, in the middle of each light, with the wrong program.
  double wrongShare(const std::string& more) {
    ++runs_;
    const fs::path out = lastRun();
    const Finished finished = run("lab run " + (folder_.path() / "dim.toml").string() +
                                  " --virtual-time --out " + out.string() + " " + more);
    EXPECT_EQ(finished.exit_code, 0) << finished.output;
    int all = 0;
    int wrong = 0;
    std::int64_t first = 0;
    readLog({onlyRun(out) / "log.lcmlog"}, [&](const Packet& packet) {
      robot_status_t status{};
      if (packet.channel != channels::kRobotStatus || !decode(packet.data, status)) return;
      for (const robot_state_t& robot : status.robots) {
        if (first == 0) first = robot.utime;
        const double time = static_cast<double>(robot.utime - first) * 1e-6;
        const bool early = time > 4 && time < 18;
        if (!early && !(time > 24 && time < 38)) continue;
        const char* wanted = early ? "slow" : "fast";
        ++all;
        wrong += robot.program.name == wanted ? 0 : 1;
      }
    });
    EXPECT_GT(all, 1000);
    return static_cast<double>(wrong) / std::max(all, 1);
  }

 private:
  TemporaryFolder folder_;
  int runs_ = 0;
};

TEST_F(CalibrateLight, PredictsTheSensorsWithinTwoPercentOfFullScale) {
  const Finished finished = calibrate();
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("gamma"));
  EXPECT_THAT(finished.output, HasSubstr("outside the band"));
  const LightCalibration found = readLightFile(calibration());
  EXPECT_EQ(found.gains.size(), 4U);
  const optics::ProjectorTone tone = found.tone();
  double worst = 0;
  double sum = 0;
  for (const auto& [robot, gains] : found.gains) sum += gains.front + gains.back;
  EXPECT_NEAR(sum / 8, 1, 0.01);
  for (double x = 0.05; x < 1.2; x += 0.1) {
    for (double y = 0.05; y < 0.9; y += 0.1) {
      const double a = 2 * x / 1.2 - 1;
      const double b = 2 * y / 0.9 - 1;
      const double white = 1 - kVignetting * (a * a + b * b) / 2;
      for (const double value : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        // The scale is undetermined: the mean gain of the sensors is only near 1.
        const double truth = white * std::pow(value, kGamma);
        const double predicted =
            (found.ambient + found.scale * tone.light(value, {x, y})) / found.scale;
        worst = std::max(worst, std::abs(predicted - truth));
      }
    }
  }
  EXPECT_LT(worst, 0.02) << "of full scale";
}

TEST_F(CalibrateLight, AlsoMeasuresWithTheCamera) {
  const Finished finished = calibrate("--camera --rounds 2");
  ASSERT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("agrees with the robots' 2."));
  EXPECT_THAT(finished.output, testing::Not(HasSubstr("a shadow, a stain")));
  const auto at = finished.output.find("camera   gamma ");
  ASSERT_NE(at, std::string::npos) << finished.output;
  EXPECT_NEAR(std::stod(finished.output.substr(at + 15)), kGamma, 0.02);
}

TEST_F(CalibrateLight, MakesTheLightSelectTheIntendedProgram) {
  ASSERT_EQ(calibrate().exit_code, 0);
  EXPECT_GT(wrongShare(""), 0.5);
  EXPECT_EQ(wrongShare("--set 'projector.light_calibration=\"" + calibration().string() + "\"'"),
            0);
  // The report of the second run is made from its log alone.
  fs::rename(calibration(), calibration().string() + ".away");
  const fs::path folder = onlyRun(lastRun());
  ASSERT_EQ(run("lab analyze --no-figures --no-bootstrap " + folder.string()).exit_code, 0);
  EXPECT_THAT(readFile(folder / "report.html"), HasSubstr("<h2>Light bands</h2>"));
  const nlohmann::json bands = readJson(folder / "summary.json").at("light_bands").at("bands");
  ASSERT_EQ(bands.size(), 2U);
  for (const auto& band : bands) {
    EXPECT_GT(band.at("margin_in_sigmas").get<double>(), 5);
    EXPECT_EQ(band.at("without_calibration").size(), 24U);
  }
  // Without the calibration, gamma moves the light 0.4 below the band, most in the corners.
  double in_corner = 0;
  double in_middle = 0;
  for (const auto& place : bands[0].at("without_calibration")) {
    EXPECT_GT(place.at("chance_wrong").get<double>(), 0.99);
    const double x = place.at("x_cm");
    const double y = place.at("y_cm");
    if (x < 11 && y < 12) in_corner = place.at("reading");
    if (std::abs(x - 50) < 1 && std::abs(y - 34) < 1) in_middle = place.at("reading");
  }
  EXPECT_GT(in_corner, 0);
  EXPECT_LT(in_corner, 0.9 * in_middle);
}

TEST_F(CalibrateLight, RefusesAnExistingOutputWithoutForce) {
  EXPECT_THAT(calibrate("--rounds 1 --set duration_s=30").output, HasSubstr("rounds"));
  std::ofstream(calibration()) << "{}";
  const Finished existing = calibrate();
  EXPECT_EQ(existing.exit_code, 2);
  EXPECT_THAT(existing.output,
              HasSubstr("is there already; choose another name, or --force to replace it"));
}

}  // namespace
}  // namespace lab::system_test
