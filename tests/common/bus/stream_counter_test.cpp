#include "common/bus/stream_counter.hpp"

#include <gtest/gtest.h>

#include "common/bus/channels.hpp"
#include "common/bus/count_limits.hpp"

namespace lab {
namespace {

constexpr std::string_view kChannel = channels::kRobotStatus;

StreamCount heard(std::initializer_list<std::int64_t> seqs, std::string_view channel = kChannel) {
  StreamCounter dut;
  for (const std::int64_t seq : seqs) dut.count(channel, "sim_svc", 1, seq, 1000 + seq);
  return dut.streams().begin()->second;
}

TEST(StreamCounter, CountsReceivedMessages) {
  const StreamCount stream = heard({1, 2, 3});
  EXPECT_EQ(stream.received, 3);
  EXPECT_EQ(stream.lost, 0);
  EXPECT_EQ(stream.first_seq, 1);
  EXPECT_EQ(stream.last_seq, 3);
  EXPECT_EQ(stream.last_utime, 1003);
}

TEST(StreamCounter, CountsGapsAsLost) { EXPECT_EQ(heard({1, 2, 5, 9}).lost, 2 + 3); }

TEST(StreamCounter, DoesNotCountMessagesBeforeTheFirstReceivedOne) {
  EXPECT_EQ(heard({1000, 1001}).lost, 0);
  EXPECT_EQ(heard({1000, 999, 1001}).lost, 0);
}

TEST(StreamCounter, ReducesTheLostCountByALateMessage) {
  EXPECT_EQ(heard({1, 2, 4, 3}).lost, 0);
  EXPECT_EQ(heard({1, 5, 3}).lost, 2);
  EXPECT_EQ(heard({1, 64, 2}).lost, 61);
  EXPECT_EQ(heard({1, 5, 3, 6}).last_seq, 6);
}

TEST(StreamCounter, IgnoresDuplicates) {
  EXPECT_EQ(heard({1, 2, 4, 2}).lost, 1);
  EXPECT_EQ(heard({1, 2, 4, 4}).lost, 1);
  EXPECT_EQ(heard({1, 4, 3, 3}).lost, 1);
}

TEST(StreamCounter, KeepsMessagesLostThatAreMoreThan63Behind) {
  EXPECT_EQ(heard({1, 66, 2}).lost, 64);
  EXPECT_EQ(heard({1, 1000, 2}).lost, 998);
}

TEST(StreamCounter, CountsNoGapsOfCommands) {  // a repeated command keeps its seq
  for (const std::string_view channel :
       {channels::kRobotCommand, channels::kRobotStop, channels::kLightCommand}) {
    const StreamCount stream = heard({1, 1, 5, 5}, channel);
    EXPECT_EQ(stream.received, 4);
    EXPECT_EQ(stream.lost, 0);
    EXPECT_EQ(stream.last_seq, 5);
  }
}

TEST(StreamCounter, SeparatesChannelsSendersAndInstances) {
  StreamCounter dut;
  for (std::int64_t seq = 1; seq <= 3; ++seq) {
    dut.count(kChannel, "sim_svc", 1, seq, 0);
    dut.count(kChannel, "sim_svc", 2, 2 * seq, 0);
    dut.count(kChannel, "robot_bridge", 1, 3 * seq, 0);
    dut.count(channels::kSimTruth, "sim_svc", 1, 4 * seq, 0);
  }
  ASSERT_EQ(dut.streams().size(), 4U);
  EXPECT_EQ(dut.streams().at({std::string(kChannel), "sim_svc", 1}).lost, 0);
  EXPECT_EQ(dut.streams().at({std::string(kChannel), "sim_svc", 2}).lost, 2);
  EXPECT_EQ(dut.streams().at({std::string(kChannel), "robot_bridge", 1}).lost, 4);
  EXPECT_EQ(dut.lost(), 2 + 4 + 6);
}

/// A forged message may have any number. A heartbeat with a larger count would be refused by all
/// that hear it.
TEST(StreamCounter, CountsNoMoreThanAHeartbeatMaySay) {
  constexpr std::int64_t kHighest = std::int64_t{1} << 62;
  StreamCounter dut;
  for (const char* sender : {"sim_svc", "robot_bridge", "tracker_svc"}) {
    for (const std::int64_t seq : {std::int64_t{0}, kHighest})
      dut.count(kChannel, sender, 1, seq, 0);
    EXPECT_EQ(dut.streams().at({std::string(kChannel), sender, 1}).lost, kMostCounted);
  }
  EXPECT_EQ(dut.lost(), kMostCounted);
}

/// Every command from a shell is a stream of its own, so an evening of them has more than any
/// limit.
TEST(StreamCounter, CommandsOfAShellDoNotFillItsPlaces) {
  StreamCounter dut;
  std::int64_t seq = 0;
  for (std::int64_t command = 0; command < 1000; ++command) {
    for (int i = 0; i < 100; ++i) dut.count(kChannel, "sim_svc", 1, ++seq, 0);
    dut.count(channels::kLightCommand, "lab_light", command, 1, 0);
  }
  EXPECT_EQ(dut.uncounted(), 0);
  EXPECT_LE(dut.streams().size(), StreamCounter::kMostStreams);
  EXPECT_EQ(dut.streams().at({std::string(kChannel), "sim_svc", 1}).received, seq);
  EXPECT_EQ(dut.lost(), 0);
}

TEST(StreamCounter, AFloodOfSendersDoesNotDisplaceEstablishedStreams) {
  StreamCounter dut;
  for (std::int64_t seq = 1; seq <= 20; ++seq) dut.count(kChannel, "sim_svc", 1, seq, 0);
  for (std::int64_t sender = 0; sender < 60'000; ++sender) dut.count(kChannel, "x", sender, 1, 0);
  EXPECT_GT(dut.uncounted(), 0);
  EXPECT_EQ(dut.streams().size(), StreamCounter::kMostStreams);
  EXPECT_TRUE(dut.streams().contains({std::string(kChannel), "sim_svc", 1}));
}

TEST(StreamCounter, CountsDecodeErrorsPerChannel) {
  StreamCounter dut;
  dut.countDecodeError(kChannel);
  dut.countDecodeError(kChannel);
  EXPECT_EQ(dut.decodeErrors().at(std::string(kChannel)), 2);
  EXPECT_TRUE(dut.streams().empty());
}

TEST(StreamCounter, CountsDecodeErrorsOfFurtherChannelsTogether) {
  StreamCounter dut;
  for (int channel = 0; channel < 1000; ++channel) {
    dut.countDecodeError("CHANNEL_" + std::to_string(channel), 2);
  }
  dut.countDecodeError("CHANNEL_0");
  EXPECT_EQ(dut.decodeErrors().size(), StreamCounter::kMostChannels);
  EXPECT_EQ(dut.decodeErrors().at("CHANNEL_0"), 3);
  EXPECT_EQ(dut.furtherDecodeErrors(), 2 * 900);
}

}  // namespace
}  // namespace lab
