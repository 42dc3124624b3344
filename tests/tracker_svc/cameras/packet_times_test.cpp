// Times of movies, as ffprobe lists them. A movie may come from a stranger.
#include "tracker_svc/cameras/packet_times.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace lab::cameras::packet_times_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// The times of packets that were shown at these times.
PacketTimes timesOf(const std::vector<std::string>& shown) {
  PacketTimes dut(kMostPackets);
  for (const std::string& time : shown) {
    EXPECT_TRUE(dut.add("pts_time=" + time + "|dts_time=0.000000|flags=K_"));
  }
  return dut;
}

std::string problemOf(const std::vector<std::string>& shown) {
  PacketTimes dut = timesOf(shown);
  static_cast<void>(dut.take());
  return dut.problem();
}

TEST(PacketTimes, AreInOrderSinceTheFirst) {
  PacketTimes dut = timesOf({"1.500000", "1.700000", "1.600000", "-0.080000"});

  EXPECT_THAT(dut.take(), ElementsAre(0, 1'580'000, 1'680'000, 1'780'000));
  EXPECT_THAT(dut.problem(), IsEmpty());
  EXPECT_THAT(dut.take(), IsEmpty());
}

TEST(PacketTimes, AreThoseOfDecodingWithoutOthers) {
  PacketTimes dut(kMostPackets);
  EXPECT_TRUE(dut.add("pts_time=N/A|dts_time=2.000000|flags=K_"));
  EXPECT_TRUE(dut.add("pts_time=2.040000|dts_time=2.080000|flags=__|side_data|"));
  EXPECT_TRUE(dut.add(""));

  EXPECT_THAT(dut.take(), ElementsAre(0, 40'000));
}

TEST(PacketTimes, OfPacketsThatAreNotDisplayedAreLeftOut) {
  PacketTimes dut(kMostPackets);
  EXPECT_TRUE(dut.add("pts_time=0.000000|dts_time=0.000000|flags=KD"));
  EXPECT_TRUE(dut.add("pts_time=0.040000|dts_time=0.040000|flags=__"));

  EXPECT_EQ(dut.neverShown(), 1);
  EXPECT_THAT(dut.take(), ElementsAre(0));
}

TEST(PacketTimes, AreOfALimitedNumber) {
  PacketTimes dut(3);
  EXPECT_TRUE(dut.add("pts_time=0.000000|dts_time=0.000000|flags=KD"));
  EXPECT_TRUE(dut.add("pts_time=0.040000|dts_time=0.040000|flags=__"));
  EXPECT_TRUE(dut.add("pts_time=0.080000|dts_time=0.080000|flags=__"));
  EXPECT_TRUE(dut.add("")) << "this is no packet";

  EXPECT_FALSE(dut.add("pts_time=0.120000|dts_time=0.120000|flags=__"));
}

TEST(PacketTimes, AreUpToTheYear2100) {
  EXPECT_THAT(problemOf({"4102444800.000000", "4102444799.000000"}), IsEmpty());
  EXPECT_THAT(problemOf({"0.000000", "4102444801.000000"}),
              HasSubstr("found a frame at 4.10244e+09 s, expected -950400 s to 4.10244e+09 s (the "
                        "year 2100)"));
  EXPECT_THAT(problemOf({"-950401.000000"}), HasSubstr("found a frame at -950401 s"));
  for (const char* time : {"9223372036854775807000000.000000", "inf", "nan", "1e999"}) {
    EXPECT_THAT(problemOf({"0.000000", time}), HasSubstr("the year 2100")) << time;
    EXPECT_THAT(timesOf({"0.000000", time}).take(), ElementsAre(0, 4'102'444'800'000'000)) << time;
  }
}

TEST(PacketTimes, AreAtMostElevenDaysApart) {
  EXPECT_THAT(problemOf({"0.000000", "950400.000000", "1900800.000000"}), IsEmpty());
  EXPECT_THAT(problemOf({"0.000000", "0.100000", "950401.100000"}),
              HasSubstr("found 950401 s between two frames, expected at most 950400 s (11 days)"));
}

}  // namespace
}  // namespace lab::cameras::packet_times_test
