#include "dds_gateway/ros/ros_names.hpp"

#include <gtest/gtest.h>

namespace lab::gateway {
namespace {

TEST(RosNames, OfTopicsAreThoseThatRosAccepts) {
  for (const char* good : {"/tf", "/lab/robot1/pose", "/a/b_c", "/_x", "/A9"}) {
    EXPECT_TRUE(isTopicName(good)) << good;
  }
  for (const char* bad : {"", "/", "tf", "/lab/", "//lab", "/1lab", "/lab/7", "/lab/a__b", "/lab a",
                          "/l\xc3\xa4"
                          "b",
                          "/lab-1", "~/x", "/lab//x"}) {
    EXPECT_FALSE(isTopicName(bad)) << bad;
  }
  EXPECT_TRUE(isTopicName("/" + std::string(199, 'a')));
  EXPECT_FALSE(isTopicName("/" + std::string(200, 'a')));
}

TEST(RosNames, PartsAreMadeFromAnyText) {
  EXPECT_EQ(namePart("abp"), "abp");
  EXPECT_EQ(namePart("run-and-tumble (2)"), "run_and_tumble_2_");
  EXPECT_EQ(namePart("7th"), "_7th");
  EXPECT_EQ(namePart(""), "_");
  EXPECT_EQ(namePart("a--__b"), "a_b");
  for (const char* text : {"", "9", "__", "a b", "\xff\xfe", "/../x", "-9__"}) {
    EXPECT_TRUE(isTopicName("/" + namePart(text))) << text;
  }
}

TEST(RosNames, OfALabHaveItsPrefix) {
  const RosNames dut("lab");
  EXPECT_EQ(dut.topic("light_field"), "/lab/light_field");
  EXPECT_EQ(dut.topic(7, "pose"), "/lab/robot7/pose");
  EXPECT_EQ(dut.arenaFrame(), "lab/arena");
  EXPECT_EQ(dut.robotFrame(12), "lab/robot12");
  EXPECT_EQ(RosNames("2nd lab").topic("poses"), "/_2nd_lab/poses");
}

}  // namespace
}  // namespace lab::gateway
