// The tools behind robot_bridge --list and --set-uid.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <string>

#include "common/loop/virtual_loop.hpp"
#include "common/serial/memory_serial.hpp"
#include "robot_bridge/lines/line_survey.hpp"
#include "robot_bridge/lines/uid_writer.hpp"
#include "tests/support/wire_robot.hpp"

namespace lab::bridge {
namespace {

using testing::HasSubstr;

class LineToolsTest : public testing::Test {
 protected:
  WireRobot& addRobot(const std::string& line, std::uint32_t uid) {
    WireRobotOptions options;
    options.uid = uid;
    WireRobot& robot = robots.emplace_back(loop, ports, options);
    robot.plug(line);
    return robot;
  }

  template <class Tool>
  bool finish(Tool& tool) {
    for (int i = 0; i < 500; ++i) {
      if (tool.tick()) return true;
      loop.runUntil(loop.now() + 20'000);
    }
    return false;
  }

  VirtualLoop loop;
  MemorySerial ports{loop};
  std::deque<WireRobot> robots;
};

TEST_F(LineToolsTest, DistinguishesRobotsFromOtherDevices) {
  addRobot("a", 42);
  const auto silent = ports.offer("b");
  addRobot("c", 43);
  const auto held = ports.open("c", 38400);
  addRobot("d", 0);
  LineSurvey dut(loop, ports, {"a", "b", "c", "d", "e"}, 38400);
  ASSERT_TRUE(finish(dut));
  const auto rows = dut.rows();
  ASSERT_EQ(rows.size(), 5U);
  ASSERT_TRUE(rows[0].hello);
  EXPECT_EQ(rows[0].hello->uid, 42U);
  EXPECT_EQ(rows[0].finding, "");
  EXPECT_THAT(rows[1].finding, HasSubstr("no robot answers"));
  EXPECT_THAT(rows[2].finding, HasSubstr("in use by"));
  EXPECT_THAT(rows[3].finding, HasSubstr("--set-uid"));
  EXPECT_THAT(rows[4].finding, HasSubstr("not there"));
  const std::string text = surveyText(rows);
  EXPECT_THAT(text, HasSubstr("uid"));
  EXPECT_THAT(text, HasSubstr("42"));
  EXPECT_NO_THROW(static_cast<void>(ports.open("a", 38400))) << "the line is still open";
}

TEST_F(LineToolsTest, ShowsControlCharactersOfLinesAsText) {
  LineSurvey dut(loop, ports, {"\x1b[2J\na"}, 38400);
  ASSERT_TRUE(finish(dut));

  const std::string text = surveyText(dut.rows());

  EXPECT_THAT(text, HasSubstr("\n\\x1b[2J\\x0aa  "));
  EXPECT_EQ(std::ranges::count(text, '\n'), 2) << text;
  EXPECT_THAT(text, testing::Not(HasSubstr("\x1b")));
}

TEST_F(LineToolsTest, FindsARobotThatIsAlreadySending) {
  addRobot("a", 42);
  {
    LineSurvey first(loop, ports, {"a"}, 38400);
    ASSERT_TRUE(finish(first));
    UidWriter writer(loop, ports, "a", 38400, 42);
    ASSERT_TRUE(finish(writer));
  }
  LineSurvey again(loop, ports, {"a"}, 38400);
  ASSERT_TRUE(finish(again));
  EXPECT_TRUE(again.rows()[0].hello);
}

TEST_F(LineToolsTest, StoresAUidPermanently) {
  WireRobot& robot = addRobot("a", 0);
  UidWriter dut(loop, ports, "a", 38400, 0xFFFFFFFE);
  ASSERT_TRUE(finish(dut));
  EXPECT_EQ(dut.failure(), "");
  robot.boot(wire::kResetPower);
  EXPECT_EQ(robot.device().settings().uid, 0xFFFFFFFEU);
}

TEST_F(LineToolsTest, ReportsWhyAUidWasNotStored) {
  const auto silent = ports.offer("a");
  UidWriter dut(loop, ports, "a", 38400, 7);
  ASSERT_TRUE(finish(dut));
  EXPECT_THAT(dut.failure(), HasSubstr("a: no robot answers"));
}

TEST_F(LineToolsTest, DetectsARobotThatIsUnpluggedMeanwhile) {
  WireRobot& robot = addRobot("a", 0);
  UidWriter dut(loop, ports, "a", 38400, 7);
  loop.runUntil(loop.now() + 12'000);  // it has sent HELLO
  robot.switchOff();
  ASSERT_TRUE(finish(dut));
  EXPECT_THAT(dut.failure(), HasSubstr("a: "));
}

}  // namespace
}  // namespace lab::bridge
