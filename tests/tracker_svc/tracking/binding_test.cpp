#include "tracker_svc/tracking/binding.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/math/angle.hpp"
#include "tests/tracker_svc/tracking/crowd.hpp"

namespace lab::tracker {
namespace {

constexpr double kBase = 0.075;

TEST(WheelLog, SortsReportsThatArriveOutOfOrder) {
  WheelLog dut;
  dut.add(0.2, 0.2, 0.1);
  dut.add(0.0, 0.2, 0.1);
  dut.add(0.1, 0.2, 0.1);
  dut.add(0.1, 9, 9);  // a second report for the same time

  const WheelPath path = dut.path(0.05, 0.15);

  EXPECT_TRUE(path.known);
  EXPECT_FALSE(path.changed);
  EXPECT_NEAR(path.left, 0.02, 1e-12);
  EXPECT_NEAR(path.right, 0.01, 1e-12);
  EXPECT_DOUBLE_EQ(dut.latest(), 0.2);
}

TEST(WheelLog, AssumesNothingInLongGapsOrAfterTheLastReport) {
  WheelLog dut;
  dut.add(0, 0.1, 0.1);
  dut.add(0.1, 0.1, 0.1);
  dut.add(0.9, 0.1, 0.1);
  dut.add(1.0, 0.1, 0.1);

  EXPECT_TRUE(dut.path(0, 0.1).known);
  EXPECT_FALSE(dut.path(0.3, 0.4).known);
  EXPECT_FALSE(dut.path(0.95, 1.05).known);
  EXPECT_FALSE(WheelLog().path(0, 1).known);
}

TEST(WheelLog, HasALargerVarianceWhereSpeedsChange) {
  WheelLog dut;
  for (int i = 0; i < 20; ++i) dut.add(0.03 * i, i < 10 ? 0.0 : 0.2, 0.1);

  const WheelPath steady = dut.path(0.05, 0.15);
  const WheelPath change = dut.path(0.22, 0.32);

  EXPECT_TRUE(change.changed);
  EXPECT_GT(change.left_variance, 10 * steady.left_variance);
  EXPECT_NEAR(change.right_variance, steady.right_variance, 1e-12);
}

TEST(Motion, WheelsBetweenTwoPosesAreThoseOfTheArc) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const double left = 0.06 * random.uniform() - 0.03;
    const double right = 0.06 * random.uniform() - 0.03;
    const dynamics::Pose from{random.uniform(), random.uniform(), 6 * random.uniform() - 3};
    const dynamics::Pose to = dynamics::apply(dynamics::makeArc(left, right, kBase, 1), from);

    const Wheels travel = wheelsBetween(from, to, kBase);

    EXPECT_NEAR(travel.left, left, 1e-7);
    EXPECT_NEAR(travel.right, right, 1e-7);
  }
}

TEST(Motion, DeadReckoningFollowsTheReports) {
  WheelLog log;
  for (int i = 0; i <= 60; ++i) log.add(i / 30.0, 0.05, 0.08);
  DeadReckoner dut({kBase, 0.27});
  const dynamics::Pose from{0.5, 0.5, 1};

  const Reckoning result = dut.reckon(from, {}, {}, &log, 0.25, 1.75);

  const dynamics::Pose to = dynamics::apply(dynamics::makeArc(0.05, 0.08, kBase, 1.5), from);
  EXPECT_NEAR(result.pose.x, to.x, 1e-9);
  EXPECT_NEAR(result.pose.y, to.y, 1e-9);
  EXPECT_NEAR(result.pose.theta, to.theta, 1e-9);
  EXPECT_NEAR(result.known, 1.5, 1e-9);
  EXPECT_NEAR(result.assumed, 0, 1e-9);
}

TEST(Motion, DeadReckoningHasTheErrorsOfItsCovariance) {
  // Wheel gains wrong by 4 %, as assumed: the normalised errors are about 1.
  Random random(5);
  DeadReckoner dut({kBase, 0.27});
  double sum = 0;
  const int runs = 2000;
  for (int run = 0; run < runs; ++run) {
    const double left_gain = 1 + DeadReckoner::kGainError * random.normal();
    const double right_gain = 1 + DeadReckoner::kGainError * random.normal();
    WheelLog log;
    dynamics::Pose truth{0, 0, 0};
    for (int i = 0; i <= 30; ++i) {
      log.add(i / 30.0, 0.1, 0.12);
      if (i == 0) continue;
      const double noise = WheelLog::kRandomWay * std::sqrt(1 / 30.0);
      truth = dynamics::apply(
          dynamics::makeArc(0.1 * left_gain / 30 + noise * random.normal(),
                            0.12 * right_gain / 30 + noise * random.normal(), kBase, 1),
          truth);
    }
    const Reckoning result = dut.reckon({}, {1e-12, 0, 0, 1e-12, 0, 1e-12}, {}, &log, 0, 1);
    const double turned = truth.theta - result.pose.theta;
    const double aside = truth.y - result.pose.y;
    sum += turned * turned / result.covariance[5] + aside * aside / result.covariance[3];
  }

  // The turn is linear in the gains, the lateral displacement nearly.
  EXPECT_NEAR(sum / (2 * runs), 1, 0.1);
}

struct Handshake {
  int bound = 0;
  double longest = 0;
  Score score;
};

void shakeHands(std::uint64_t seed, Handshake& result) {
  CrowdSettings settings;
  settings.seed = seed;
  settings.report_loss = 0.01;
  settings.world.wheel_gain_error = 0.02;
  Crowd crowd(settings, sim::always(sim::wheelsProgram(0, 0)));
  CapTracker dut({}, crowd.ids());
  const auto pictures = [&](int count, std::int32_t robot) {
    for (int i = 0; i < count; ++i) {
      crowd.advance(dut);
      const std::vector<Track>& tracks = dut.update(crowd.time(), crowd.detections());
      result.score.add(crowd, tracks);
      for (const Track& track : tracks) {
        if (track.robot_id == robot) return i + 1;
      }
    }
    return count + 1;
  };
  pictures(30, 0);
  for (std::size_t i = 0; i < crowd.size(); ++i) {
    crowd.order(i, -kBase, kBase);  // 2 rad/s
    int taken = pictures(45, crowd.id(i));
    if (taken <= 45) pictures(45 - taken, 0);
    crowd.order(i, 0, 0);
    const bool late = taken > 45;
    if (late) taken += pictures(20, crowd.id(i)) - 1;
    pictures(20, 0);
    result.bound += taken <= 65 ? 1 : 0;
    result.longest = std::max(result.longest, taken / settings.fps);
  }
}

TEST(Binding, RobotsThatTurnOnTheSpotOneByOneAreIdentified) {
  Handshake result;
  for (std::uint64_t seed = 0; seed < 10; ++seed) shakeHands(600 + seed, result);

  EXPECT_EQ(result.bound, 200);
  EXPECT_EQ(result.score.swapped, 0);
  EXPECT_EQ(result.score.twice, 0);
}

struct Cold {
  std::int64_t bound = 0;
  std::int64_t robots = 0;
  Score score;
};

/// Starts without bindings. The first `foreign` caps belong to no robot; as many robots are out of
/// view and report like the others.
void startCold(const CrowdSettings& settings, const dynamics::CoreSettings& program, int foreign,
               Cold& result) {
  Crowd crowd(settings, program);
  std::vector<std::int32_t> known = crowd.ids();
  known.erase(known.begin(), known.begin() + foreign);
  for (int i = 0; i < foreign; ++i)
    crowd.hidden.insert(crowd.size() - 1 - static_cast<std::size_t>(i));
  CapTracker dut({}, known);
  std::int64_t bound = 0;
  while (crowd.time() < 20) {
    crowd.advance(dut);
    const std::vector<Track>& tracks = dut.update(crowd.time(), crowd.detections());
    result.score.add(crowd, tracks);
    bound = std::count_if(tracks.begin(), tracks.end(),
                          [](const Track& track) { return track.robot_id >= 0; });
  }
  result.bound += bound;
  result.robots += settings.robots - 2 * foreign;
}

TEST(Binding, MotionAloneIdentifiesAllRobots) {
  Cold result;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    CrowdSettings settings;
    settings.seed = 700 + seed;
    settings.report_loss = 0.05;
    settings.world.wheel_gain_error = 0.03;
    startCold(settings, sim::always(sim::abpProgram(0.05)), 0, result);
    startCold(settings, sim::always(sim::bpProgram(0, 0.2, 0.5)), 0, result);
  }

  EXPECT_GE(result.bound, result.robots * 9 / 10);
  EXPECT_EQ(result.score.swapped, 0);
  EXPECT_EQ(result.score.twice, 0);
}

TEST(Binding, LateAndLostReportsOnlyDelayIt) {
  Cold result;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    CrowdSettings settings;
    settings.seed = 720 + seed;
    settings.report_loss = 0.2;
    settings.report_delay = 0.6;
    settings.report_jitter = 0.4;
    settings.report_rate = 50;
    startCold(settings, sim::always(sim::abpProgram(0.05)), 0, result);
  }

  EXPECT_GE(result.bound, result.robots * 8 / 10);
  EXPECT_EQ(result.score.swapped, 0);
}

TEST(Binding, ForeignCapsStayUnboundWhileRobotsAreOutOfView) {
  Cold result;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    CrowdSettings settings;
    settings.seed = 740 + seed;
    startCold(settings, sim::always(sim::bpProgram(0, 0.2, 0.5)), 4, result);
    startCold(settings, sim::always(sim::rtpProgram(0.1, 1, 0.5)), 4, result);
  }

  EXPECT_GE(result.bound, result.robots * 8 / 10);
  EXPECT_EQ(result.score.swapped, 0);
}

/// One cap and one robot, which may not belong together.
std::int32_t onlyTwo(const std::vector<dynamics::Arc>& cap, const std::vector<Wheels>& robot) {
  CapTracker dut({}, {5});
  dynamics::Pose pose{0.6, 0.45, 0};
  std::int32_t id = -1;
  for (std::size_t frame = 0; frame < cap.size(); ++frame) {
    const double time = static_cast<double>(frame) / 30;
    dut.addReports({{{5, time, robot[frame].left, robot[frame].right}}});
    pose = dynamics::apply(cap[frame], pose);
    detector::Detection detection;
    detection.x = pose.x;
    detection.y = pose.y;
    detection.theta = wrapAngle(pose.theta);
    detection.covariance = {1e-10, 0, 0, 1e-10, 0, 1e-7};
    detection.quality = 1;
    id = dut.update(time, {{detection}})[0].robot_id;
  }
  return id;
}

/// Wheel speeds that change every half second.
std::vector<Wheels> draws(std::uint64_t seed, std::size_t frames) {
  Random random(seed);
  std::vector<Wheels> result;
  Wheels now;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    if (frame % 15 == 0) now = {0.3 * random.uniform() - 0.15, 0.3 * random.uniform() - 0.15};
    result.push_back(now);
  }
  return result;
}

std::vector<dynamics::Arc> arcsOf(const std::vector<Wheels>& wheels, double share = 1) {
  std::vector<dynamics::Arc> result;
  for (const Wheels& travel : wheels) {
    result.push_back(dynamics::makeArc(share * travel.left, share * travel.right, kBase, 1 / 30.0));
  }
  return result;
}

TEST(Binding, TheOnlyFreeRobotAndTheOnlyFreeCapMustMoveAlike) {
  const std::vector<Wheels> standing(300);
  const std::vector<Wheels> driving = draws(1, 300);

  EXPECT_EQ(onlyTwo(arcsOf(standing), standing), -1) << "both stand";
  EXPECT_EQ(onlyTwo(arcsOf(standing), driving), -1) << "stalled, or another one";
  EXPECT_EQ(onlyTwo(arcsOf(driving), standing), -1) << "carried, or another one";
  EXPECT_EQ(onlyTwo(arcsOf(driving), draws(2, 300)), -1) << "another one";
  EXPECT_EQ(onlyTwo(arcsOf(driving, 1.05), driving), 5) << "itself, with wheels 5 % faster";
}

TEST(Binding, RobotsBlockedByEachOtherAreNotExchanged) {
  // Two robots push against each other, two others stand: these pairs cannot be told apart.
  CrowdSettings settings;
  settings.robots = 4;
  std::vector<sim::RobotSetup> places = {{1, dynamics::Pose{0.4, 0.4, 0}, false},
                                         {2, dynamics::Pose{0.4751, 0.4, kTestPi}, false},
                                         {3, dynamics::Pose{0.8, 0.4, 0}, false},
                                         {4, dynamics::Pose{0.8, 0.7, 0}, false}};
  Crowd crowd(settings, sim::always(sim::wheelsProgram(0, 0)), places);
  CapTracker dut({}, crowd.ids());
  Score score;
  for (int frame = 0; frame < 300; ++frame) {
    if (frame == 60) {
      crowd.order(0, 0.1, 0.1);
      crowd.order(1, 0.1, 0.1);
    }
    crowd.advance(dut);
    score.add(crowd, dut.update(crowd.time(), crowd.detections()));
  }
  EXPECT_EQ(score.poses, 0) << "bound without evidence";

  // One robot gets free, because the other pushes no longer: it alone is identified.
  crowd.order(1, 0, 0);
  const std::vector<Wheels> travels = {{-0.06, -0.1}, {0.08, -0.06}, {-0.05, 0.1}, {0.04, 0.12}};
  for (const Wheels& travel : travels) {
    crowd.order(0, travel.left, travel.right);
    for (int frame = 0; frame < 18; ++frame) {
      crowd.advance(dut);
      score.add(crowd, dut.update(crowd.time(), crowd.detections()));
    }
  }
  EXPECT_GT(score.poses, 0);
  EXPECT_EQ(score.swapped, 0);
}

TEST(Binding, ARobotWithoutReportsStaysUnbound) {
  CrowdSettings settings;
  settings.seed = 760;
  Crowd crowd(settings, sim::always(sim::bpProgram(0, 0.2, 0.5)));
  crowd.silent.insert(3);
  CapTracker dut({}, crowd.ids());
  Score score;
  bool silent_bound = false;
  while (crowd.time() < 20) {
    crowd.advance(dut);
    const std::vector<Track>& tracks = dut.update(crowd.time(), crowd.detections());
    score.add(crowd, tracks);
    for (const Track& track : tracks) {
      silent_bound = silent_bound || track.robot_id == crowd.id(3);
    }
  }

  EXPECT_FALSE(silent_bound);
  EXPECT_EQ(score.swapped, 0);
}

TEST(Binding, ABoundRobotPushedByHandStaysBound) {
  // For two seconds the cap, always in view, moves differently from its robot's wheels.
  CapTracker dut({}, {5});
  dynamics::Pose pose{0.6, 0.45, 0};
  const std::vector<Wheels> reported(450);
  std::vector<Wheels> real(450);
  for (std::size_t i = 150; i < 210; ++i) real[i] = {0.1, 0.12};
  const std::vector<dynamics::Arc> arcs = arcsOf(real);
  for (std::size_t frame = 0; frame < 450; ++frame) {
    const double time = static_cast<double>(frame) / 30;
    dut.addReports({{{5, time, reported[frame].left, reported[frame].right}}});
    pose = dynamics::apply(arcs[frame], pose);
    detector::Detection detection;
    detection.x = pose.x;
    detection.y = pose.y;
    detection.theta = wrapAngle(pose.theta);
    detection.covariance = {1e-10, 0, 0, 1e-10, 0, 1e-7};
    detection.quality = 1;
    dut.update(time, {{detection}});
    if (frame == 0) dut.bind(5, pose.x, pose.y, 0.01);
  }

  EXPECT_EQ(dut.counts().unbound, 0);
}

}  // namespace
}  // namespace lab::tracker
