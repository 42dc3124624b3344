// The handshake and the tracker's identification together: crowds of simulated robots, detections
// with noise, reports with delay and loss.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/experiment/experiment.hpp"
#include "runner/live/handshake.hpp"
#include "tests/tracker_svc/tracking/crowd.hpp"

namespace lab::runner {
namespace {

using tracker::CapTracker;
using tracker::Crowd;
using tracker::CrowdSettings;
using tracker::Score;
using tracker::Track;

constexpr double kCommandDelay = 0.06;  // [s] until robots obey and their echo arrives

/// 200 robots at the density of a loose crowd: a third of the floor is covered.
CrowdSettings crowdOf(int robots, std::uint64_t seed) {
  CrowdSettings settings;
  settings.robots = robots;
  settings.seed = seed;
  settings.report_loss = 0.01;
  settings.dropout = 0.01;
  settings.world.wheel_gain_error = 0.02;
  const double area = robots * 3.14 * 0.0375 * 0.0375 / 0.33;
  settings.world.arena = {std::sqrt(area * 4 / 3), std::sqrt(area * 3 / 4)};
  return settings;
}

Experiment experimentOf(const Crowd& crowd) {
  Experiment experiment;
  experiment.camera.tracker = Tracker::kCamera;
  for (const std::int32_t id : crowd.ids()) {
    RobotSpec robot;
    robot.id = id;
    robot.body = Body::kSim;
    experiment.robots.push_back(robot);
  }
  return experiment;
}

tracker::TrackerSettings settingsOf(const CrowdSettings& crowd) {
  tracker::TrackerSettings settings;
  settings.arena_width = crowd.world.arena.width;
  settings.arena_height = crowd.world.arena.height;
  return settings;
}

struct Outcome {
  Score score;  ///< of all frames
  int known = 0;
  int wrong = 0;  ///< robots with a wrong name at the end
  std::set<std::int32_t> unknown;
  double duration = 0;  ///< [s]
};

/// Runs a handshake of a crowd.
class HandshakeRun {
 public:
  HandshakeRun(const CrowdSettings& settings, Crowd& crowd)
      : crowd_(crowd),
        experiment_(experimentOf(crowd)),
        handshake_(experiment_),
        tracker_(settingsOf(settings), crowd.ids()) {}

  /// @param before called before each frame
  Outcome run(const std::function<void(Crowd&)>& before = [](Crowd&) {}) {
    Outcome outcome;
    while (!handshake_.done() && crowd_.time() < 120) {
      before(crowd_);
      control();
      crowd_.advance(tracker_);
      const std::vector<Track>& tracks = tracker_.update(crowd_.time(), crowd_.detections());
      outcome.score.add(crowd_, tracks);
      show(tracks);
    }
    finish(outcome);
    return outcome;
  }

 private:
  [[nodiscard]] std::int64_t now_us() const { return std::llround(crowd_.time() * 1e6); }

  void control() {
    const auto obeyed = [this](std::int32_t id) {
      return crowd_.time() >= obeys_at_ && !deaf.contains(id);
    };
    if (handshake_.advance(now_us(), obeyed)) {
      obeys_at_ = crowd_.time() + kCommandDelay;
      ordered_ = false;
    }
    if (ordered_ || crowd_.time() < obeys_at_) return;
    ordered_ = true;
    for (const robot_order_t& order : handshake_.command().orders) {
      const bool drives = order.mode == robot_order_t::DRIVE;
      for (const std::int32_t id : order.robot_ids) {
        if (deaf.contains(id)) continue;
        crowd_.order(indexOf(id), drives ? order.wheel_left : 0, drives ? order.wheel_right : 0);
      }
    }
  }

  [[nodiscard]] std::size_t indexOf(std::int32_t id) const {
    const std::vector<std::int32_t> ids = crowd_.ids();
    return static_cast<std::size_t>(std::ranges::find(ids, id) - ids.begin());
  }

  void show(const std::vector<Track>& tracks) {
    tracked_frame_t frame{};
    frame.utime = now_us();
    for (const Track& track : tracks) {
      if (!track.detected || track.robot_id < 0) continue;
      tracked_pose_t pose{};
      pose.robot_id = track.robot_id;
      frame.robots.push_back(pose);
      last_[track.robot_id] = crowd_.robotAt(track.pose);
    }
    handshake_.see(frame);
  }

  void finish(Outcome& outcome) const {
    outcome.duration = crowd_.time();
    outcome.unknown = {handshake_.unknown().begin(), handshake_.unknown().end()};
    outcome.known = static_cast<int>(crowd_.size() - outcome.unknown.size());
    for (const auto& [named, at] : last_) {
      if (!outcome.unknown.contains(named) && named != at) ++outcome.wrong;
    }
  }

 public:
  std::set<std::int32_t> deaf;  ///< robots that obey no order

 private:
  Crowd& crowd_;
  Experiment experiment_;
  Handshake handshake_;
  CapTracker tracker_;
  std::map<std::int32_t, std::int32_t> last_;  ///< by name: the robot there in the last frame
  double obeys_at_ = 0;
  bool ordered_ = false;
};

const dynamics::CoreSettings kStanding = sim::always(sim::wheelsProgram(0, 0));

/// 200 robots, all known under 20 s, none wrong in any frame.
void identify(std::uint64_t first_seed, int seeds) {
  int robots = 0;
  int known = 0;
  double longest = 0;
  for (int i = 0; i < seeds; ++i) {
    const CrowdSettings settings = crowdOf(200, first_seed + static_cast<std::uint64_t>(i));
    Crowd crowd(settings, kStanding);
    const Outcome outcome = HandshakeRun(settings, crowd).run();
    EXPECT_EQ(outcome.score.swapped, 0) << "seed " << i;
    EXPECT_EQ(outcome.score.twice, 0) << "seed " << i;
    EXPECT_EQ(outcome.wrong, 0) << "seed " << i;
    robots += static_cast<int>(crowd.size());
    known += outcome.known;
    longest = std::max(longest, outcome.duration);
  }
  testing::Test::RecordProperty("longest_s", std::to_string(longest));
  EXPECT_EQ(known, robots);
  EXPECT_LT(longest, 20);  // simulated time
}

TEST(HandshakeIdentities, TwoHundredRobotsAreIdentifiedInTwentySeconds) { identify(900, 3); }

TEST(HandshakeIdentitiesLong, TwoHundredRobotsFiftySeedsNoneWrong) { identify(1000, 50); }

TEST(HandshakeIdentities, RobotsInContactAreIdentified) {
  // Rows of touching robots: every robot has two neighbours at its rim.
  std::vector<sim::RobotSetup> places;
  for (int i = 0; i < 40; ++i) {
    const double x = 0.15 + 0.0751 * (i % 10);
    const double y = 0.15 + 0.15 * (i / 10);
    places.push_back({i + 1, dynamics::Pose{x, y, 0.7 * i}, false});
  }
  CrowdSettings settings = crowdOf(40, 5);
  settings.world.arena = {1.2, 0.9};
  Crowd crowd(settings, kStanding, places);
  const Outcome outcome = HandshakeRun(settings, crowd).run();
  EXPECT_EQ(outcome.score.swapped, 0);
  EXPECT_EQ(outcome.wrong, 0);
  EXPECT_EQ(outcome.known, 40);
}

TEST(HandshakeIdentities, RobotsThatVanishOrDoNotObeyAreSaidToBeUnknown) {
  const CrowdSettings settings = crowdOf(60, 77);
  Crowd crowd(settings, kStanding);
  HandshakeRun run(settings, crowd);
  run.deaf = {7};
  const Outcome outcome = run.run([](Crowd& it) {
    if (it.time() > 2) it.hidden.insert(11);                     // robot 12 is taken away
    if (it.time() > 13 && it.time() < 15) it.hidden.insert(20);  // robot 21 is hidden for a moment
    if (it.time() >= 15) it.hidden.erase(20);
  });
  EXPECT_EQ(outcome.score.swapped, 0);
  EXPECT_EQ(outcome.wrong, 0);
  EXPECT_EQ(outcome.unknown, (std::set<std::int32_t>{7, 12}));
}

}  // namespace
}  // namespace lab::runner
