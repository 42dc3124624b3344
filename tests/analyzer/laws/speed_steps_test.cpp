// Motors whose speeds have 256 levels: 27 cm/s / 255 = 0.1059 cm/s apart.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "analyzer/laws/law_of.hpp"
#include "tests/analyzer/program_films.hpp"

namespace lab::analysis::speed_steps_test {
namespace {

constexpr double kStep = 0.27 / 255;  // m/s

RobotBody stepped() {
  RobotBody body;
  body.pwm_steps = true;
  return body;
}

SpeedSteps stepsOf(const Program& program) {
  return speedSteps(std::make_shared<const std::vector<std::uint8_t>>(program.code), stepped());
}

TEST(SpeedSteps, ShiftASpeedThatIsAlwaysTheSame) {
  const SpeedSteps dut = stepsOf(shippedProgram("rtp", {{"v", "5 cm/s"}}));
  const double nearest = std::round(0.05 / kStep) * kStep;  // 4.976 cm/s
  EXPECT_NEAR(dut.relative, nearest / 0.05 - 1, 2e-5);
  EXPECT_NEAR(dut.scatter, 0, 1e-12);
}

TEST(SpeedSteps, AverageOutOverDraws) {
  const SpeedSteps dut = stepsOf(shippedProgram("abp", {{"v", "3 cm/s"}, {"epsilon", "0.5 s"}}));
  EXPECT_LT(std::abs(dut.relative), 4 * dut.sigma);
  // Both wheels together have 6 cm/s = 56 2/3 steps, of which the motors make 57 (2/3) or 56 (1/3):
  // the mean of two wheels has the variance 2/9 / 4 of a step, once each hold.
  const double expected = kStep * kStep / 18 * 0.5;
  EXPECT_NEAR(dut.scatter, expected, 0.1 * expected);
}

TEST(SpeedSteps, TheLawHasTheSpeedOfTheMotors) {
  const Program program = shippedProgram("rtp", {{"v", "5 cm/s"}});
  RobotBody ideal = stepped();
  ideal.pwm_steps = false;
  EXPECT_EQ(lawOf(program, ideal)->meanSpeed(), 0.05);
  EXPECT_NEAR(lawOf(program, stepped())->meanSpeed(), 0.0497647, 2e-6);

  const Program abp = shippedProgram("abp", {{"v", "3 cm/s"}});
  EXPECT_EQ(lawOf(abp, stepped())->meanSpeed(), 0.03);
  EXPECT_GT(lawOf(abp, stepped()).speedScatter(), 0);
  EXPECT_EQ(lawOf(abp, ideal).speedScatter(), 0);
}

}  // namespace
}  // namespace lab::analysis::speed_steps_test
