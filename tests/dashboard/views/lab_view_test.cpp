/// Tests the topics that follow from packets: runs, replays, bounded memory.
#include "dashboard/views/lab_view.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <lab/robot_stop_t.hpp>
#include <lab/service_status_t.hpp>
#include <limits>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/math/random.hpp"
#include "common/process/version.hpp"
#include "tests/dashboard/message_samples.hpp"

namespace lab::dashboard {
namespace {

using testing::HasSubstr;

struct Bench {
  Bench()
      : dut(hub, "dashboard", 9, [](const auto&, const auto&) { return light::ImageStore{}; }) {}

  template <class Message>
  void send(std::string_view channel, Message message, std::int64_t now) {
    if (message.sender.empty()) message.sender = "lab";
    if (message.instance == 0) message.instance = 1;
    message.seq = ++seq[std::string(channel)];
    if (message.utime == 0) message.utime = now;
    const auto data = encode(message);
    dut.take({channel, data, now}, now);
  }

  void start(std::int64_t instance, std::int64_t now) {
    experiment_event_t event{};
    event.kind = experiment_event_t::START;
    event.instance = instance;
    event.text = writeExperiment(experimentForTests());
    send(channels::kExperimentEvent, event, now);
  }

  Json topic(const char* name) {
    const Hub::Text text = hub.newest(name);
    return text ? Json::parse(*text) : Json();
  }

  Hub hub;
  LabView dut;
  std::map<std::string, std::int64_t> seq;
};

TEST(LabView, SaysThatNoLabIsActive) {
  Bench bench;
  bench.dut.publishMoving(kNow, true);
  bench.dut.publishTotals(kNow, {});
  EXPECT_EQ(bench.topic("pulse")["bus_silent_s"], nullptr);
  EXPECT_THAT(bench.topic("health")["advice"][0]["what"], HasSubstr("no lab is active"));
  EXPECT_TRUE(bench.topic("robots").empty());
  EXPECT_EQ(bench.topic("stop")["state"], "free");
}

TEST(LabView, PublishesTheTopicsOfARun) {
  Bench bench;
  bench.start(1, kNow);
  bench.send(channels::kRobotStatus, statusOf({stateOf(3), stateOf(7)}), kNow);
  bench.send(channels::kTrackedFrame, frameOf(kNow, {poseOf(3, 0.1, 0.2)}), kNow);
  bench.send(channels::kAnalysis, poolOf("swim", kNow), kNow);
  bench.dut.publishMoving(kNow + 50'000, true);
  bench.dut.publishTotals(kNow + 2 * kSecond, {});
  EXPECT_EQ(bench.topic("lab")["name"], "two_programs");
  EXPECT_EQ(bench.topic("frame")["robots"].size(), 1U);
  EXPECT_EQ(bench.topic("robots").size(), 2U);
  EXPECT_EQ(bench.topic("pool/swim")["program"], "swim");
  EXPECT_EQ(bench.topic("history/swim")["t_s"].size(), 1U);
  EXPECT_EQ(bench.topic("timeline")["start_us"], kNow);
  EXPECT_EQ(bench.topic("pulse")["bus_silent_s"], 2);
  EXPECT_EQ(Json::parse(*bench.dut.query("robot", "7", kNow))["id"], 7);
  EXPECT_FALSE(bench.dut.query("robot", "7; rm", kNow));
  EXPECT_FALSE(bench.dut.query("robot", "", kNow));
  EXPECT_FALSE(bench.dut.query("secrets", "7", kNow));
}

TEST(LabView, AnotherRunRemovesTheDataOfThePreviousOne) {
  Bench bench;
  bench.start(1, kNow);
  bench.send(channels::kAnalysis, poolOf("swim", kNow), kNow);
  bench.send(channels::kRobotStatus, statusOf({stateOf(3)}), kNow);
  bench.dut.publishTotals(kNow, {});
  ASSERT_FALSE(bench.topic("pool/swim").is_null());
  bench.start(2, kNow + kSecond);
  bench.dut.publishMoving(kNow + kSecond, true);
  bench.dut.publishTotals(kNow + kSecond, {});
  EXPECT_TRUE(bench.topic("pool/swim").is_null());
  EXPECT_TRUE(bench.topic("history/swim").is_null());
  EXPECT_TRUE(bench.topic("robots").empty());
  EXPECT_EQ(bench.topic("timeline")["start_us"], kNow + kSecond);
}

TEST(LabView, KeepsAStopWhenStartIsRepeatedAndWhenAnotherRunBegins) {
  Bench bench;
  ASSERT_EQ(bench.dut.controls().request(StopRobots{}, kNow), "");
  bench.start(1, kNow);
  bench.start(1, kNow + 60 * kSecond);
  bench.dut.publishMoving(kNow + 60 * kSecond, true);
  EXPECT_EQ(bench.topic("stop")["state"], "stopping");
  EXPECT_EQ(bench.topic("stop")["unconfirmed"], Json({3, 7}));
  bench.start(2, kNow + 70 * kSecond);
  bench.dut.publishMoving(kNow + 70 * kSecond, true);
  EXPECT_EQ(bench.topic("stop")["state"], "stopping");
}

TEST(LabView, ShowsAStopWhateverItsHeaderIs) {
  for (const char* sender : {"panic",
                             "a button whose name is much longer than that of any service "
                             "of the lab"}) {
    Bench bench;
    bench.start(1, kNow);
    robot_stop_t stop{};
    stop.sender = sender;
    stop.utime = std::numeric_limits<std::int64_t>::min();
    stop.seq = -1;
    const auto data = encode(stop);
    bench.dut.take({channels::kRobotStop, data, kNow}, kNow);
    bench.dut.publishMoving(kNow, true);
    EXPECT_EQ(bench.topic("stop")["state"], "stopping") << sender;
  }
}

TEST(LabView, ShowsTheOtherRobotsOfAMessageWithAnImpossibleNumber) {
  Bench bench;
  bench.start(1, kNow);
  auto frame = frameOf(kNow, {poseOf(3, 0.1, 0.2), poseOf(7, 0.3, 0.4)});
  frame.robots[0].x = std::numeric_limits<double>::infinity();
  bench.send(channels::kTrackedFrame, frame, kNow);
  bench.dut.publishMoving(kNow + 50'000, true);
  bench.dut.publishTotals(kNow + kSecond, {});
  ASSERT_EQ(bench.topic("frame")["robots"].size(), 1U);
  EXPECT_EQ(bench.topic("health")["not_understood"],
            Json::parse(R"([{"channel": "TRACKED_FRAME", "messages": 1}])"));
}

TEST(LabView, AJumpInAReplayedLogRemovesEarlierData) {
  Bench bench;
  bench.start(1, kNow);
  experiment_status_t status{};
  status.sender = "replay";
  status.run = "run-5";
  status.phase = experiment_status_t::PLAYING;
  status.rate = 1;
  bench.send(channels::kExperimentStatus, status, kNow);
  bench.send(channels::kAnalysis, poolOf("swim", kNow), kNow);
  bench.dut.publishTotals(kNow, {});
  bench.dut.publishMoving(kNow, true);
  EXPECT_EQ(bench.topic("lab")["replay"], true);
  EXPECT_EQ(bench.topic("lab")["run"], "run-5");
  EXPECT_FALSE(bench.topic("pool/swim").is_null());
  status.jumps = 1;
  bench.send(channels::kExperimentStatus, status, kNow);
  EXPECT_TRUE(bench.topic("pool/swim").is_null());
  EXPECT_EQ(bench.topic("player")["jumps"], 1);
  EXPECT_EQ(bench.topic("lab")["name"], "two_programs");
}

TEST(LabView, CountsRobotsBeforeTheFirstStopAndShowsAnActiveStop) {
  Bench bench;
  bench.start(1, kNow);
  bench.send(channels::kRobotStatus, statusOf({stateOf(3), stateOf(7)}), kNow);
  bench.dut.publishMoving(kNow, true);
  EXPECT_EQ(bench.topic("stop")["state"], "free");
  EXPECT_EQ(bench.topic("stop")["total"], 2);
  robot_state_t standing = stateOf(3);
  standing.flags = robot_state_t::FLAG_STOPPED;
  standing.stop_seq = 5;
  bench.send(channels::kRobotStatus, statusOf({standing}), kNow);
  bench.dut.publishMoving(kNow, true);
  EXPECT_EQ(bench.topic("stop")["state"], "stopping");
  EXPECT_EQ(bench.topic("stop")["unconfirmed"], Json({7}));
  EXPECT_EQ(bench.dut.controls().request(ReleaseStop{}, kNow), "");
}

TEST(LabView, KnowsTheStartOfTheScriptWhenStartedLater) {
  Bench bench;
  bench.start(1, kNow + 60 * kSecond);
  experiment_status_t status{};
  status.phase = experiment_status_t::PREPARING;
  bench.send(channels::kExperimentStatus, status, kNow + 60 * kSecond);
  const auto begun = [&bench] {
    bench.dut.publishMoving(kNow, true);
    return bench.topic("timeline")["start_us"].get<std::int64_t>();
  };
  EXPECT_EQ(begun(), kNow + 60 * kSecond);
  status.phase = experiment_status_t::SCRIPT;
  status.elapsed = 61;
  bench.send(channels::kExperimentStatus, status, kNow + 61 * kSecond);
  EXPECT_EQ(begun(), kNow);
  status.phase = experiment_status_t::PAUSED;
  bench.send(channels::kExperimentStatus, status, kNow + 71 * kSecond);
  EXPECT_EQ(begun(), kNow) << "a pause does not change the start";
}

TEST(LabView, GivesNoAdviceForSilenceInAReplayedLog) {
  for (const bool replay : {false, true}) {
    Bench bench;
    bench.start(1, kNow);
    experiment_status_t status{};
    status.phase = replay ? experiment_status_t::PLAYING : experiment_status_t::SCRIPT;
    service_status_t service{};
    service.contract_version = kContractVersion;
    service.sender = "tracker_svc";
    service.start_utime = kNow;
    service.origin = robot_state_t::REPLAY;
    service.host = "here";
    service.pid = 77;
    bench.send(channels::kServiceStatus, service, kNow);
    bench.send(channels::kRobotStatus, statusOf({stateOf(3)}), kNow);
    bench.send(channels::kExperimentStatus, status, kNow + 60 * kSecond);
    bench.dut.publishTotals(kNow + 60 * kSecond, {});
    EXPECT_EQ(bench.topic("health")["advice"].empty(), replay) << bench.topic("health")["advice"];
    EXPECT_TRUE(bench.dut.health().pids("here").empty())
        << "process ids of a replayed log mean nothing now";
  }
}

TEST(LabView, SharesTheTrailsBetweenQueriesWithinHalfASecond) {
  Bench bench;
  bench.send(channels::kTrackedFrame, frameOf(kNow, {poseOf(3, 0.1, 0.2)}), kNow);
  const auto first = bench.dut.query("trails", "", kNow);
  bench.send(channels::kTrackedFrame, frameOf(kNow + kSecond / 4, {poseOf(3, 0.2, 0.2)}), kNow);
  EXPECT_EQ(bench.dut.query("trails", "", kNow + kSecond / 4), first);
  EXPECT_NE(bench.dut.query("trails", "", kNow + kSecond / 2), first);
}

TEST(LabView, UsesAtMostTwentyFramesPerSecond) {
  Bench bench;
  int frames = 0;
  std::string last;
  for (int i = 0; i < 300; ++i) {  // a camera at 100 Hz
    const std::int64_t now = kNow + i * 10'000;
    bench.send(channels::kTrackedFrame, frameOf(now, {poseOf(3, 0.1 + 1e-3 * i, 0.2)}), now);
    bench.dut.publishMoving(now, true);
    const Hub::Text text = bench.hub.newest("frame");
    frames += text && *text != last ? 1 : 0;
    last = *text;
  }
  EXPECT_LE(frames, 60);
  EXPECT_GE(frames, 57);
  bench.dut.publishTotals(kNow + 3 * kSecond, {});
  EXPECT_EQ(bench.topic("health")["streams"][0]["received"], 300) << "all are counted";
}

TEST(LabView, CountsMessagesOfAnotherContract) {
  Bench bench;
  service_status_t wrong{};
  wrong.sender = "old";
  wrong.instance = 1;
  const auto data = encode(wrong);
  bench.dut.take({channels::kRobotStatus, data, kNow}, kNow);
  const std::vector<std::uint8_t> junk{1, 2, 3};
  bench.dut.take({channels::kRobotStatus, junk, kNow}, kNow);
  bench.dut.publishTotals(kNow, {});
  EXPECT_EQ(bench.topic("health")["not_understood"][0]["messages"], 2);
}

TEST(LabView, IgnoresItsOwnMessages) {
  Bench bench;
  service_status_t own{};
  own.sender = "dashboard";
  own.instance = 9;
  own.start_utime = kNow;
  bench.send(channels::kServiceStatus, own, kNow);
  bench.dut.publishTotals(kNow, {});
  EXPECT_EQ(bench.topic("pulse")["bus_silent_s"], nullptr);
  EXPECT_EQ(bench.topic("health")["services"].size(), 1U);
}

/// Compares with <cos(theta(t) - theta(0))> of an ABP as in the paper, simulated independently.
TEST(LabView, MeasuresTheHeadingCorrelation) {
  Bench bench;
  bench.start(1, kNow);
  const Experiment experiment = experimentForTests();
  const program_id_t swim = toId(experiment.programs.at("swim"));
  Random random(5);
  constexpr int kRobots = 10;
  std::vector<double> theta(kRobots);
  std::vector<double> rate(kRobots);
  for (int i = 0; i < 20 * 400; ++i) {  // 400 s at 20 Hz, a new turning rate every 0.2 s
    const std::int64_t now = kNow + i * 50'000;
    std::vector<tracked_pose_t> poses;
    std::vector<robot_state_t> states;
    for (int r = 0; r < kRobots; ++r) {
      const auto k = static_cast<std::size_t>(r);
      if (i % 4 == 0) rate[k] = 3 * (2 * random.uniform() - 1);
      poses.push_back(poseOf(r, 0.1 + 0.1 * r, 0.45, std::remainder(theta[k], 2 * M_PI)));
      robot_state_t state = stateOf(r, swim);
      state.utime = now;
      state.program_epoch = 1;
      state.program_start_utime = kNow;
      states.push_back(state);
      theta[k] += rate[k] * 0.05;
    }
    bench.send(channels::kTrackedFrame, frameOf(now, poses), now);
    robot_status_t status = statusOf(states);
    status.utime = now;
    bench.send(channels::kRobotStatus, status, now);
  }
  bench.send(channels::kAnalysis, poolOf("swim", kNow), kNow);
  bench.dut.publishTotals(kNow + 400 * kSecond, {});
  const Json pool = bench.topic("pool/swim");
  const Json& curve = pool["curves"].back();
  ASSERT_EQ(curve["name"], "C_l");
  ASSERT_EQ(curve["value"].size(), HeadingCorrelation::kLags);
  double most = 0;
  double sum = 0;
  for (std::size_t k = 0; k < HeadingCorrelation::kLags; ++k) {
    const double off = curve["value"][k].get<double>() - curve["exact"][k].get<double>();
    const double z = off / curve["sigma"][k].get<double>();
    most = std::max(most, std::abs(z));
    sum += z * z;
  }
  EXPECT_LT(most, 4);
  EXPECT_GT(sum / HeadingCorrelation::kLags, 0.02) << "the standard errors are not too small";
  // v 4 cm/s, D_r = eta^2 epsilon / 6 = 0.3 /s: l at the last lag is 4 cm/s x 4 / 0.3 s.
  EXPECT_NEAR(curve["lag_cm"].back().get<double>(), 4 * 4 / 0.3, 1);
}

/// 24 h of a lab with 100 robots, at a reduced rate.
TEST(LabView, UsesBoundedMemoryDuringADay) {
  Bench bench;
  bench.start(1, kNow);
  const Experiment experiment = experimentForTests();
  const program_id_t tumble = toId(experiment.programs.at("tumble"));
  std::size_t at_noon = 0;
  const auto size = [&bench](std::int64_t now) {
    std::size_t sum = 0;
    std::uint64_t seen = 0;
    for (const auto& change : bench.hub.changesSince(seen, std::chrono::milliseconds(0))) {
      sum += change.text->size();
    }
    return sum + bench.dut.query("trails", "", now)->size();
  };
  for (int i = 0; i < 24 * 120; ++i) {  // every 30 s
    const std::int64_t now = kNow + std::int64_t{i} * 30 * kSecond;
    std::vector<tracked_pose_t> poses;
    std::vector<robot_state_t> states;
    for (int r = 0; r < 100; ++r) {
      poses.push_back(poseOf(r, 0.01 * r, 0.3));
      robot_state_t state = stateOf(r, tumble);
      state.utime = now;
      state.tumble_count = i;
      state.run_time = 1.5 * i;
      states.push_back(state);
    }
    bench.send(channels::kTrackedFrame, frameOf(now, poses), now);
    bench.send(channels::kRobotStatus, statusOf(states), now);
    analysis_t pool = poolOf("tumble", now);
    bench.send(channels::kAnalysis, pool, now);
    experiment_event_t event{};
    event.kind = i % 3 == 0 ? experiment_event_t::MARK : experiment_event_t::STEP;
    event.step = i;
    event.text = "a mark";
    bench.send(channels::kExperimentEvent, event, now);
    if (i % 20 == 0) bench.dut.publishMoving(now, true);
    if (i % 20 == 0) bench.dut.publishTotals(now, {});
    if (i == 12 * 120) at_noon = size(now);
  }
  const std::size_t in_the_end = size(kNow + 24 * 3600 * kSecond);
  EXPECT_LT(in_the_end, at_noon + at_noon / 10);
  EXPECT_LT(in_the_end, 3'000'000U);
  EXPECT_EQ(bench.topic("timeline")["steps"].size(), TimelineView::kMaxSteps);
  EXPECT_GT(bench.topic("timeline")["marks_before"].get<int>(), 400);
  EXPECT_LE(bench.topic("history/tumble")["t_s"].size(), HistoryView::kMaxPoints);
}

TEST(LabView, KeepsARunWhoseEventsAreForged) {
  Bench bench;
  bench.start(1, kNow);
  bench.send(channels::kRobotStatus, statusOf({stateOf(3)}), kNow);
  experiment_event_t forged{};
  forged.sender = "forger";
  for (const std::int8_t kind : {experiment_event_t::START, experiment_event_t::END}) {
    forged.kind = kind;
    bench.send(channels::kExperimentEvent, forged, kNow + 1000);
  }
  bench.dut.publishMoving(kNow + 1000, true);
  bench.dut.publishTotals(kNow + 1000, {});
  EXPECT_EQ(bench.topic("timeline")["start_us"], kNow);
  EXPECT_EQ(bench.topic("timeline")["end"], nullptr);
  EXPECT_FALSE(bench.topic("robots").empty());
}

/// A page that was restarted in a run, before the next START.
TEST(LabView, TakesEventsWhileItsRunnerIsUnknown) {
  Bench bench;
  experiment_event_t end{};
  end.kind = experiment_event_t::END;
  end.text = "the script is over";
  bench.send(channels::kExperimentEvent, end, kNow);
  bench.dut.publishMoving(kNow, true);
  bench.dut.publishTotals(kNow, {});
  EXPECT_NE(bench.topic("timeline")["end"], nullptr);
}

TEST(LabView, GoesOnAfterASenderWithAZeroInside) {
  Bench bench;
  robot_status_t status = statusOf({stateOf(3)});
  status.sender = "sim_svc";
  std::vector<std::uint8_t> data = encode(status);
  data[22] = 0;
  bench.dut.take({channels::kRobotStatus, data, kNow}, kNow);
  bench.dut.publishTotals(kNow, {});
  EXPECT_EQ(bench.topic("health")["advice"][0]["level"].is_string(), true);
}

}  // namespace
}  // namespace lab::dashboard
