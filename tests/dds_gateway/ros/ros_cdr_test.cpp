#include "dds_gateway/ros/ros_cdr.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "dds_gateway/ros/ros_definitions.hpp"
#include "tests/dds_gateway/ros/golden_messages.hpp"
#include "tests/dds_gateway/ros/type_description.hpp"

namespace lab::ros {
namespace ros_cdr_test {

template <class Message>
int compare() {
  int compared = 0;
  for (const GoldenMessage& golden : goldenMessages()) {
    if (golden.type != &rosType<Message>()) continue;
    // DDS fills the payload up to 4 bytes and says in the header by how many
    // (XTypes 1.3, 7.6.3.1.2).
    std::vector<std::uint8_t> expected = golden.payload;
    expected.resize(expected.size() - (expected.at(3) & 3U));
    expected[3] = 0;
    RosCdr cdr;
    EXPECT_EQ(cdr.encode(*static_cast<const Message*>(golden.sample)), expected)
        << golden.type->name;
    ++compared;
  }
  return compared;
}

// The bytes that DDS sends are the same, by tests/dds_gateway/ros/golden_bytes_test.cpp.
TEST(RosCdr, HasTheBytesThatWereComputedByHand) {
  EXPECT_GT(compare<String>(), 0);
  EXPECT_GT(compare<PoseStamped>(), 0);
  EXPECT_GT(compare<PoseArray>(), 0);
  EXPECT_GT(compare<TFMessage>(), 0);
  EXPECT_GT(compare<OccupancyGrid>(), 0);
  EXPECT_GT(compare<Illuminance>(), 0);
  EXPECT_GT(compare<Analysis>(), 0);
}

// Definitions that are read from the text of a .msg file have the hash that ROS 2 has for it.
TEST(RosDefinitions, HaveTheHashOfTheirMessage) {
  for (const RosType* type :
       {&rosType<PoseStamped>(), &rosType<PoseArray>(), &rosType<TFMessage>(),
        &rosType<OccupancyGrid>(), &rosType<Illuminance>(), &rosType<Analysis>()}) {
    const std::string name(type->name);
    std::string text = msgDefinition(name);
    Definitions all;
    std::string part = name;
    while (true) {
      const std::size_t end = text.find(std::string(80, '='));
      all[part] = fromMsg(text.substr(0, end), part.substr(0, part.find('/')));
      if (end == std::string::npos) break;
      text = text.substr(text.find("MSG: ", end) + 5);
      part = text.substr(0, text.find('\n'));
      part.insert(part.find('/'), "/msg");
      text = text.substr(text.find('\n') + 1);
    }
    EXPECT_EQ(typeHash(all, name), type->hash) << name;
  }
}

}  // namespace ros_cdr_test
}  // namespace lab::ros
