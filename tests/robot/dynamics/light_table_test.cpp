#include "robot/dynamics/light_table.hpp"

#include <gtest/gtest.h>

namespace lab::dynamics {
namespace {

LightSettings twoBands(uint16_t hysteresis) {
  LightSettings settings;
  settings.count = 2;
  settings.bands[0] = LightBand{100, 400, 2};
  settings.bands[1] = LightBand{400, 1024, 0};
  settings.hysteresis = hysteresis;
  return settings;
}

TEST(LightTable, SelectsNothingBeforeTheFirstReadingAndOutsideEveryBand) {
  LightTable dut;
  dut.configure(twoBands(0));
  EXPECT_EQ(dut.slot(), kNoSlot);
  EXPECT_EQ(dut.update(99, 99), kNoSlot);
}

TEST(LightTable, AdjacentBandsShareAnEdgeWithoutOverlap) {
  LightTable dut;
  dut.configure(twoBands(0));
  EXPECT_EQ(dut.update(100, 100), 2);
  EXPECT_EQ(dut.update(399, 399), 2);
  EXPECT_EQ(dut.update(400, 400), 0);
  EXPECT_EQ(dut.update(1023, 1023), 0);
}

TEST(LightTable, KeepsItsBandInsideTheHysteresis) {
  LightTable dut;
  dut.configure(twoBands(10));
  EXPECT_EQ(dut.update(399, 399), 2);
  EXPECT_EQ(dut.update(409, 409), 2);
  EXPECT_EQ(dut.update(410, 410), 0);
  EXPECT_EQ(dut.update(390, 390), 0);
  EXPECT_EQ(dut.update(389, 389), 2);
  EXPECT_EQ(dut.update(90, 90), 2);
  EXPECT_EQ(dut.update(89, 89), kNoSlot);
  EXPECT_EQ(dut.update(99, 99), kNoSlot) << "hysteresis only widens the current band";
}

TEST(LightTable, HysteresisWiderThanTheBandStillKeepsIt) {
  LightTable dut;
  dut.configure(twoBands(200));
  EXPECT_EQ(dut.update(100, 100), 2);
  EXPECT_EQ(dut.update(0, 0), 2);
}

TEST(LightTable, UsesTheConfiguredSensor) {
  LightTable dut;
  LightSettings settings = twoBands(0);
  dut.configure(settings);
  EXPECT_EQ(dut.reading(100, 501), 301) << "the mean is rounded half up";
  settings.reading = kFrontLight;
  dut.configure(settings);
  EXPECT_EQ(dut.update(100, 1000), 2);
  settings.reading = kBackLight;
  dut.configure(settings);
  EXPECT_EQ(dut.update(100, 1000), 0);
}

TEST(LightSettings, RejectsInvalidTables) {
  EXPECT_TRUE(isValid(LightSettings()));
  EXPECT_TRUE(isValid(twoBands(10)));
  LightSettings overlapping = twoBands(0);
  overlapping.bands[1].low = 399;
  EXPECT_FALSE(isValid(overlapping));
  LightSettings empty = twoBands(0);
  empty.bands[0].high = 100;
  EXPECT_FALSE(isValid(empty));
  LightSettings too_bright = twoBands(0);
  too_bright.bands[1].high = 1025;
  EXPECT_FALSE(isValid(too_bright));
  LightSettings bad_slot = twoBands(0);
  bad_slot.bands[1].slot = 4;
  EXPECT_FALSE(isValid(bad_slot));
  LightSettings too_many = twoBands(0);
  too_many.count = 5;
  EXPECT_FALSE(isValid(too_many));
}

}  // namespace
}  // namespace lab::dynamics
