#include "robot_bridge/protocol/command_sender.hpp"

#include <gtest/gtest.h>

namespace lab::bridge {
namespace {

using Due = CommandSender::Due;

constexpr std::int64_t kTimeout = 100;

wire::Frame commandOf(std::uint8_t type, std::uint8_t seq) {
  wire::Frame frame;
  frame.type = type;
  frame.seq = seq;
  return frame;
}

TEST(CommandSender, SendsAgainTwiceThenGivesUp) {
  CommandSender dut;
  EXPECT_EQ(dut.check(0), Due::kNothing);
  dut.begin(commandOf(0x14, 7), 0, kTimeout);
  EXPECT_EQ(dut.check(99), Due::kNothing);
  EXPECT_EQ(dut.check(100), Due::kSendAgain);
  EXPECT_EQ(dut.command().seq, 7);
  EXPECT_EQ(dut.check(150), Due::kNothing);
  EXPECT_EQ(dut.check(200), Due::kSendAgain);
  EXPECT_TRUE(dut.isWaiting());
  EXPECT_EQ(dut.check(300), Due::kGivenUp);
  EXPECT_FALSE(dut.isWaiting());
  EXPECT_EQ(dut.check(1000), Due::kNothing);
}

TEST(CommandSender, AcceptsOnlyTheMatchingAnswerAndOnlyOnce) {
  CommandSender dut;
  dut.begin(commandOf(0x14, 7), 0, kTimeout);
  EXPECT_FALSE(dut.answer(0x14, 6));
  EXPECT_FALSE(dut.answer(0x13, 7));
  EXPECT_TRUE(dut.answer(0x14, 7));
  EXPECT_FALSE(dut.answer(0x14, 7));
  EXPECT_EQ(dut.check(500), Due::kNothing);
}

TEST(CommandSender, AcceptsALateAnswer) {
  CommandSender dut;
  dut.begin(commandOf(0x14, 7), 0, kTimeout);
  for (const std::int64_t now : {100, 200, 300}) static_cast<void>(dut.check(now));
  dut.begin(commandOf(0x14, 8), 400, kTimeout);
  EXPECT_TRUE(dut.answer(0x14, 7));
  EXPECT_FALSE(dut.answer(0x14, 7));
  EXPECT_TRUE(dut.isWaiting());
  EXPECT_TRUE(dut.answer(0x14, 8));
}

TEST(CommandSender, ForgetRemovesAllCommands) {
  CommandSender dut;
  dut.begin(commandOf(0x14, 7), 0, kTimeout);
  for (const std::int64_t now : {100, 200, 300}) static_cast<void>(dut.check(now));
  dut.begin(commandOf(0x14, 8), 400, kTimeout);
  dut.forget();
  EXPECT_FALSE(dut.answer(0x14, 7));
  EXPECT_FALSE(dut.answer(0x14, 8));
}

}  // namespace
}  // namespace lab::bridge
