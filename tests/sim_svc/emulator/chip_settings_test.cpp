// The EEPROM with the firmware binary, including power failures during writes.
#include <gtest/gtest.h>

#include <cstdint>
#include <iostream>
#include <vector>

#include "tests/sim_svc/emulator/robot_on_chip.hpp"

namespace lab::emulator {
namespace {

constexpr std::int32_t kOldGain = 950000;
constexpr std::int32_t kNewGain = 1050000;

std::vector<std::uint8_t> oldStore() {
  firmware::Settings settings;
  settings.uid = kTestUid;
  settings.left.gain_ppm = kOldGain;
  return storeWith(settings);
}

std::int32_t gainOf(RobotOnChip& robot) {
  robot.forget();
  robot.send(wire::GetParam{wire::kGainLeft});
  robot.run(60);
  const auto value = robot.last<wire::ParamValue>();
  EXPECT_TRUE(value.has_value());
  return value ? value->value : 0;
}

TEST(ChipSettings, CommittedSettingsSurvivePowerOff) {
  RobotOnChip robot({}, oldStore());
  robot.start();
  EXPECT_EQ(gainOf(robot), kOldGain);
  for (int i = 0; i < 6; ++i) {
    const std::int32_t gain = kNewGain + i;
    robot.command(wire::SetParam{wire::kGainLeft, gain});
    const double before = robot.now();
    const auto writes = robot.chip().counts().eeprom_writes;
    EXPECT_EQ(robot.command(wire::Commit{}, 2000).status, wire::kOk);
    // Storing must take at least the write time of the chip's EEPROM.
    EXPECT_GE(robot.now() - before,
              3.4 * static_cast<double>(robot.chip().counts().eeprom_writes - writes - 1));
    robot.chip().switchOff();
    robot.run(100);
    robot.chip().switchOn();
    robot.run(50);
    EXPECT_EQ(gainOf(robot), gain);
  }
}

TEST(ChipSettings, UncommittedSettingsDoNotSurvivePowerOff) {
  RobotOnChip robot({}, oldStore());
  robot.start();
  robot.command(wire::SetParam{wire::kGainLeft, kNewGain});
  EXPECT_EQ(gainOf(robot), kNewGain);
  robot.chip().switchOff();
  robot.chip().switchOn();
  robot.run(50);
  EXPECT_EQ(gainOf(robot), kOldGain);
}

TEST(ChipSettings, ACorruptedEepromGivesDefaultsAndAnEvent) {
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    std::vector<std::uint8_t> image(kEepromSize, 0xFF);
    if (i > 0) {
      for (auto& byte : image) byte = static_cast<std::uint8_t>(random.next());
    }
    if (i > 10) {  // both banks with one bit wrong
      image = oldStore();
      for (const auto bank : firmware::kBankAddress) {
        const auto bit = static_cast<unsigned>(random.next() % (firmware::kBankSize * 8U));
        image[bank + bit / 8] = static_cast<std::uint8_t>(image[bank + bit / 8] ^ (1U << bit % 8));
      }
    }
    RobotOnChip robot({}, image);
    robot.chip().switchOn();
    robot.run(50);
    robot.send(wire::GetInfo{});
    robot.run(500);
    ASSERT_TRUE(robot.hadEvent(wire::kSettingsDefault)) << i;
    EXPECT_EQ(robot.last<wire::Hello>()->settings_from, firmware::kNoBank);
    EXPECT_EQ(robot.last<wire::Hello>()->uid, 0U);
    EXPECT_EQ(gainOf(robot), 1000000);
  }
}

TEST(ChipSettings, APowerFailureInAnyByteOfACommitLeavesOldOrNewSettings) {
  bool saw_old = false;
  bool saw_new = false;
  for (unsigned earlier = 0; earlier < 2; ++earlier) {  // each bank is the older one once
    for (std::uint32_t cut = 1;; ++cut) {
      ChipSettings chip;
      chip.seed = cut;
      RobotOnChip robot(chip, oldStore());
      robot.start();
      for (unsigned i = 0; i < earlier; ++i) {
        robot.command(wire::SetParam{wire::kWheelBase, 80000});
        ASSERT_EQ(robot.command(wire::Commit{}, 2000).status, wire::kOk);
      }
      robot.command(wire::SetParam{wire::kGainLeft, kNewGain});
      robot.chip().cutPowerInWrite(cut);
      robot.send(wire::Commit{});
      robot.run(600);
      if (robot.chip().power() != ChipPower::kOff) {
        ASSERT_GT(cut, firmware::kStoreDataSize / 2U);  // it did write
        break;
      }
      robot.chip().switchOn();
      robot.run(50);
      const std::int32_t gain = gainOf(robot);
      ASSERT_TRUE(gain == kOldGain || gain == kNewGain) << "cut in write " << cut << ": " << gain;
      saw_old = saw_old || gain == kOldGain;
      saw_new = saw_new || gain == kNewGain;
      robot.send(wire::GetInfo{});
      robot.run(60);
      EXPECT_EQ(robot.last<wire::Hello>()->uid, kTestUid);

      // Storing must work again.
      robot.command(wire::SetParam{wire::kGainLeft, kNewGain + 1});
      ASSERT_EQ(robot.command(wire::Commit{}, 2000).status, wire::kOk);
      robot.chip().switchOff();
      robot.chip().switchOn();
      robot.run(50);
      ASSERT_EQ(gainOf(robot), kNewGain + 1) << "cut in write " << cut;
    }
  }
  EXPECT_TRUE(saw_old);
  // The last byte makes the bank valid, so a cut there leaves the old settings, or the new ones if
  // the random value is the right one.
  std::cout << "after a cut: old settings " << saw_old << ", new settings " << saw_new << '\n';
}

TEST(ChipSettings, ADrivingRobotRefusesToStore) {
  RobotOnChip robot({}, oldStore());
  robot.start();
  robot.configure(fourPrograms());
  wire::Order drive = robot.order(wire::Order::kDrive);
  drive.left_um_s = 50000;
  robot.command(drive);
  EXPECT_EQ(robot.command(wire::Commit{}).status, wire::kBusy);
}

}  // namespace
}  // namespace lab::emulator
