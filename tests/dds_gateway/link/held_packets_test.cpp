#include "dds_gateway/link/held_packets.hpp"

#include <gtest/gtest.h>

namespace lab::gateway::held_packets_test {
namespace {

HeldPacket packetOf(std::int64_t number, std::size_t data, std::size_t channel = 10) {
  HeldPacket packet;
  packet.number = number;
  packet.channel.assign(channel, 'c');
  packet.data.resize(data);
  return packet;
}

TEST(HeldPackets, AreReturnedOnceAndInOrder) {
  HeldPackets dut(2);
  for (int i = 1; i <= 3; ++i) dut.add("bench", packetOf(i, 100));
  dut.add("desk", packetOf(9, 100));
  const auto packets = dut.take("bench");
  ASSERT_EQ(packets.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(packets[i].number, static_cast<int>(i) + 1);
  EXPECT_TRUE(dut.take("bench").empty());
  EXPECT_EQ(dut.take("desk").size(), 1U);
  EXPECT_EQ(dut.bytes(), 0U);
}

/// Packets of one byte, with a channel of 1 MB: 2000 of them took 2 GB.
TEST(HeldPackets, ChannelsAndEmptyPacketsCountAsMemory) {
  HeldPackets dut(2);
  for (int i = 0; i < 100; ++i) {
    dut.add("bench", packetOf(i, 0, 1'000'000));
    ASSERT_LE(dut.bytes(), HeldPackets::kMostBytes);
  }
  const auto packets = dut.take("bench");
  EXPECT_LT(packets.size(), 17U);
  EXPECT_EQ(packets.back().number, 99) << "the oldest are dropped";
  dut.add("bench", packetOf(1, 0, 0));
  EXPECT_GT(dut.bytes(), 0U);
}

/// Each host kept one packet of 16 MB, whatever the others held.
TEST(HeldPackets, ManyHostsTogetherAreBounded) {
  HeldPackets dut(64);
  for (int i = 0; i < 100; ++i) {
    dut.add("host" + std::to_string(i), packetOf(i, 10'000'000));
    ASSERT_LE(dut.bytes(), HeldPackets::kMostBytes);
  }
  dut.add("host0", packetOf(0, HeldPackets::kMostBytes));
  EXPECT_LE(dut.bytes(), HeldPackets::kMostBytes);
}

TEST(HeldPackets, AFloodOfOneHostDropsItsOwnPackets) {
  HeldPackets dut(64);
  for (int i = 0; i < 10; ++i) dut.add("bench", packetOf(i, 1000));
  for (int i = 0; i < 5000; ++i) dut.add("flood", packetOf(i, 10'000));
  EXPECT_EQ(dut.take("bench").size(), 10U);
  EXPECT_LE(dut.take("flood").size(), HeldPackets::kMostPackets);
}

}  // namespace
}  // namespace lab::gateway::held_packets_test
