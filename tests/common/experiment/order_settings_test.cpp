#include "common/experiment/order_settings.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "common/math/units.hpp"

namespace lab {
namespace {

using units::kNan;

/// ABP below half light, RTP from there to full light.
robot_order_t table() {
  robot_order_t order{};
  order.mode = robot_order_t::TABLE;
  order.hysteresis = 0.02;
  order.reverse_on = robot_order_t::REVERSE_WALLS;
  order.reverse_distance = 0.4;
  order.reverse_speed = 0.1;
  light_band_t abp{};
  abp.low = 0.1;
  abp.high = 0.5;
  abp.program.kind = program_t::ABP;
  abp.program.v = 0.03;
  abp.program.epsilon = 0.5;
  abp.program.eta = 3;
  light_band_t rtp{};
  rtp.low = 0.5;
  rtp.high = 1;
  rtp.program.kind = program_t::RTP;
  rtp.program.v = 0.05;
  rtp.program.gamma = 3;
  rtp.program.tau_t = 0.5;
  order.bands = {abp, rtp};
  order.num_bands = 2;
  return order;
}

std::string refusalOf(const robot_order_t& order) {
  return settingsFrom(order, dynamics::WheelLimits(), 0.02).refusal;
}

TEST(OrderSettings, ConvertsAnOrderToTheRobotsIntegers) {
  const OrderSettings dut = settingsFrom(table(), dynamics::WheelLimits(), 0.02);
  ASSERT_EQ(dut.refusal, "");
  EXPECT_EQ(dut.core.programs[0].speed_um_s, 30'000);
  EXPECT_EQ(dut.core.programs[0].amplitude_um_s, 112'500);
  EXPECT_EQ(dut.core.programs[0].hold_ms, 500U);
  EXPECT_EQ(dut.core.programs[1].tumble_ms, 500U);
  EXPECT_EQ(dut.core.light.hysteresis, 20);
  EXPECT_EQ(dut.core.reversal.distance_um, 400'000U);
  EXPECT_EQ(dut.core.sensor_period_ms, 20);
}

TEST(OrderSettings, ABandUpToFullLightContainsFullLightAndSharedEdgesBelongToTheUpperBand) {
  dynamics::LightTable dut;
  dut.configure(settingsFrom(table(), dynamics::WheelLimits(), 0.02).core.light);
  EXPECT_EQ(dut.update(1023, 1023), 1);
  dut.configure(settingsFrom(table(), dynamics::WheelLimits(), 0.02).core.light);
  EXPECT_EQ(dut.update(512, 512), 1) << "0.5 reads 512 counts";
  dut.configure(settingsFrom(table(), dynamics::WheelLimits(), 0.02).core.light);
  EXPECT_EQ(dut.update(511, 511), 0);
}

TEST(OrderSettings, RefusesWhatTheWheelsCannotDo) {
  robot_order_t order = table();
  order.bands[0].program.eta = 9;
  EXPECT_NE(refusalOf(order).find("27"), std::string::npos) << refusalOf(order);
}

TEST(OrderSettings, RefusesInvalidNumbersSensorsAndPrograms) {
  robot_order_t order = table();
  order.hysteresis = kNan;
  EXPECT_NE(refusalOf(order), "");
  order = table();
  order.bands[1].low = kNan;
  EXPECT_NE(refusalOf(order), "");
  order = table();
  order.light_sensor = -1;
  EXPECT_NE(refusalOf(order), "");
  order = table();
  order.bands[0].program.kind = 99;
  EXPECT_NE(refusalOf(order), "");
  order = table();
  order.bands[1].low = 0.4;
  EXPECT_NE(refusalOf(order).find("overlap"), std::string::npos);
  order = table();
  order.bands.insert(order.bands.end(), 3, order.bands[0]);
  EXPECT_NE(refusalOf(order).find("at most 4"), std::string::npos);
}

TEST(OrderSettings, RefusesToDriveTooFastOrAtNan) {
  robot_order_t order{};
  order.mode = robot_order_t::DRIVE;
  order.wheel_left = 0.27;
  order.wheel_right = -0.27;
  EXPECT_EQ(refusalOf(order), "");
  order.wheel_left = 0.28;
  EXPECT_NE(refusalOf(order), "");
  order.wheel_left = kNan;
  EXPECT_NE(refusalOf(order), "");
}

TEST(OrderSettings, RefusesAReversalThatRoundsToNoSpeed) {
  robot_order_t order = table();
  order.reverse_speed = 1e-9;
  EXPECT_NE(refusalOf(order), "");
  order.reverse_speed = 1e-6;
  EXPECT_EQ(refusalOf(order), "");
}

}  // namespace
}  // namespace lab
