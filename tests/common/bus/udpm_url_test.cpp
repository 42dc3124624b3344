// URLs of UDP multicast, read as liblcm reads them; this machine's addresses.
#include "common/bus/udpm_url.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/own_addresses.hpp"

namespace lab {
namespace {

constexpr std::uint32_t kGroup = 0xefff'4c43;  // 239.255.76.67

TEST(UdpmUrl, ReadsOurOwn) {
  const auto url = parseUdpmUrl(lcmUrl(7700, 1));
  ASSERT_TRUE(url);
  EXPECT_EQ(url->group, kGroup);
  EXPECT_EQ(url->port, 7700);
  EXPECT_EQ(url->ttl, 1);
  EXPECT_EQ(url->receive_buffer, 4'194'304);
}

TEST(UdpmUrl, HasTheDefaultsOfLcm) {
  const auto url = parseUdpmUrl("udpm://");
  ASSERT_TRUE(url);
  EXPECT_EQ(url->group, kGroup);
  EXPECT_EQ(url->port, 7667);
  EXPECT_EQ(url->ttl, 0);
  EXPECT_EQ(url->receive_buffer, 0);
}

TEST(UdpmUrl, ReadsNumbersAsLcm) {
  const auto ttl = [](const char* text) {
    const auto url = parseUdpmUrl(std::string("udpm://239.1.2.3:0x100?x=9&ttl=") + text);
    return url && url->port == 256 ? url->ttl : -1;
  };
  EXPECT_EQ(ttl("0x10"), 16);
  EXPECT_EQ(ttl("2s"), 2);
  EXPECT_EQ(ttl("many"), 0);
  EXPECT_EQ(ttl(""), 0);
  EXPECT_EQ(ttl("256"), 0);  // LCM keeps 8 bits
  EXPECT_EQ(ttl("1&ttl=0"), 0);
}

TEST(UdpmUrl, IsNotOneIfGroupOrPortAreBad) {
  for (const char* url : {"memq://", "udpm:/239.1.2.3:7", "udpm://239.1.2.3", "udpm://host:7667",
                          "udpm://239.1.2.3:x", "udpm://239.1.2.3:65536", "udpm://239.1.2.3:-1",
                          "udpm://239.1.2.3:0", "udpm://10.0.0.1:7667", ""}) {
    EXPECT_FALSE(parseUdpmUrl(url)) << url;
  }
}

TEST(OwnAddresses, AreReadAgainForAnUnknownOneAtMostOnceASecond) {
  std::vector<std::uint32_t> addresses{2, 1};
  int reads = 0;
  std::chrono::steady_clock::time_point now;
  OwnAddresses dut(
      [&] {
        ++reads;
        return addresses;
      },
      [&] { return now; });
  addresses.push_back(7);

  EXPECT_TRUE(dut.contains(1));
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(dut.contains(7));
  EXPECT_EQ(reads, 1);
  now += std::chrono::seconds(1);
  EXPECT_TRUE(dut.contains(7));
  EXPECT_FALSE(dut.contains(8));
  EXPECT_EQ(reads, 2);
  addresses.clear();  // they cannot be read
  now += std::chrono::seconds(1);
  EXPECT_FALSE(dut.contains(8));
  EXPECT_EQ(reads, 3);
  EXPECT_TRUE(dut.contains(7));
}

TEST(OwnAddresses, ContainLoopback) {
  EXPECT_THAT(interfaceAddresses(), testing::Contains(0x7f00'0001U));
}

}  // namespace
}  // namespace lab
