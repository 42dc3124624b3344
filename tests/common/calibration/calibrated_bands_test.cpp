#include <gtest/gtest.h>

#include <string>

#include "common/bus/codec.hpp"
#include "common/calibration/light_file.hpp"
#include "common/experiment/experiment_messages.hpp"
#include "common/experiment/order_settings.hpp"
#include "tests/support/experiment_samples.hpp"

namespace lab::calibrated_bands_test {
namespace {

constexpr const char* kTwoBands = R"toml(
fileversion = 1
name = "calibrated"
duration_s = 60
[robot]
diameter_cm = 5
[[robots]]
id = 1
count = 150
[programs.abp]
model = "abp"
[programs.rtp]
model = "rtp"
[light_table]
bands = [{light = [0.2, 0.5], program = "abp"}, {light = [0.5, 1.0], program = "rtp"}]
[[light.steps]]
at_s = 0
layers = [{kind = "uniform", intensity = 0.3}]
)toml";

TEST(CalibratedBands, HaveByteCodeInEveryOrderAndTextsInTheFirst) {
  const Experiment experiment = parseExperiment(kTwoBands, "calibrated");
  LightCalibration calibration;
  calibration.gains[7] = {0.5, 0.5};

  const robot_command_t command = withCalibratedBands(lightTableCommand(experiment), calibration);

  ASSERT_EQ(command.orders.size(), 150U);
  EXPECT_EQ(command.orders[0].bands[1].program.text, experiment.programs.at("rtp").text);
  for (const robot_order_t& order : command.orders) {
    const OrderSettings settings = settingsFrom(order, dynamics::WheelLimits(), 0.02);
    ASSERT_EQ(settings.refusal, "");
    EXPECT_EQ(settings.core.programs[0], experiment.programs.at("abp").hash);
    EXPECT_EQ(settings.core.programs[1], experiment.programs.at("rtp").hash);
    EXPECT_EQ(order.bands[0].program.text.empty(), &order != &command.orders.front());
  }
  EXPECT_LT(command.orders[6].bands[0].high, command.orders[5].bands[0].high);
  EXPECT_LT(encode(command).size(), 60'000U) << "in one datagram";
}

}  // namespace
}  // namespace lab::calibrated_bands_test
