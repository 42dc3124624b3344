#include "dashboard/control/operator_request_reader.hpp"

#include <gtest/gtest.h>

namespace lab::dashboard {
namespace {

template <class T>
T read(const std::string& json) {
  const auto found = readOperatorRequest(json);
  if (const auto* invalid = std::get_if<InvalidRequest>(&found)) {
    ADD_FAILURE() << json << ": " << invalid->why;
    return {};
  }
  EXPECT_TRUE(std::holds_alternative<T>(std::get<OperatorRequest>(found))) << json;
  return std::get<T>(std::get<OperatorRequest>(found));
}

std::string why(const std::string& json) {
  const auto found = readOperatorRequest(json);
  const auto* invalid = std::get_if<InvalidRequest>(&found);
  return invalid ? invalid->why : "accepted";
}

TEST(OperatorRequestReader, ReadsEveryRequest) {
  EXPECT_EQ(read<StopRobots>(R"({"request":"stop","reason":"hand in the arena, \u00e4"})").reason,
            "hand in the arena, \xc3\xa4");
  read<ReleaseStop>(R"({"request":"release_stop"})");
  read<PauseScript>(R"({"request":"pause"})");
  read<ResumeScript>(R"({"request":"resume"})");
  EXPECT_EQ(read<MarkRun>(R"({"request":"mark","text":""})").text, "");
  EXPECT_EQ(read<EndRun>(R"({"why":"done","request":"end"})").why, "done");
  const auto light = read<ShowLight>(R"({"request":"light","intensity":1,"hold_s":2.5})");
  EXPECT_EQ(light.intensity, 1);
  EXPECT_EQ(light.hold, 2.5);
  read<ReleaseLight>(R"({"request":"release_light"})");
  EXPECT_EQ(read<SeekLog>(R"({"request":"seek","to_s":0})").to, 0);
  EXPECT_EQ(read<SpeedLog>(R"({"request":"speed","speed":10})").speed, 10);
}

TEST(OperatorRequestReader, SaysWhatWasFoundAndWhatWasExpected) {
  EXPECT_EQ(why(R"({"request":"mark"})"), "text: missing, expected a text");
  EXPECT_EQ(why(R"({"request":"mark","text":3})"), "text: found number, expected a text");
  EXPECT_EQ(why(R"({"request":"pause","x":1})"), "found the key \"x\", expected only request");
  EXPECT_EQ(why(R"({"request":"light","intensity":1.5,"hold_s":0})"),
            "intensity: found 1.5, expected a number from 0 to 1");
  EXPECT_EQ(why(R"({"request":"pause","request":"end"})"),
            "found \"request\" twice, expected it once");
  EXPECT_EQ(why("[]"), "found array, expected a JSON object");
}

TEST(OperatorRequestReader, AnInvalidReasonDoesNotPreventAStop) {
  EXPECT_EQ(read<StopRobots>(R"({"request":"stop"})").reason, "");
  EXPECT_EQ(read<StopRobots>(R"({"request":"stop","reason":3})").reason, "");
  EXPECT_EQ(read<StopRobots>(R"({"request":"stop","reason":"two\nlines"})").reason, "");
  const std::string huge(501, 'a');
  EXPECT_EQ(read<StopRobots>(R"({"request":"stop","reason":")" + huge + "\"}").reason, "");
}

TEST(OperatorRequestReader, CountsCharactersAndNotBytes) {
  std::string text;
  for (int i = 0; i < 500; ++i) text += "\xc3\xa4";
  EXPECT_EQ(read<MarkRun>(R"({"request":"mark","text":")" + text + "\"}").text, text);
  EXPECT_EQ(why(R"({"request":"mark","text":")" + text + "a\"}"),
            "text: found 501 characters, expected at most 500");
}

TEST(OperatorRequestReader, RefusesInvalidRequests) {
  const std::string deep = std::string(60000, '[');
  const std::string huge = R"({"request":"mark","text":")" + std::string(501, 'a') + "\"}";
  for (const std::string& json :
       {std::string(),
        std::string("{"),
        std::string("null"),
        std::string("{}"),
        deep,
        huge,
        std::string(R"({"request":null})"),
        std::string(R"({"request":"Stop","reason":""})"),
        std::string(R"({"request":"pause"} x)"),
        std::string("{\"request\":\"pause\"}\0", 17),
        std::string(R"({"request":"light","intensity":NaN,"hold_s":0})"),
        std::string(R"({"request":"light","intensity":1e999,"hold_s":0})"),
        std::string(R"({"request":"light","intensity":"1","hold_s":0})"),
        std::string(R"({"request":"light","intensity":true,"hold_s":0})"),
        std::string(R"({"request":"light","intensity":-0.01,"hold_s":0})"),
        std::string(R"({"request":"light","intensity":1,"hold_s":86401})"),
        std::string(R"({"request":"light","intensity":1})"),
        std::string(R"({"request":"seek","to_s":-1})"),
        std::string(R"({"request":"speed","speed":0})"),
        std::string("{\"request\":\"mark\",\"text\":\"\xff\"}"),
        std::string(R"({"request":"mark","text":"two\nlines"})"),
        std::string(R"({"request":"mark","text":{"a":[[[1]]]}})")}) {
    EXPECT_NE(why(json), "accepted") << json.substr(0, 80);
  }
}

}  // namespace
}  // namespace lab::dashboard
