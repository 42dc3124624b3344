// Loading of programs of motion into the chip.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <iostream>
#include <vector>

#include "common/math/random.hpp"
#include "tests/sim_svc/emulator/chip_programs_of_any_bytes.hpp"
#include "tests/sim_svc/emulator/robot_on_chip.hpp"

namespace lab::emulator {
namespace {

using Code = std::vector<std::uint8_t>;

std::uint32_t hashOfCode(const Code& code) {
  return dynamics::programHash(code.data(), static_cast<std::uint8_t>(code.size()));
}

TEST(ChipLoading, OfTheLargestProgramTakesLessThanASecond) {
  RobotOnChip robot;
  robot.start();
  robot.run(500);
  const Code code = programOfSize(dynamics::kLargestProgram, 7);
  const double begin = robot.now();
  EXPECT_EQ(robot.load(code).status, wire::kOk);
  const double took = robot.now() - begin;
  std::cout << "loading 176 bytes: " << took << " ms\n";
  EXPECT_LT(took, 1000);
  EXPECT_GT(took, 3.4 * dynamics::kLargestProgram) << "the EEPROM takes 3.4 ms a byte";
  EXPECT_EQ(robot.programs().hash[0], hashOfCode(code));
}

TEST(ChipLoading, APowerCutLeavesTheOldProgramTheNewOneOrNone) {
  const Code old = programOfSize(176, 1);
  Code fresh = programOfSize(176, 2);
  std::replace(fresh.begin(), fresh.end(), std::uint8_t{dynamics::kNegate},
               std::uint8_t{dynamics::kAbs});
  std::vector<std::uint8_t> image = storeWithUid(kTestUid);
  for (std::uint8_t place = 0; place < firmware::ProgramStore::kPlaces; ++place) {
    Code other = programOfSize(100, static_cast<std::uint8_t>(10 + place));
    firmware::encodeProgram(other.data(), 100, place, image.data());
  }
  firmware::encodeProgram(old.data(), 176, 0, image.data());
  Random random(5);
  int olds = 0;
  int news = 0;
  for (int i = 0; i < 60; ++i) {
    RobotOnChip robot({}, image);
    robot.start();
    const wire::Programs before = robot.programs();
    EXPECT_EQ(before.hash[0], hashOfCode(old));
    robot.command(wire::LoadBegin{hashOfCode(fresh), 176});
    for (std::uint8_t at = 0; at < 176; at = static_cast<std::uint8_t>(at + 32)) {
      wire::LoadData data;
      data.offset = at;
      std::copy(fresh.begin() + at, fresh.begin() + std::min(at + 32, 176), data.code);
      robot.command(data);
    }
    robot.send(wire::LoadEnd{hashOfCode(fresh)});
    robot.run(800 * random.uniform());
    RobotOnChip again({}, robot.chip().eeprom());
    again.start();
    const wire::Programs after = again.programs();
    EXPECT_TRUE(after.hash[0] == hashOfCode(old) || after.hash[0] == hashOfCode(fresh) ||
                after.hash[0] == 0);
    olds += after.hash[0] == hashOfCode(old) ? 1 : 0;
    news += after.hash[0] == hashOfCode(fresh) ? 1 : 0;
    for (int place = 1; place < firmware::ProgramStore::kPlaces; ++place) {
      EXPECT_EQ(after.hash[place], before.hash[place]);
    }
  }
  std::cout << "after a cut: old program " << olds << ", new program " << news << ", none "
            << 60 - olds - news << "\n";
  EXPECT_GT(news, 0);
  EXPECT_LT(olds + news, 60);
}

// chip_motion_long_test.cpp loads 10^4.
TEST(ChipLoading, AnyBytesAreRefusedOrExecuted) { loadAnyBytes(4, 200); }

}  // namespace
}  // namespace lab::emulator
