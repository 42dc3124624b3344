#include "analyzer/collective/contact_tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace lab::collective::contact_tracker_test {
namespace {

CrowdSettings settings() {
  CrowdSettings settings;
  settings.arena = {0, 0, 1.2, 0.9};
  return settings;
}

class ContactTrackerTest : public testing::Test {
 protected:
  /// Two robots at this distance in diameters, away from walls, at the next frame (0.1 s).
  const ContactFrame& at(double diameters) {
    time_ += 0.1;
    return dut_.take(time_, {{7, 0.4, 0.4}, {3, 0.4 + 0.075 * diameters, 0.4}});
  }
  const ContactFrame& without() {
    time_ += 0.1;
    return dut_.take(time_, {{7, 0.4, 0.4}});
  }

  ContactTracker dut_{settings()};
  double time_ = 0;
};

TEST_F(ContactTrackerTest, MeasuresTheDurationOfAContact) {
  EXPECT_TRUE(at(1.5).pairs.empty());
  EXPECT_EQ(at(1.0).pairs.size(), 1U);
  EXPECT_EQ(at(1.0).touching, (std::vector<char>{1, 1}));
  EXPECT_TRUE(at(1.0).ended.empty());
  const ContactFrame& frame = at(1.2);

  ASSERT_EQ(frame.ended.size(), 1U);
  EXPECT_NEAR(frame.ended[0].duration, 0.3, 1e-12);
  EXPECT_EQ(frame.touching, (std::vector<char>{0, 0}));
}

TEST_F(ContactTrackerTest, DoesNotEndAContactForTheNoiseOfTheTracker) {
  at(1.5);
  at(1.02);
  EXPECT_EQ(at(1.05).pairs.size(), 1U);
  EXPECT_EQ(at(1.01).pairs.size(), 1U);
  EXPECT_EQ(at(1.07).ended.size(), 1U);
  EXPECT_TRUE(at(1.05).pairs.empty());  // not close enough to begin
}

TEST_F(ContactTrackerTest, DoesNotKnowTheDurationOfAContactThatWasThereBefore) {
  at(1.0);
  const ContactFrame& frame = at(1.2);

  ASSERT_EQ(frame.ended.size(), 1U);
  EXPECT_TRUE(std::isnan(frame.ended[0].duration));
}

TEST_F(ContactTrackerTest, KeepsAContactWhileARobotIsNotSeenForAShortTime) {
  at(1.5);
  at(1.0);
  without();
  without();
  at(1.0);
  const ContactFrame& frame = at(1.3);

  ASSERT_EQ(frame.ended.size(), 1U);
  EXPECT_NEAR(frame.ended[0].duration, 0.4, 1e-12);
}

TEST_F(ContactTrackerTest, ForgetsAContactOfARobotThatIsLost) {
  at(1.5);
  at(1.0);
  for (int k = 0; k < 8; ++k) without();

  EXPECT_TRUE(at(1.5).ended.empty());
}

TEST_F(ContactTrackerTest, FollowsRobotsAtWalls) {
  const auto wall = [this](double gap) {
    time_ += 0.1;
    return dut_.take(time_, {{1, 0.0375 + gap, 0.4}});
  };
  EXPECT_EQ(wall(0.05).at_wall[0], 0);
  EXPECT_EQ(wall(0.001).at_wall[0], 1);
  EXPECT_EQ(wall(0.004).at_wall[0], 1);
  const ContactFrame left = wall(0.01);

  EXPECT_EQ(left.at_wall[0], 0);
  EXPECT_EQ(left.left_wall, (std::vector<std::size_t>{0}));
}

}  // namespace
}  // namespace lab::collective::contact_tracker_test
