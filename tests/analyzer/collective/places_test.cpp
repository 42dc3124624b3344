#include "analyzer/collective/places.hpp"

#include <gtest/gtest.h>

namespace lab::collective::places_test {
namespace {

TEST(Region, IsACircleOrARectangle) {
  const Region circle{"c", true, 0.5, 0.5, 0.1, 0, 0};
  const Region rectangle{"r", false, 0.5, 0.5, 0, 0.4, 0.2};

  EXPECT_TRUE(circle.contains(0.59, 0.5));
  EXPECT_FALSE(circle.contains(0.58, 0.58));
  EXPECT_TRUE(rectangle.contains(0.69, 0.59));
  EXPECT_FALSE(rectangle.contains(0.5, 0.61));
}

TEST(PlaceTracker, CountsAChangeOnceItIsConfirmed) {
  PlaceTracker dut(0.3);
  EXPECT_EQ(dut.take(0.0, 1, 0).from, -1);
  EXPECT_EQ(dut.take(0.1, 1, 1).to, 0);
  EXPECT_EQ(dut.take(0.3, 1, 1).to, 0);
  const PlaceTracker::Change change = dut.take(0.45, 1, 1);

  EXPECT_EQ(change.from, 0);
  EXPECT_EQ(change.to, 1);
  EXPECT_EQ(dut.take(0.5, 1, 1).from, 1);
}

TEST(PlaceTracker, DoesNotCountTheNoiseAtABorder) {
  PlaceTracker dut(0.3);
  int changes = 0;
  for (int k = 0; k < 100; ++k) {
    const PlaceTracker::Change change = dut.take(0.1 * k, 1, k % 2);
    if (change.from >= 0 && change.from != change.to) ++changes;
  }

  EXPECT_EQ(changes, 0);
}

TEST(PlaceTracker, KeepsThePlaceWhileItIsUnknown) {
  PlaceTracker dut(0.3);
  dut.take(0, 1, 2);

  EXPECT_EQ(dut.take(1, 1, -1).to, 2);
  EXPECT_EQ(dut.take(1, 5, -1).to, -1);
}

}  // namespace
}  // namespace lab::collective::places_test
