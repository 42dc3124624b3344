#include "common/experiment/order_settings.hpp"

#include <gmock/gmock.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "common/experiment/program_messages.hpp"
#include "common/math/units.hpp"
#include "common/programs/program.hpp"
#include "common/programs/shipped_programs.hpp"
#include "robot/dynamics/byte_code.hpp"
#include "tests/support/programs.hpp"

namespace lab {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
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
  abp.program = toMessage(test::abp(0.03, 0.5, 3));
  light_band_t rtp{};
  rtp.low = 0.5;
  rtp.high = 1;
  rtp.program = toMessage(test::rtp(0.05, 3, 0.5));
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
  EXPECT_EQ(dut.core.programs[0], test::abp(0.03, 0.5, 3).hash);
  EXPECT_EQ(dut.core.programs[1], test::rtp(0.05, 3, 0.5).hash);
  ASSERT_EQ(dut.programs.size(), 2U);
  EXPECT_EQ(dut.programs[0].code, test::abp(0.03, 0.5, 3).code);
  EXPECT_EQ(dut.programs[1].id.name, "rtp");
  EXPECT_EQ(dut.core.max_wheel_um_s, 270'000);
  EXPECT_EQ(dut.core.half_wheel_base_um, 37'500);
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

TEST(OrderSettings, AcceptsAProgramThatStands) {
  robot_order_t order = table();
  order.bands[0].program = {};

  const OrderSettings dut = settingsFrom(order, dynamics::WheelLimits(), 0.02);

  EXPECT_EQ(dut.refusal, "");
  EXPECT_EQ(dut.core.programs[0], 0U);
  EXPECT_NE(dut.core.programs[1], 0U);
}

TEST(OrderSettings, RefusesByteCodeThatNoRobotCanExecute) {
  robot_order_t order = table();
  order.bands[1].program.code.pop_back();
  EXPECT_THAT(refusalOf(order),
              AllOf(StartsWith("program \"rtp\": its byte code has fault "), HasSubstr(" at byte "),
                    EndsWith("send what this version's compiler writes")));
  order = table();
  order.bands[1].program.code.clear();
  EXPECT_THAT(refusalOf(order), HasSubstr("its byte code has fault "));
  order = table();
  order.bands[1].program.code.assign(dynamics::kLargestProgram + 1, 0);
  EXPECT_THAT(refusalOf(order), HasSubstr("its byte code has fault "));
  // 65536 + a valid length: a size of 16 bits must not wrap.
  order = table();
  order.bands[1].program.code.resize(0x10000 + order.bands[1].program.code.size());
  EXPECT_THAT(refusalOf(order), HasSubstr("its byte code has fault "));
}

TEST(OrderSettings, RefusesByteCodeWithAnotherHash) {
  robot_order_t order = table();
  order.bands[0].program.id.hash += 1;
  EXPECT_EQ(refusalOf(order), "program \"abp\": its hash is not that of its byte code");
  order.bands[0].program.id.hash = 0;
  EXPECT_EQ(refusalOf(order), "program \"abp\": its hash is not that of its byte code");
  // The same 32 bits in a number of 64.
  order = table();
  order.bands[0].program.id.hash += 0x1'0000'0000;
  EXPECT_EQ(refusalOf(order), "program \"abp\": its hash is not that of its byte code");
}

TEST(OrderSettings, RefusesWhatAFileMayNotContain) {
  robot_order_t order = table();
  order.bands[0].program = toMessage(shippedProgram("abp", {{"v", "40 cm/s"}}, kWidestWheels));
  EXPECT_THAT(refusalOf(order), AllOf(StartsWith("program \"abp\":"),
                                      HasSubstr("phases.run: found a wheel speed of "),
                                      HasSubstr("expected at most 27 cm/s")));
  // As a robot with a slightly wider base may have it: limited and counted there.
  order.bands[0].program = toMessage(shippedProgram("abp", {{"v", "15.5 cm/s"}}, kWidestWheels));
  EXPECT_EQ(settingsFrom(order, {0.27, 0.078}, 0.02).refusal, "");

  order = table();
  std::string& text = order.bands[0].program.text;
  text.replace(text.find("3 rad/s"), 7, "-1 rad/s");
  EXPECT_THAT(refusalOf(order), HasSubstr("the draw begins above its end"));
  order.bands[0].program.text = "[phases.run]\nforward = \"1 cm/s\"\nhold = \"1 s\"\n";
  EXPECT_EQ(
      refusalOf(order),
      "program \"abp\": its text does not compile to its byte code; send both of one program");
  // Where an order before had the text, there is none.
  order.bands[0].program.text.clear();
  EXPECT_EQ(refusalOf(order), "");
}

TEST(OrderSettings, RefusesANameThatNoProgramOfAFileHas) {
  robot_order_t order = table();
  order.bands[1].program.id.name = std::string(kLongestProgramName, 'a');
  EXPECT_EQ(refusalOf(order), "");
  const std::string expected =
      "\": found a name that no program of a file has, expected 1 to 32 letters, digits, _ and -, "
      "beginning with a letter or digit";
  order.bands[1].program.id.name += 'a';
  EXPECT_EQ(refusalOf(order), "program \"" + std::string(32, 'a') + expected);
  for (const char* name : {"", "-a", "two words", "\x1b[2J", "a\nb"}) {
    order.bands[1].program.id.name = name;
    EXPECT_THAT(refusalOf(order), EndsWith(expected)) << name;
    EXPECT_THAT(refusalOf(order), Not(ContainsRegex("[\x1b\n]")));
  }
  // Reports repeat the name of a program without byte code, too.
  order.bands[1].program = {};
  order.bands[1].program.id.name = std::string(6'000'000, 'a');
  EXPECT_EQ(refusalOf(order), "program \"" + std::string(32, 'a') + expected);
}

TEST(OrderSettings, NamesTheProgramThatIsRefusedThoughAnotherHasTheSameText) {
  robot_order_t order = table();
  order.bands[0].program.text = "[phases.run]\nforward = \"1 cm/s\"\nhold = \"2 s\"\n";
  for (const std::string name : {"first", "second"}) {
    order.bands[0].program.id.name = name;
    EXPECT_THAT(refusalOf(order),
                StartsWith("program \"" + name + "\": its text does not compile"));
  }
}

TEST(OrderSettings, RefusesALongTextBeforeItIsRead) {
  robot_order_t order = table();
  order.bands[0].program.text.insert(0, "#" + std::string(100'000, 'x') + "\n");
  EXPECT_EQ(
      refusalOf(order),
      "program \"abp\": found a text of more than 100000 bytes, allowed at most 100000; leave "
      "out its comments");
}

TEST(OrderSettings, HasNeitherTextsNorParameters) {
  const OrderSettings dut = settingsFrom(table(), dynamics::WheelLimits(), 0.02);
  ASSERT_EQ(dut.programs.size(), 2U);
  for (const program_t& program : dut.programs) {
    EXPECT_EQ(program.text, "");
    EXPECT_TRUE(program.parameters.empty());
    EXPECT_EQ(program.size, static_cast<std::int16_t>(program.code.size()));
  }
}

/// An order of many megabytes.
robot_order_t hugeOrder() {
  robot_order_t order = table();
  order.robot_ids.assign(900'000, 100'000);
  order.num_robots = 900'000;
  program_t& program = order.bands[0].program;
  program.id.name = std::string(1'000'000, 'a');
  program.text = std::string(4'000'000, '#');
  program.code.resize(32'767);
  program.parameters.resize(32'767);
  order.bands.resize(127);
  for (std::size_t i = 2; i < order.bands.size(); ++i) {
    order.bands[i].program.text = std::string(50'000, '#');
  }
  return order;
}

TEST(OrderToKeep, IsSmallWhateverTheOrderHolds) {
  const robot_order_t kept = orderToKeep(hugeOrder(), 3);
  EXPECT_LT(kept.getEncodedSize(), 500'000);
  EXPECT_THAT(kept.robot_ids, testing::ElementsAre(3));
  EXPECT_EQ(kept.bands.size(), 127U);
}

TEST(OrderToKeep, GivesTheSameSettings) {
  const robot_order_t order = table();
  const OrderSettings kept = settingsFrom(orderToKeep(order, 3), dynamics::WheelLimits(), 0.02);
  const OrderSettings direct = settingsFrom(order, dynamics::WheelLimits(), 0.02);
  ASSERT_EQ(kept.refusal, "");
  EXPECT_TRUE(kept.core == direct.core);
  ASSERT_EQ(kept.programs.size(), direct.programs.size());
  for (std::size_t i = 0; i < kept.programs.size(); ++i) {
    EXPECT_EQ(kept.programs[i].id.name, direct.programs[i].id.name);
    EXPECT_EQ(kept.programs[i].code, direct.programs[i].code);
  }
}

TEST(OrderToKeep, IsRefusedForTheSameReason) {
  const auto expectSame = [](const robot_order_t& order) {
    const std::string refusal = refusalOf(order);
    EXPECT_NE(refusal, "");
    EXPECT_EQ(refusalOf(orderToKeep(order, 3)), refusal);
  };
  expectSame(hugeOrder());
  robot_order_t order = table();
  order.bands[0].program.code.resize(32'767);
  expectSame(order);
  order = table();
  order.bands[0].program.id.name = std::string(1'000'000, 'a');
  expectSame(order);
  order = table();
  order.bands[0].program.text = std::string(4'000'000, '#');
  expectSame(order);
  order = table();
  order.bands[0].program.id.hash += 1;
  expectSame(order);
  order = table();
  order.bands[1].low = kNan;
  expectSame(order);
  order = table();
  order.light_sensor = 3;
  expectSame(order);
  order = table();
  order.hysteresis = kNan;
  expectSame(order);
  order = table();
  order.reverse_speed = 1e-9;
  expectSame(order);
  order = table();
  order.reverse_distance = 5;
  expectSame(order);
  order = {};
  order.mode = robot_order_t::DRIVE;
  order.robot_ids = {3};
  order.wheel_left = 1;
  expectSame(order);
  order.wheel_left = 0;
  order.wheel_right = 1;
  expectSame(order);
}

TEST(OrderSettings, NoChangedByteOfAProgramIsAccepted) {
  const robot_order_t order = table();
  for (std::size_t i = 0; i < order.bands[1].program.code.size(); ++i) {
    robot_order_t damaged = order;
    damaged.bands[1].program.code[i] ^= 0x10;
    EXPECT_NE(refusalOf(damaged), "") << "byte " << i;
  }
}

TEST(OrderSettings, RefusesInvalidNumbersSensorsAndBands) {
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
