#include "common/schema/message_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/schema/schema.hpp"
#include "tests/lcmtypes/contract.hpp"

namespace lab::schema {
namespace message_table_test {

const Type& typeOf(const char* name) { return *messageSchema().find(name); }

const Column& column(const MessageTable& table, const std::string& name) {
  const auto found = std::ranges::find(table.columns(), name, &Column::name);
  if (found == table.columns().end()) throw std::out_of_range(name);
  return *found;
}

template <class Number>
std::vector<Number> numbers(const MessageTable& table, const std::string& name) {
  std::vector<Number> values(table.rows());
  std::memcpy(values.data(), column(table, name).values.data(), values.size() * sizeof(Number));
  return values;
}

std::vector<std::string> texts(const MessageTable& table, const std::string& name) {
  std::vector<std::string> values;
  for (const auto code : numbers<std::int32_t>(table, name)) {
    values.push_back(column(table, name).texts.texts()[static_cast<std::size_t>(code)]);
  }
  return values;
}

tracked_frame_t frameOf(std::int64_t utime, const std::vector<std::int32_t>& robots) {
  tracked_frame_t frame{};
  frame.utime = utime;
  frame.sender = "tracker";
  frame.frame = utime / 10;
  for (const std::int32_t id : robots) {
    tracked_pose_t pose{};
    pose.robot_id = id;
    pose.x = 0.5 * id;
    pose.covariance[2] = -id;
    pose.confidence = 0.25F;
    frame.robots.push_back(pose);
  }
  frame.num_robots = static_cast<std::int32_t>(robots.size());
  return frame;
}

TEST(MessageTable, HasARowPerMessage) {
  MessageTable dut(typeOf("tracked_frame_t"), "");

  EXPECT_TRUE(dut.take(3, 111, encode(frameOf(10, {1, 2}))));
  EXPECT_TRUE(dut.take(5, 222, encode(frameOf(20, {}))));

  EXPECT_EQ(dut.rows(), 2U);
  EXPECT_EQ(numbers<std::int64_t>(dut, "event"), (std::vector<std::int64_t>{3, 5}));
  EXPECT_EQ(numbers<std::int64_t>(dut, "received_utime"), (std::vector<std::int64_t>{111, 222}));
  EXPECT_EQ(numbers<std::int64_t>(dut, "utime"), (std::vector<std::int64_t>{10, 20}));
  EXPECT_EQ(numbers<std::int32_t>(dut, "num_robots"), (std::vector<std::int32_t>{2, 0}));
  EXPECT_EQ(texts(dut, "sender"), (std::vector<std::string>{"tracker", "tracker"}));
}

TEST(MessageTable, HasARowPerElementOfAList) {
  MessageTable dut(typeOf("tracked_frame_t"), "robots");

  ASSERT_TRUE(dut.take(0, 0, encode(frameOf(10, {7, 2}))));
  ASSERT_TRUE(dut.take(1, 0, encode(frameOf(20, {}))));
  ASSERT_TRUE(dut.take(2, 0, encode(frameOf(30, {4}))));

  EXPECT_EQ(numbers<std::int32_t>(dut, "robot_id"), (std::vector<std::int32_t>{7, 2, 4}));
  EXPECT_EQ(numbers<double>(dut, "x"), (std::vector<double>{3.5, 1, 2}));
  EXPECT_EQ(numbers<double>(dut, "covariance_xt"), (std::vector<double>{-7, -2, -4}));
  EXPECT_EQ(column(dut, "covariance_xt").unit, "m rad");
  EXPECT_EQ(numbers<float>(dut, "confidence"), (std::vector<float>(3, 0.25F)));
  EXPECT_EQ(numbers<std::int64_t>(dut, "utime"), (std::vector<std::int64_t>{10, 10, 30}));
  EXPECT_EQ(numbers<std::int64_t>(dut, "parent"), (std::vector<std::int64_t>{0, 0, 2}));
}

TEST(MessageTable, GoesIntoListsInLists) {
  analysis_t analysis{};
  for (const std::int32_t lags : {2, 0, 1}) {
    curve_t curve{};
    curve.name = "curve " + std::to_string(lags);
    curve.num_lags = lags;
    for (std::int32_t i = 0; i < lags; ++i) curve.lag.push_back(static_cast<float>(10 * lags + i));
    curve.value = curve.sigma = curve.exact = curve.paper = curve.lag;
    curve.windows.assign(curve.lag.size(), lags);
    curve.biased.assign(curve.lag.size(), 1);
    analysis.curves.push_back(curve);
  }
  analysis.num_curves = 3;
  MessageTable dut(typeOf("analysis_t"), "curves.lags");
  MessageTable curves(typeOf("analysis_t"), "curves");

  for (std::int64_t message = 0; message < 2; ++message) {
    ASSERT_TRUE(dut.take(message, 0, encode(analysis)));
    ASSERT_TRUE(curves.take(message, 0, encode(analysis)));
  }

  EXPECT_EQ(numbers<float>(dut, "lag"), (std::vector<float>{20, 21, 10, 20, 21, 10}));
  EXPECT_EQ(numbers<std::int32_t>(dut, "windows"), (std::vector<std::int32_t>{2, 2, 1, 2, 2, 1}));
  EXPECT_EQ(numbers<std::int64_t>(dut, "parent"), (std::vector<std::int64_t>{0, 0, 2, 3, 3, 5}));
  EXPECT_EQ(texts(curves, "name")[5], "curve 1");
}

TEST(MessageTable, GivesPartsTheirOwnUtimeAndThatOfTheMessage) {
  robot_status_t status{};
  status.utime = 100;
  status.robots.resize(1);
  status.robots[0].utime = 90;
  status.robots[0].program.name = "abp";
  status.num_robots = 1;
  MessageTable dut(typeOf("robot_status_t"), "robots");

  ASSERT_TRUE(dut.take(0, 0, encode(status)));

  EXPECT_EQ(numbers<std::int64_t>(dut, "utime"), (std::vector<std::int64_t>{90}));
  EXPECT_EQ(numbers<std::int64_t>(dut, "message_utime"), (std::vector<std::int64_t>{100}));
  EXPECT_EQ(texts(dut, "program_name"), (std::vector<std::string>{"abp"}));
}

TEST(MessageTable, IsUnchangedByADamagedMessage) {
  MessageTable dut(typeOf("tracked_frame_t"), "robots");
  ASSERT_TRUE(dut.take(0, 0, encode(frameOf(10, {1}))));
  std::vector<std::uint8_t> cut = encode(frameOf(20, {2, 3}));
  cut.resize(cut.size() - 20);
  std::vector<std::uint8_t> longer = encode(frameOf(20, {2, 3}));
  longer.push_back(0);
  const std::vector<std::uint8_t> other = encode(clock_t{});

  EXPECT_FALSE(dut.take(1, 0, cut));
  EXPECT_FALSE(dut.take(1, 0, longer));
  EXPECT_FALSE(dut.take(1, 0, other));
  EXPECT_FALSE(dut.take(1, 0, {}));
  ASSERT_TRUE(dut.take(2, 0, encode(frameOf(30, {4}))));

  EXPECT_EQ(numbers<std::int32_t>(dut, "robot_id"), (std::vector<std::int32_t>{1, 4}));
  EXPECT_EQ(numbers<std::int64_t>(dut, "parent"), (std::vector<std::int64_t>{0, 1}));
}

// What decode() refuses, the table refuses: every byte of every type is damaged in turn.
TEST(MessageTable, TakesWhatTheDecoderTakes) {
  forEachType(ChannelTypes{}, []<class Message>() {
    const std::vector<std::uint8_t> whole = encode(sample<Message>(3));
    for (std::size_t i = 8; i < whole.size(); i += 3) {
      std::vector<std::uint8_t> damaged = whole;
      damaged[i] ^= 0x81;
      Message message{};
      MessageTable dut(*messageSchema().find(Message::getTypeName()), "");
      ASSERT_EQ(dut.take(0, 0, damaged), decode(damaged, message))
          << Message::getTypeName() << " byte " << i;
    }
  });
}

TEST(MessageTable, LoadsOnlyTheColumnsThatAreWanted) {
  MessageTable dut(typeOf("tracked_frame_t"), "robots", std::vector<std::string>{"y", "robot_id"});

  ASSERT_TRUE(dut.take(0, 0, encode(frameOf(10, {5}))));

  EXPECT_EQ(dut.columns().size(), 2U);
  EXPECT_EQ(numbers<std::int32_t>(dut, "robot_id"), (std::vector<std::int32_t>{5}));
}

TEST(MessageTable, NamesTableAndColumnThatItDoesNotHave) {
  const Type& type = typeOf("tracked_frame_t");
  EXPECT_THROW(MessageTable(type, "robot"), std::invalid_argument);
  EXPECT_THROW(MessageTable(type, "", std::vector<std::string>{"x"}), std::invalid_argument);
}

TEST(MessageTable, ContinuesItsNumbersAfterClear) {
  MessageTable dut(typeOf("tracked_frame_t"), "robots");
  ASSERT_TRUE(dut.take(0, 0, encode(frameOf(10, {1, 2}))));

  dut.clear();
  ASSERT_TRUE(dut.take(1, 0, encode(frameOf(20, {3}))));

  EXPECT_EQ(numbers<std::int32_t>(dut, "robot_id"), (std::vector<std::int32_t>{3}));
  EXPECT_EQ(numbers<std::int64_t>(dut, "parent"), (std::vector<std::int64_t>{1}));
}

}  // namespace message_table_test
}  // namespace lab::schema
