#include "common/schema/ros_encoding.hpp"

#include <gtest/gtest.h>

#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/schema/schema.hpp"
#include "tests/lcmtypes/contract.hpp"

namespace lab::schema {
namespace ros_encoding_test {

// The rules of CDR applied by hand: a number stands at a multiple of its size after the header.
TEST(RosEncoding, EncodesByTheRulesOfCdr) {
  robot_stop_t stop{};
  stop.utime = 1;
  stop.sender = "ab";
  stop.instance = 2;
  stop.seq = 3;
  stop.clear = 1;
  stop.num_robots = 2;
  stop.robot_ids = {4, 5};
  stop.reason = "";

  const auto cdr = toCdr(*messageSchema().find("robot_stop_t"), encode(stop));

  const std::vector<std::uint8_t> expected{0, 1, 0, 0,                  // little-endian
                                           1, 0, 0, 0, 0,   0,   0, 0,  // utime
                                           3, 0, 0, 0, 'a', 'b', 0, 0,  // sender, padding
                                           2, 0, 0, 0, 0,   0,   0, 0,  // instance
                                           3, 0, 0, 0, 0,   0,   0, 0,  // seq
                                           1, 0, 0, 0,                  // clear, padding
                                           2, 0, 0, 0,                  // num_robots
                                           2, 0, 0, 0, 4,   0,   0, 0, 5, 0, 0, 0,  // robot_ids
                                           1, 0, 0, 0, 0};                          // reason
  ASSERT_TRUE(cdr.has_value());
  EXPECT_EQ(*cdr, expected);
}

TEST(RosEncoding, GivesEveryMessageBackUnchanged) {
  forEachType(ChannelTypes{}, []<class Message>() {
    const Type& type = *messageSchema().find(Message::getTypeName());
    for (const std::size_t length : {0U, 1U, 3U}) {
      const std::vector<std::uint8_t> lcm = encode(sample<Message>(length));
      const auto cdr = toCdr(type, lcm);
      ASSERT_TRUE(cdr.has_value()) << type.name;
      const auto back = fromCdr(type, *cdr);
      ASSERT_TRUE(back.has_value()) << type.name;
      EXPECT_EQ(*back, lcm) << type.name;
    }
  });
}

TEST(RosEncoding, RefusesDamagedMessages) {
  const Type& type = *messageSchema().find("tracked_frame_t");
  std::vector<std::uint8_t> lcm = encode(sample<tracked_frame_t>(2));
  std::vector<std::uint8_t> cdr = *toCdr(type, lcm);
  lcm.pop_back();
  EXPECT_FALSE(toCdr(type, lcm).has_value());
  EXPECT_FALSE(toCdr(type, encode(sample<clock_t>(0))).has_value());
  for (std::size_t size = 0; size + 4 < cdr.size(); ++size) {
    EXPECT_FALSE(fromCdr(type, Bytes(cdr).first(size)).has_value()) << size;
  }
}

// https://docs.ros.org/en/jazzy/Concepts/Basic/About-Interfaces.html
TEST(RosEncoding, DefinitionsFollowTheRulesOfRos) {
  const std::regex field(
      R"((bool|u?int(8|16|32|64)|float(32|64)|string|active_lab_bus/[A-Z]\w*)(\[\d*\])? ([a-z](_?[a-z0-9])*)(  #.*)?)");
  const std::regex constant(R"(int(8|16|32|64) [A-Z]([A-Z0-9_]*[A-Z0-9])?=-?\d+(  #.*)?)");
  const std::regex other(R"(#.*|=+|MSG: active_lab_bus/[A-Z][A-Za-z0-9]*)");
  for (const auto& type : messageSchema().types()) {
    std::istringstream lines(rosDefinition(*type));
    for (std::string line; std::getline(lines, line);) {
      EXPECT_TRUE(std::regex_match(line, field) || std::regex_match(line, constant) ||
                  std::regex_match(line, other))
          << type->name << ": " << line;
    }
    EXPECT_EQ(typeOfRosName(rosName(*type)), type.get());
  }
}

TEST(RosEncoding, DefinitionsHaveEveryPartOnce) {
  const std::string text = rosDefinition(*messageSchema().find("light_status_t"));
  const std::string part = "MSG: active_lab_bus/LightLayer\n";
  EXPECT_NE(text.find(part), std::string::npos);
  EXPECT_EQ(text.find(part), text.rfind(part));
}

}  // namespace ros_encoding_test
}  // namespace lab::schema
