#include "dds_gateway/ros/topic_mapping.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "common/experiment/experiment_file.hpp"

namespace lab::gateway {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

std::vector<std::string> problemsOf(const std::string& text) {
  try {
    static_cast<void>(TopicMapping(text, "m.toml"));
  } catch (const ExperimentError& error) {
    return error.problems();
  }
  return {};
}

TEST(TopicMapping, LetsEverythingPassWithoutAFile) {
  TopicMapping dut;
  const auto pose = dut.route("/lab/robot1/pose");
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->topic, "/lab/robot1/pose");
  EXPECT_EQ(pose->rate, 0);
  EXPECT_EQ(dut.route("/lab/light_field")->rate, 5);
  EXPECT_EQ(dut.route("/hall_2/light_field")->rate, 5);
}

TEST(TopicMapping, TheFirstRuleOfAWholeNameDecides) {
  TopicMapping dut(R"(
fileversion = 1
[[rules]]
topic = "/lab/(robot[0-9]+)/pose"
rename = "/fleet/$1/pose"
rate_hz = 10
[[rules]]
topic = "/lab/robot[0-9]+/.*"
allow = false
[[rules]]
topic = "/lab/robot3/odom"
)",
                   "m.toml");
  EXPECT_EQ(dut.route("/lab/robot12/pose")->topic, "/fleet/robot12/pose");
  EXPECT_EQ(dut.route("/lab/robot12/pose")->rate, 10);
  EXPECT_FALSE(dut.route("/lab/robot3/odom"));
  EXPECT_TRUE(dut.route("/lab/robot3")) << "not the whole name";
  EXPECT_TRUE(dut.route("/tf"));
}

TEST(TopicMapping, ValuesThatARuleDoesNotSetStay) {
  TopicMapping dut(R"(
fileversion = 1
[[rules]]
topic = "/lab/light_field"
rename = "/map"
)",
                   "m.toml");
  EXPECT_EQ(dut.route("/lab/light_field")->topic, "/map");
  EXPECT_EQ(dut.route("/lab/light_field")->rate, 5);
}

TEST(TopicMapping, ARenameThatRosDoesNotAcceptIsRefused) {
  TopicMapping dut(R"(
fileversion = 1
[[rules]]
topic = "/lab/robot([0-9]+)/pose"
rename = "/$1/pose"
)",
                   "m.toml");
  EXPECT_THROW(
      {
        try {
          static_cast<void>(dut.route("/lab/robot1/pose"));
        } catch (const std::runtime_error& error) {
          EXPECT_THAT(error.what(), HasSubstr("makes \"/1/pose\" of /lab/robot1/pose"));
          throw;
        }
      },
      std::runtime_error);
}

/// The error when these topics are requested in turn; empty: none.
std::string clashOf(const std::string& rules, const std::vector<std::string>& topics) {
  TopicMapping dut("fileversion = 1\n" + rules, "m.toml");
  try {
    for (const std::string& topic : topics) static_cast<void>(dut.route(topic));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(TopicMapping, TwoTopicsOfOneNameAreRefused) {
  const std::string both =
      "[[rules]]\ntopic = \"/lab/robot[0-9]+/pose\"\nrename = \"/fleet/pose\"\n";
  EXPECT_THAT(clashOf(both, {"/lab/robot1/pose", "/tf", "/lab/robot2/pose"}),
              StartsWith("m.toml:4: rules[0].rename: found that /lab/robot1/pose and "
                         "/lab/robot2/pose both become \"/fleet/pose\", expected a name of its"));
  // A rename to the name of an unrenamed topic fails, whichever is requested first.
  const std::string odom =
      "[[rules]]\ntopic = \"/lab/robot1/pose\"\nrename = \"/lab/robot1/odom\"\n";
  for (const auto& topics : {std::vector<std::string>{"/lab/robot1/pose", "/lab/robot1/odom"},
                             std::vector<std::string>{"/lab/robot1/odom", "/lab/robot1/pose"}}) {
    EXPECT_THAT(clashOf(odom, topics), StartsWith("m.toml:4: rules[0].rename: found that " +
                                                  topics[0] + " and " + topics[1]));
  }
  // A topic may be requested again, and a denied topic has no name.
  EXPECT_EQ(clashOf(both, {"/lab/robot1/pose", "/lab/robot1/pose"}), "");
  EXPECT_EQ(clashOf("[[rules]]\ntopic = \"/lab/robot2/.*\"\nallow = false\n" + both,
                    {"/lab/robot1/pose", "/lab/robot2/pose"}),
            "");
}

TEST(TopicMapping, ErrorsNameLineAndKey) {
  EXPECT_THAT(problemsOf(R"(fileversion = 2
[[rules]]
topic = "("
alow = true
[[rules]]
rate_hz = -1
[[rules]]
topic = "/x"
allow = 1
rename = "x"
)"),
              ElementsAre(StartsWith("m.toml:1: fileversion: found 2, expected 1"),
                          StartsWith("m.toml:3: rules[0].topic: found \"(\", expected a regular"),
                          StartsWith("m.toml:4: rules[0].alow: found an unknown key, expected one "
                                     "of allow, rate_hz, rename, topic"),
                          HasSubstr("rules[1].topic: found nothing, expected a regular"),
                          StartsWith("m.toml:6: rules[1].rate_hz: found -1, allowed 0"),
                          StartsWith("m.toml:9: rules[2].allow: found 1, expected true or false"),
                          StartsWith("m.toml:10: rules[2].rename: found \"x\", expected the new")));
  EXPECT_THAT(problemsOf("fileversion = 1\nrules = 3\n"),
              ElementsAre("m.toml:2: rules: found 3, expected [[rules]] tables"));
  EXPECT_THAT(problemsOf("fileversion = "), ElementsAre(StartsWith("m.toml:1")));
}

TEST(TopicMapping, ARenameNamesGroupsThatTopicHas) {
  EXPECT_THAT(problemsOf("fileversion = 1\n[[rules]]\ntopic = \"/lab/(.*)\"\nrename = \"/a$2\"\n"),
              ElementsAre("m.toml:4: rules[0].rename: found \"$2\" in \"/a$2\", expected $1 to $9: "
                          "topic has 1 groups in (...)"));
  EXPECT_THAT(problemsOf("fileversion = 1\n[[rules]]\ntopic = \"/lab/(.*)\"\nrename = \"/a$\"\n"),
              ElementsAre(HasSubstr("found \"$\" in")));
  TopicMapping dut(
      "fileversion = 1\n[[rules]]\ntopic = \"/lab/(a)?robot([0-9]+)/(.*)\"\n"
      "rename = \"/$3/x$1$2\"\n",
      "m.toml");
  EXPECT_EQ(dut.route("/lab/robot12/pose")->topic, "/pose/x12");
}

/// The regular expressions of the C++ library recurse for each bracket, and try each way to divide
/// a name. Such a file ended `lab check` with a fault, or never.
TEST(TopicMapping, PatternsOfAnyFormTakeBoundedTimeAndMemory) {
  const auto file = [](const std::string& pattern) {
    return "fileversion = 1\n[[rules]]\ntopic = \"" + pattern + "\"\nallow = false\n";
  };
  EXPECT_THAT(problemsOf(file(std::string(100'000, '('))),
              ElementsAre(HasSubstr("expected a regular expression (RE2)")));
  EXPECT_THAT(problemsOf(file("((((x{500}){500}){500}){500})")),
              ElementsAre(HasSubstr("expected a regular expression (RE2)")));
  TopicMapping dut(file("(/?[a-z]+)+!"), "m.toml");
  EXPECT_TRUE(dut.route("/" + std::string(200, 'a')));
}

TEST(TopicMapping, PatternsAreShort) {
  const auto file = [](std::size_t size) {
    return "fileversion = 1\n[[rules]]\ntopic = \"" + std::string(size, 'a') + "\"\n";
  };
  EXPECT_THAT(problemsOf(file(1000)), IsEmpty());
  EXPECT_THAT(problemsOf(file(1001)),
              ElementsAre(EndsWith("expected a regular expression (RE2): of at most 1000 bytes")));
}

/// 34 000 rules in a file of 1 MB took 14 GB.
TEST(TopicMapping, TheNumberOfRulesAndTheSizeOfEachAreBounded) {
  const auto file = [](std::size_t rules, const std::string& topic) {
    std::string text = "fileversion = 1\n";
    for (std::size_t i = 0; i < rules; ++i) text += "[[rules]]\ntopic = '" + topic + "'\n";
    return text;
  };
  EXPECT_THAT(problemsOf(file(200, "/lab/[a-z0-9_/]{300}")), IsEmpty());
  EXPECT_THAT(problemsOf(file(201, "/lab/[a-z0-9_/]{300}")),
              ElementsAre("m.toml:402: rules[200]: found 201 rules, allowed at most 200: one "
                          "pattern may match many topics"));
  EXPECT_THAT(problemsOf(file(1, "\\pL{20}0")),
              ElementsAre(AllOf(StartsWith("m.toml:3: rules[0].topic: found "),
                                HasSubstr("pattern too large"))));
}

TEST(TopicMapping, TheNumberOfTopicsIsBounded) {
  TopicMapping dut;
  for (std::size_t i = 0; i < TopicMapping::kMostTopics; ++i) {
    ASSERT_TRUE(dut.route("/lab/robot" + std::to_string(i) + "/pose"));
  }
  EXPECT_THROW(static_cast<void>(dut.route("/lab/one_more")), std::runtime_error);
  EXPECT_TRUE(dut.route("/lab/robot7/pose")) << "known ones pass";
}

TEST(TopicMapping, AMissingFileIsNamed) {
  EXPECT_THROW(static_cast<void>(readTopicMappingFile("/nowhere/m.toml")), ExperimentError);
}

}  // namespace
}  // namespace lab::gateway
