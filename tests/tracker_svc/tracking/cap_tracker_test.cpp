#include "tracker_svc/tracking/cap_tracker.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "tests/tracker_svc/tracking/crowd.hpp"

namespace lab::tracker {
namespace {

detector::Detection capAt(double x, double y, double theta) {
  detector::Detection detection;
  detection.x = x;
  detection.y = y;
  detection.theta = theta;
  detection.covariance = {1e-10, 0, 0, 1e-10, 0, 1e-7};
  detection.quality = 1;
  detection.used = detector::kUsedBig | detector::kUsedSmall;
  return detection;
}

std::vector<dynamics::CoreSettings> programs() {
  return {sim::always(sim::abpProgram(0.05)), sim::always(sim::rtpProgram(0.1, 1, 0.5)),
          sim::always(sim::bpProgram(0, 0.2, 0.5)), sim::always(sim::abpProgram(0.15))};
}

detector::Detection degraded(detector::Detection detection) {
  detection.used = detector::kUsedBig | detector::kUsedRim;
  detection.quality = 0.4F;
  detection.covariance = {1e-8, 0, 0, 1e-8, 0, 4e-5};
  return detection;
}

TEST(CapTracker, ADegradedPoseKeepsATrackButStartsNone) {
  CapTracker dut({}, {7});
  const detector::Detection cap = capAt(0.5, 0.5, 0.3);
  const std::vector<detector::Detection> begin{degraded(capAt(0.2, 0.2, 0))};
  EXPECT_TRUE(dut.update(0, begin).empty());
  for (int k = 1; k <= 5; ++k) static_cast<void>(dut.update(0.02 * k, {&cap, 1}));
  ASSERT_TRUE(dut.bind(7, 0.5, 0.5, 0.01));
  const detector::Detection rim = degraded(capAt(0.501, 0.5, 0.31));
  for (int k = 6; k <= 500; ++k) {  // ten seconds: twice the lifetime of an undetected track
    const std::vector<Track>& tracks = dut.update(0.02 * k, {&rim, 1});
    ASSERT_EQ(tracks.size(), 1U);
    EXPECT_TRUE(tracks[0].detected);
    EXPECT_EQ(tracks[0].number, 1);
    EXPECT_EQ(tracks[0].robot_id, 7);
    EXPECT_EQ(tracks[0].pose.used, rim.used);
    EXPECT_LT(tracks[0].pose.quality, 0.5F);
  }
  EXPECT_EQ(dut.counts().unbound, 0);
  EXPECT_EQ(dut.counts().lost, 0);
  // The expectation is as precise as before.
  EXPECT_NEAR(dut.expect(10.02)[0].x, 0.501, 1e-4);
}

TEST(CapTracker, ADegradedPoseNeitherFlipsNorBinds) {
  CapTracker dut({}, {7});
  const detector::Detection cap = capAt(0.5, 0.5, 0.3);
  static_cast<void>(dut.update(0, {&cap, 1}));
  const detector::Detection round = degraded(capAt(0.5, 0.5, 0.3 + 3.1415));
  static_cast<void>(dut.update(0.02, {&round, 1}));
  static_cast<void>(dut.update(0.04, {&round, 1}));
  EXPECT_EQ(dut.counts().flips, 0);
  EXPECT_FALSE(dut.bind(7, 0.5, 0.5, 0.01)) << "not by what is hardly seen";
  const std::vector<Track>& tracks = dut.update(0.06, {&cap, 1});
  EXPECT_EQ(tracks[0].number, 1);
  EXPECT_TRUE(dut.bind(7, 0.5, 0.5, 0.01));
}

TEST(CapTracker, DegradedPosesAreNotUsedForMotion) {
  // The same motion and reports, with full and with degraded poses.
  for (const bool sharp : {true, false}) {
    CapTracker dut({}, {1, 2});
    for (int k = 0; k < 400; ++k) {
      const double time = 0.02 * k;
      // one robot turns on the spot, the other stands
      const double turn = time > 1 ? (time - 1) * 2 : 0;
      const double wheel = time > 1 ? 2 * 0.075 / 2 : 0;
      const std::vector<WheelReport> reports{{1, time, -wheel, wheel}, {2, time, 0, 0}};
      dut.addReports(reports);
      std::vector<detector::Detection> caps{
          capAt(0.4, 0.4, std::remainder(turn, 6.283185307179586)), capAt(0.8, 0.4, 1)};
      if (!sharp && k > 10) caps = {degraded(caps[0]), degraded(caps[1])};
      static_cast<void>(dut.update(time, caps));
    }
    EXPECT_EQ(dut.counts().bound > 0, sharp);
  }
}

/// The track number of a cap that drives along x, is hidden, and reappears at `back`.
std::int64_t numberAfter(bool caps_may_be_replaced, double speed, double hidden, double back,
                         double fps = 30) {
  TrackerSettings settings;
  settings.caps_may_be_replaced = caps_may_be_replaced;
  CapTracker dut(settings, {});
  const int begin = static_cast<int>(std::max(2.0, 2 * fps));
  double time = 0;
  double x = 0.2;
  for (int k = 0; k < begin; ++k, time += 1 / fps, x += speed / fps) {
    const detector::Detection cap = capAt(x, 0.4, 0);
    static_cast<void>(dut.update(time, {&cap, 1}));
  }
  const double last = x - speed / fps;
  for (const double end = time + hidden - 1e-9; time < end; time += 1 / fps) {
    static_cast<void>(dut.update(time, {}));
  }
  const detector::Detection cap = capAt(last + back, 0.4, 0);
  const std::vector<Track>& tracks = dut.update(time, {&cap, 1});
  const auto seen = std::ranges::find_if(tracks, [](const Track& track) { return track.detected; });
  return seen == tracks.end() ? 0 : seen->number;
}

TEST(CapTracker, StartsANewTrackBeyondTheReachOfTheLostOne) {
  EXPECT_EQ(numberAfter(true, 0, 2, 0.448), 2) << "at rest, and elsewhere after an empty floor";
  EXPECT_EQ(numberAfter(true, 0, 2, 0.05), 2);
  EXPECT_EQ(numberAfter(true, 0.05, 2, 0.25), 2) << "two and a half times as fast as ever";
  EXPECT_EQ(numberAfter(false, 0, 2, 0.448), 1) << "whose robots are known waits for them";
}

TEST(CapTracker, ReidentifiesALostCapWithinReachOfItsSpeed) {
  EXPECT_EQ(numberAfter(true, 0, 2, 0), 1);
  EXPECT_EQ(numberAfter(true, 0, 2, 0.03), 1) << "within its radius";
  EXPECT_EQ(numberAfter(true, 0.05, 2, 0.1), 1);
  EXPECT_EQ(numberAfter(true, 0.05, 2, -0.1), 1) << "it may have turned";
  EXPECT_EQ(numberAfter(true, 0, 0.3, 0.08), 1) << "a short drop-out, and it begins to drive";
  EXPECT_EQ(numberAfter(true, 0.1, 0, 0.1, 1), 1) << "a picture a second, none without it";
  EXPECT_EQ(numberAfter(true, 0.1, 1, 0.2, 1), 1) << "and one without";
}

/// The track numbers of 20 robots without reports after two seconds of black pictures.
std::set<std::int64_t> numbersAfterBlack(bool caps_may_be_replaced, std::size_t program,
                                         std::uint64_t seed) {
  CrowdSettings settings;
  settings.seed = seed;
  settings.reports = false;
  settings.frame_loss = 0.01;
  settings.dropout = 0.02;
  Crowd crowd(settings, programs()[program]);
  TrackerSettings tracker;
  tracker.caps_may_be_replaced = caps_may_be_replaced;
  CapTracker dut(tracker, {});
  std::set<std::int64_t> after;
  while (crowd.time() < 20) {
    crowd.advance(dut);
    if (crowd.isLost()) continue;
    const bool black = crowd.time() > 10 && crowd.time() < 12;
    const auto caps = black ? std::vector<detector::Detection>{} : crowd.detections();
    for (const Track& track : dut.update(crowd.time(), caps)) {
      if (crowd.time() > 19) after.insert(track.number);
    }
  }
  return after;
}

TEST(CapTracker, KeepsADrivingCrowdOverBlackPicturesIfCapsMayBeReplaced) {
  for (std::size_t program = 0; program < programs().size(); ++program) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const std::set<std::int64_t> known = numbersAfterBlack(false, program, seed);
      EXPECT_EQ(numbersAfterBlack(true, program, seed), known) << program << ", seed " << seed;
    }
  }
}

// Acceptance test: 1 % of the pictures lost, 0.2 % of the caps missed, and two seconds per minute
// with six times the noise, as under the residual light of a black projector.
// with six times the noise, as under the light that a black projector leaves.
void runCrowd(std::size_t program, std::uint64_t seed, double minutes) {
  CrowdSettings settings;
  settings.seed = seed;
  settings.frame_loss = 0.01;
  settings.dropout = 0.002;
  Crowd crowd(settings, programs()[program]);
  CapTracker dut({}, crowd.ids());
  Score score;
  bool begun = false;
  while (crowd.time() < 60 * minutes) {
    crowd.advance(dut);
    if (crowd.isLost()) continue;
    const double in_minute = std::fmod(crowd.time(), 60);
    const bool black = in_minute > 30 && in_minute < 32;
    const auto detections = crowd.detections(black ? 6 : 1);
    const std::vector<Track>& tracks = dut.update(crowd.time(), detections);
    ASSERT_EQ(static_cast<std::size_t>(std::count_if(tracks.begin(), tracks.end(),
                                                     [](const Track& t) { return t.detected; })),
              detections.size());
    if (!begun) bindAll(crowd, dut);
    if (begun) score.add(crowd, tracks);
    begun = true;
  }

  EXPECT_GT(crowd.world().collisions(), 200 * minutes);  // robots that slide collide more rarely
  EXPECT_GT(score.poses, 20 * 1700 * minutes);
  EXPECT_EQ(score.swapped, 0);
  EXPECT_EQ(score.flipped, 0);
  EXPECT_EQ(score.twice, 0);
  EXPECT_EQ(score.unnamed, 0);
  EXPECT_EQ(dut.counts().unbound, 0);
  EXPECT_EQ(dut.counts().lost, 0);
}

TEST(CapTracker, DistinguishesTwentyCrossingAndTouchingRobotsForAMinute) {
  for (std::size_t program = 0; program < 4; ++program) runCrowd(program, 11 + program, 1);
}

TEST(CapTracker, DistinguishesTwentyCrossingAndTouchingRobotsForTenMinutes) { runCrowd(0, 21, 10); }

struct Dark {
  std::int64_t kept = 0;
  std::int64_t doubtful = 0;
  std::int64_t again = 0;  ///< doubtful ones that are bound at the end
  std::int64_t numbers_wrong = 0;
  Score score;
};

void runDark(const CrowdSettings& settings, std::size_t program, double dark, double after,
             Dark& result) {
  Crowd crowd(settings, programs()[program]);
  CapTracker dut({}, crowd.ids());
  std::map<std::int64_t, int> number_of;
  std::vector<detector::Detection> nothing;
  std::int64_t doubtful = 0;
  bool back = false;
  std::int64_t named = 0;
  while (crowd.time() < 3 + dark + after) {
    crowd.advance(dut);
    const bool is_dark = crowd.time() > 3 && crowd.time() < 3 + dark;
    const std::vector<Track>& tracks =
        dut.update(crowd.time(), is_dark ? nothing : crowd.detections());
    if (number_of.empty()) {
      bindAll(crowd, dut);
      for (const Track& track : tracks) number_of[track.number] = crowd.robotAt(track.pose);
    }
    result.score.add(crowd, tracks);
    named = 0;
    for (const Track& track : tracks) named += track.detected && track.robot_id >= 0 ? 1 : 0;
    if (is_dark || crowd.time() <= 3 || back) continue;
    back = true;
    result.kept += named;
    doubtful = settings.robots - named;
    for (const Track& track : tracks) {
      const auto before = number_of.find(track.number);
      const bool same = before != number_of.end() && before->second == crowd.robotAt(track.pose);
      result.numbers_wrong += track.detected && !same ? 1 : 0;
    }
  }
  result.doubtful += doubtful;
  result.again += std::max<std::int64_t>(0, named - (settings.robots - doubtful));
}

TEST(CapTracker, NeverSwapsUnreportedInTwoSecondsOfBlackPictures) {
  Dark result;
  for (std::size_t program = 0; program < 4; ++program) {
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
      CrowdSettings settings;
      settings.seed = 100 + seed;
      settings.robots = seed % 2 == 0 ? 20 : 10;
      settings.report_loss = 0.05;
      settings.world.wheel_gain_error = 0.02;
      runDark(settings, program, 2, 8, result);
    }
  }

  EXPECT_EQ(result.score.swapped, 0);
  EXPECT_EQ(result.score.twice, 0);
  // More than half keep their binding; most doubtful ones have it again eight seconds later.
  EXPECT_GT(result.kept, 0.5 * static_cast<double>(result.kept + result.doubtful));
  EXPECT_GT(result.again, 0.7 * static_cast<double>(result.doubtful));
  EXPECT_LT(result.numbers_wrong, 0.1 * static_cast<double>(result.kept + result.doubtful));
}

TEST(CapTracker, NeverSwapsUnreportedInTheDarkWithLateOrNoReports) {
  Dark result;
  for (std::size_t program = 0; program < 4; ++program) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      CrowdSettings settings;
      settings.seed = 200 + seed;
      settings.robots = 10;
      settings.reports = seed % 2 == 0;
      settings.report_delay = 0.8;
      runDark(settings, program, 2, 2, result);
    }
  }

  EXPECT_EQ(result.score.swapped, 0);
}

TEST(CapTracker, WithoutRobotsKeepsTheBestGuessAsTrackNumber) {
  // As for recordings: no robots known, a third of a second missing.
  Dark result;
  for (std::size_t program = 0; program < 3; ++program) {
    CrowdSettings settings;
    settings.seed = 300 + program;
    settings.reports = false;
    runDark(settings, program, 0.33, 0.5, result);
  }

  EXPECT_EQ(result.numbers_wrong, 0);
}

TEST(CapTracker, DetectsThatTwoRobotsWereExchangedInTheDark) {
  double longest = 0;
  int right_again = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    CrowdSettings settings;
    settings.seed = 400 + seed;
    settings.robots = 8;
    Crowd crowd(settings, programs()[2]);
    CapTracker dut({}, crowd.ids());
    bool exchanged = false;
    bool last_wrong = false;
    double wrong_since = 0;
    int right = 0;
    while (crowd.time() < 25) {
      crowd.advance(dut);
      const bool dark = crowd.time() > 3 && crowd.time() < 5;
      if (dark && !exchanged) {
        crowd.exchange(0, 1);
        exchanged = true;
      }
      const std::vector<Track>& tracks =
          dut.update(crowd.time(), dark ? std::vector<detector::Detection>() : crowd.detections());
      if (dut.counts().bound == 0) bindAll(crowd, dut);
      if (dark || !exchanged) continue;
      Score score;
      score.add(crowd, tracks);
      right = static_cast<int>(score.poses - score.swapped);
      const bool wrong = score.swapped > 0;
      if (wrong && !last_wrong) wrong_since = crowd.time();
      if (wrong) longest = std::max(longest, crowd.time() - wrong_since);
      last_wrong = wrong;
    }
    EXPECT_FALSE(last_wrong) << seed;
    right_again += right == settings.robots ? 1 : 0;
  }

  // Reports are up to 0.1 s late; programs draw new speeds every half second.
  EXPECT_LT(longest, 6);
  EXPECT_GE(right_again, 10);
}

TEST(CapTracker, CountsAndCorrectsFlips) {
  CrowdSettings settings;
  settings.flip = 0.02;
  Crowd crowd(settings, programs()[0]);
  CapTracker dut({}, crowd.ids());
  Score score;
  // Flips in the first pictures cannot be detected.
  std::int64_t flipped_at_first = 0;
  for (int frame = 0; frame < 900; ++frame) {
    crowd.advance(dut);
    auto detections = crowd.detections();
    if (frame < 2) {
      detections.clear();
      flipped_at_first = crowd.flipped;
      for (std::size_t i = 0; i < crowd.size(); ++i) {
        detections.push_back(capAt(crowd.truth(i).x, crowd.truth(i).y, crowd.truth(i).theta));
      }
    }
    score.add(crowd, dut.update(crowd.time(), detections));
  }

  EXPECT_GT(crowd.flipped, 300);
  EXPECT_EQ(dut.counts().flips, crowd.flipped - flipped_at_first);
  EXPECT_EQ(score.flipped, 0);
}

TEST(CapTracker, AFlipInTheFirstPictureIsCorrectedSoon) {
  CapTracker dut({}, {1});
  double theta = 0;
  for (int frame = 0; frame < 6; ++frame) {
    theta =
        dut.update(frame / 30.0, {{capAt(0.5, 0.5, frame == 0 ? 1 - kTestPi : 1)}})[0].pose.theta;
  }

  EXPECT_NEAR(theta, 1, 1e-9);
}

TEST(CapTracker, ACorrectedFlipIsMarkedByItsQuality) {
  CapTracker dut({}, {1});
  dut.update(0, {{capAt(0.5, 0.5, 1)}});
  dut.update(0.033, {{capAt(0.5, 0.5, 1)}});
  const Track& track = dut.update(0.066, {{capAt(0.5, 0.5, 1 - kTestPi)}})[0];

  EXPECT_NEAR(track.pose.theta, 1, 1e-9);
  EXPECT_LT(track.pose.quality, 0.5F);
  EXPECT_TRUE(track.detected);
  EXPECT_EQ(dut.counts().flips, 1);
}

TEST(CapTracker, ReportsAllCapsOfUnrelatedPictures) {
  Random random(7);
  CapTracker dut({}, {});
  for (int picture = 0; picture < 50; ++picture) {
    std::vector<detector::Detection> detections;
    for (int i = 0; i < 12; ++i) {
      for (int j = 0; j < 4; ++j) {
        detections.push_back(capAt(0.06 + 0.09 * i + 0.01 * random.uniform(),
                                   0.1 + 0.2 * j + 0.1 * random.uniform(), 6 * random.uniform()));
      }
    }
    const std::vector<Track>& tracks = dut.update(picture / 30.0, detections);
    std::multimap<double, double> seen;
    for (const Track& track : tracks) {
      if (track.detected) seen.emplace(track.pose.x, track.pose.y);
    }
    ASSERT_EQ(seen.size(), detections.size());
    for (const detector::Detection& detection : detections) {
      ASSERT_EQ(seen.count(detection.x), 1U);
      ASSERT_EQ(seen.find(detection.x)->second, detection.y);
    }
  }
}

TEST(CapTracker, PredictsWhereEveryRobotWillBe) {
  for (const double fps : {10.0, 30.0, 100.0}) {
    CrowdSettings settings;
    settings.fps = fps;
    Crowd crowd(settings, programs()[3]);
    CapTracker dut({}, crowd.ids());
    for (int frame = 0; frame < 10 * fps; ++frame) {
      crowd.advance(dut);
      const std::vector<detector::Expected>& expected = dut.expect(crowd.time());
      if (frame > 0) {
        ASSERT_EQ(expected.size(), crowd.size());
      }
      for (const detector::Expected& place : expected) {
        bool found = false;
        for (std::size_t i = 0; i < crowd.size() && !found; ++i) {
          const dynamics::Pose at = crowd.truth(i);
          found = std::hypot(at.x - place.x, at.y - place.y) <= place.reach &&
                  std::abs(std::remainder(at.theta - place.theta, 2 * kTestPi)) <= place.turn;
        }
        ASSERT_TRUE(found) << fps << " fps, " << crowd.time() << " s";
        ASSERT_LE(place.reach, 0.0375);
      }
      dut.update(crowd.time(), crowd.detections());
    }
  }
}

TEST(CapTracker, PredictsAnUndetectedCapAndGivesItUpInTheEnd) {
  CapTracker dut({}, {1});
  for (int frame = 0; frame <= 200; ++frame) {
    dut.update(frame / 30.0, {{capAt(0.3 + 0.05 * frame / 30, 0.5, 0)}});
  }
  const double last = 200 / 30.0;
  dut.bind(1, 0.3 + 0.05 * last, 0.5, 0.01);

  const Track shortly = dut.update(last + 0.1, {})[0];
  const Track later = dut.update(last + 4.9, {})[0];

  EXPECT_FALSE(shortly.detected);
  EXPECT_EQ(shortly.robot_id, 1);
  EXPECT_NEAR(shortly.since_detection, 0.1, 1e-9);
  EXPECT_EQ(shortly.pose.quality, 0);
  EXPECT_NEAR(shortly.pose.x, 0.3 + 0.05 * (last + 0.1), 0.001);
  EXPECT_EQ(later.number, shortly.number);
  EXPECT_GT(later.pose.covariance[0], 100 * shortly.pose.covariance[0]);
  EXPECT_TRUE(dut.update(last + 5.1, {}).empty());
  EXPECT_EQ(dut.counts().lost, 1);
}

TEST(CapTracker, PredictionsWithReportsHaveASmallerSpread) {
  // The same second without pictures, with and without wheel reports.
  double spread[2];
  for (int with = 0; with < 2; ++with) {
    CapTracker dut({}, {1});
    for (int frame = 0; frame <= 30; ++frame) {
      dut.update(frame / 30.0, {{capAt(0.3 + 0.1 * frame / 30, 0.5, 0)}});
    }
    dut.bind(1, 0.4, 0.5, 0.01);
    for (int i = 0; i < 70 && with == 1; ++i) dut.addReports({{{1, i / 30.0, 0.1, 0.1}}});
    const Track track = dut.update(1.8, {})[0];
    if (with == 1) {
      EXPECT_NEAR(track.pose.x, 0.48, 0.001);
    }
    spread[with] = track.pose.covariance[0];
  }

  EXPECT_LT(spread[1], spread[0] / 20);
}

TEST(CapTracker, BindsOnlyExistingTracks) {
  CapTracker dut({}, {1, 2});
  dut.update(0, {{capAt(0.3, 0.5, 0), capAt(0.5, 0.5, 0)}});

  EXPECT_FALSE(dut.bind(3, 0.3, 0.5, 0.02)) << "no such robot";
  EXPECT_FALSE(dut.bind(1, 0.4, 0.5, 0.02)) << "nothing there";
  EXPECT_TRUE(dut.bind(1, 0.31, 0.5, 0.02));
  EXPECT_TRUE(dut.bind(1, 0.5, 0.5, 0.02)) << "somewhere else";
  const std::vector<Track>& tracks = dut.update(0.033, {{capAt(0.3, 0.5, 0), capAt(0.5, 0.5, 0)}});

  EXPECT_EQ(tracks[0].robot_id, -1);
  EXPECT_EQ(tracks[1].robot_id, 1);
  EXPECT_EQ(dut.counts().unbound, 1);
}

TEST(CapTracker, IgnoresValuesThatAreNotFinite) {
  CapTracker dut({}, {1});
  detector::Detection none = capAt(0.5, 0.5, 0);
  none.quality = 0;
  detector::Detection nowhere = capAt(std::numeric_limits<double>::quiet_NaN(), 0.5, 0);

  EXPECT_TRUE(dut.update(0, {{none, nowhere}}).empty());
}

TEST(CapTracker, AnIsolatedRobotStaysBoundOverALongGap) {
  CapTracker dut({}, {1});
  for (int frame = 0; frame < 60; ++frame) dut.update(frame / 30.0, {{capAt(0.5, 0.5, 0)}});
  dut.bind(1, 0.5, 0.5, 0.01);

  const std::vector<Track>& tracks = dut.update(4, {{capAt(0.52, 0.5, 0.1)}});

  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_EQ(tracks[0].robot_id, 1);
  EXPECT_TRUE(tracks[0].detected);
}

TEST(CapTracker, TwoAmbiguousTracksLoseTheirRobotsButNotTheirNumbers) {
  CapTracker dut({}, {1, 2});
  for (int frame = 0; frame < 60; ++frame) {
    dut.update(frame / 30.0, {{capAt(0.5, 0.5, 0), capAt(0.6, 0.5, 0)}});
  }
  dut.bind(1, 0.5, 0.5, 0.01);
  dut.bind(2, 0.6, 0.5, 0.01);

  const std::vector<Track>& tracks = dut.update(4, {{capAt(0.6, 0.52, 1), capAt(0.5, 0.51, 2)}});

  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_EQ(tracks[0].robot_id, -1);
  EXPECT_EQ(tracks[1].robot_id, -1);
  EXPECT_NEAR(tracks[0].pose.x, 0.5, 1e-9);
  EXPECT_NEAR(tracks[1].pose.x, 0.6, 1e-9);
  EXPECT_EQ(dut.counts().unbound, 2);
}

}  // namespace
}  // namespace lab::tracker
