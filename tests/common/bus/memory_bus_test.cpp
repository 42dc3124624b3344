#include "common/bus/memory_bus.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string_view>

namespace lab {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;

std::vector<std::uint8_t> byte(int value) { return {static_cast<std::uint8_t>(value)}; }

class MemoryBusTest : public testing::Test {
 protected:
  void publish(int value, std::string_view channel = "A") { dut_.publish(channel, byte(value)); }
  PacketHandler into(std::vector<int>& heard) {
    return [&heard](const Packet& packet) { heard.push_back(packet.data[0]); };
  }

  std::int64_t now_ = 1000;
  MemoryBus dut_{[this] { return now_; }};
};

TEST_F(MemoryBusTest, DeliversInTheOrderOfPublishing) {
  std::vector<int> all;
  std::vector<int> only_b;
  dut_.subscribeAll(into(all));
  dut_.subscribe("B", into(only_b));
  publish(1, "A");
  publish(2, "B");
  publish(3, "A");
  publish(4, "B");
  EXPECT_TRUE(all.empty());
  dut_.deliver();
  EXPECT_THAT(all, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(only_b, ElementsAre(2, 4));
}

TEST_F(MemoryBusTest, StampsTheTimeOfDelivery) {
  std::int64_t received = 0;
  dut_.subscribeAll([&](const Packet& packet) { received = packet.received_utime; });
  publish(1);
  now_ = 2000;
  dut_.deliver();
  EXPECT_EQ(received, 2000);
}

TEST_F(MemoryBusTest, KnowsForHowLongTheOldestMessageHasWaited) {
  std::vector<std::int64_t> behind;
  dut_.subscribeAll([&](const Packet&) { behind.push_back(dut_.backlog()); });
  EXPECT_EQ(dut_.backlog(), 0);
  publish(1);
  now_ += 300;
  publish(2);
  now_ += 50;
  EXPECT_EQ(dut_.backlog(), 350);
  dut_.deliver();
  EXPECT_THAT(behind, ElementsAre(50, 0)) << "of what waits behind the one that is handled";
  EXPECT_EQ(dut_.backlog(), 0);
}

TEST_F(MemoryBusTest, DoesNotRecurseIntoAHandlerThatPublishes) {
  std::vector<int> heard;
  int depth = 0;
  dut_.subscribe("A", [&](const Packet& packet) {
    ASSERT_EQ(++depth, 1);
    heard.push_back(packet.data[0]);
    if (packet.data[0] < 3) publish(packet.data[0] + 1);
    dut_.deliver();
    --depth;
  });
  std::vector<int> second;
  dut_.subscribe("A", into(second));
  publish(1);
  publish(10);
  dut_.deliver();
  EXPECT_THAT(heard, ElementsAre(1, 10, 2, 3));
  EXPECT_EQ(second, heard);
}

TEST_F(MemoryBusTest, ThrowsAHandlersExceptionAfterTheDelivery) {
  std::vector<int> other;
  dut_.subscribeAll([](const Packet& packet) {
    if (packet.data[0] < 3) throw std::runtime_error("message " + std::to_string(packet.data[0]));
  });
  dut_.subscribeAll(into(other));
  for (int value = 1; value <= 3; ++value) publish(value);
  try {
    dut_.deliver();
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "message 1");
  }
  EXPECT_THAT(other, ElementsAre(1, 2, 3));
  publish(4);
  dut_.deliver();
  EXPECT_THAT(other, ElementsAre(1, 2, 3, 4));
}

TEST_F(MemoryBusTest, RefusesChannelNamesThatLcmWouldRefuse) {
  EXPECT_NO_THROW(publish(1, std::string(63, 'X')));
  EXPECT_THROW(publish(1, std::string(64, 'X')), BusError);
}

TEST_F(MemoryBusTest, RefusesASubscriptionInsideAHandler) {
  dut_.subscribeAll([this](const Packet&) { dut_.subscribeAll([](const Packet&) {}); });
  publish(1);
  EXPECT_THROW(dut_.deliver(), std::logic_error);
}

/// What two subscribers receive of `count` messages at a loss rate.
std::array<std::vector<bool>, 2> heardByTwo(int count, double loss, std::uint64_t seed) {
  MemoryBus bus([] { return 0; });
  std::array<std::vector<bool>, 2> heard;
  for (std::vector<bool>& one : heard) {
    one.resize(static_cast<std::size_t>(count));
    bus.subscribeAll([&one](const Packet& packet) {
      one[static_cast<std::size_t>(packet.data[0]) + 256U * packet.data[1]] = true;
    });
  }
  bus.loseAtRandom(loss, seed);
  for (int i = 0; i < count; ++i) {
    bus.publish("A", std::vector<std::uint8_t>{static_cast<std::uint8_t>(i),
                                               static_cast<std::uint8_t>(i / 256)});
  }
  bus.deliver();
  return heard;
}

TEST(MemoryBusLoss, IsBinomialAndIndependentForEachListener) {
  constexpr int kCount = 40'000;
  constexpr double kLoss = 0.1;
  const auto heard = heardByTwo(kCount, kLoss, 3);
  const auto z = [](double lost, double p) {
    return (lost - kCount * p) / std::sqrt(kCount * p * (1 - p));
  };
  double both = 0;
  std::array<double, 2> lost{};
  double in_a_row = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    for (std::size_t listener = 0; listener < 2; ++listener) lost[listener] += !heard[listener][i];
    both += !heard[0][i] && !heard[1][i];
    in_a_row += !heard[0][i] && !heard[0][(i + 1) % kCount];
  }
  EXPECT_LT(std::abs(z(lost[0], kLoss)), 4);
  EXPECT_LT(std::abs(z(lost[1], kLoss)), 4);
  EXPECT_LT(std::abs(z(both, kLoss * kLoss)), 4);
  EXPECT_LT(std::abs(z(in_a_row, kLoss * kLoss)), 4);
}

TEST(MemoryBusLoss, IsFixedByTheSeed) {
  EXPECT_EQ(heardByTwo(1000, 0.3, 5), heardByTwo(1000, 0.3, 5));
  EXPECT_NE(heardByTwo(1000, 0.3, 5), heardByTwo(1000, 0.3, 6));
}

TEST(MemoryBusLoss, IsExactForRatesOfZeroAndOne) {
  EXPECT_THAT(heardByTwo(500, 0, 1)[0], ElementsAreArray(std::vector<bool>(500, true)));
  EXPECT_THAT(heardByTwo(500, 1, 1)[0], ElementsAreArray(std::vector<bool>(500, false)));
}

}  // namespace
}  // namespace lab
