#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "common/math/units.hpp"
#include "dashboard/views/crowd_view.hpp"
#include "dashboard/views/curves_view.hpp"
#include "dashboard/views/history_view.hpp"
#include "dashboard/views/light_picture.hpp"
#include "dashboard/views/robots_view.hpp"
#include "dashboard/views/run_info.hpp"
#include "dashboard/views/run_times.hpp"
#include "dashboard/views/timeline_view.hpp"
#include "dashboard/views/tracks_view.hpp"
#include "tests/dashboard/message_samples.hpp"

namespace lab::dashboard {
namespace {

struct Sheet {
  Sheet() { run_info.set(experimentForTests(), "run-1"); }
  RunInfo run_info;
};

program_id_t programNamed(const char* name) { return toId(experimentForTests().programs.at(name)); }

TEST(RunInfo, DescribesTheExperimentInCentimetres) {
  const Sheet s;
  const Json json = Json::parse(s.run_info.json());
  EXPECT_EQ(json["run"], "run-1");
  EXPECT_EQ(json["arena_cm"], Json({120, 90}));
  EXPECT_EQ(json["robot_diameter_cm"], 7.5);
  EXPECT_EQ(json["robots"][1], Json({{"id", 7}, {"body", "sim"}}));
  EXPECT_EQ(json["programs"][1]["name"], "tumble");
  EXPECT_EQ(json["programs"][1]["color"], 1);
  EXPECT_EQ(json["programs"][1]["rgb"], "#D55E00");
  EXPECT_EQ(json["programs"][0]["text"], "v 4 cm/s, ε 0.2 s, η 3 rad/s");
  EXPECT_EQ(json["programs"][1]["text"], "v 4 cm/s, γ 0.5 1/s, τt 0.5 s");
  EXPECT_NE(json["programs"][1]["description"], "");
  EXPECT_EQ(json["bands"][0]["program"], "swim");
  EXPECT_NE(json["file"].get<std::string>().find("two_programs"), std::string::npos);
}

TEST(RunInfo, DetectsAnotherRunByTheSenderOfStart) {
  RunInfo dut;
  experiment_event_t start{};
  start.kind = experiment_event_t::START;
  start.sender = "lab";
  start.instance = 1;
  start.text = writeExperiment(experimentForTests());
  EXPECT_EQ(dut.take(start), RunInfo::RunChange::kFirst);
  EXPECT_TRUE(dut.known()) << dut.trouble();
  EXPECT_EQ(dut.take(start), RunInfo::RunChange::kNone) << "START is repeated every minute";
  start.instance = 2;
  EXPECT_EQ(dut.take(start), RunInfo::RunChange::kOtherRun);
  start.instance = 3;
  start.text = "fileversion = 99";
  EXPECT_EQ(dut.take(start), RunInfo::RunChange::kOtherRun);
  EXPECT_FALSE(dut.known());
  EXPECT_NE(dut.trouble(), "");
}

TEST(RobotsView, FrameHasRobotsDetectedWithinASecond) {
  const Sheet s;
  RobotsView dut(s.run_info);
  robot_state_t state = stateOf(3, programNamed("tumble"));
  state.flags = robot_state_t::FLAG_TUMBLING;
  dut.take(statusOf({state}), kNow);
  tracked_frame_t frame = frameOf(kNow, {poseOf(3, 0.6, 0.3, M_PI / 2), poseOf(7, 1, 0.1)});
  frame.unidentified = {poseOf(-1, 0.11, 0.22, -M_PI / 2)};
  frame.num_unidentified = 1;
  dut.take(frame, kNow);
  dut.take(frameOf(kNow + 900'000, {poseOf(3, 0.6, 0.3, M_PI / 2)}), kNow + 900'000);
  Json json = Json::parse(dut.frameJson(kNow + kSecond));
  EXPECT_EQ(json["t_us"], kNow + 900'000);
  ASSERT_EQ(json["robots"].size(), 2U);
  EXPECT_EQ(json["robots"][0], Json::parse("[3,60.0,30.0,90.0,1,16,2,1.0,0.1]"));
  EXPECT_EQ(json["robots"][1][4], -1);
  EXPECT_TRUE(json["unidentified"].empty());
  json = Json::parse(dut.frameJson(kNow + kSecond + 1));
  EXPECT_EQ(json["robots"].size(), 1U);
  dut.take(frame, kNow + kSecond);
  json = Json::parse(dut.frameJson(kNow + kSecond));
  EXPECT_EQ(json["unidentified"], Json::parse("[[11.0,22.0,-90.0]]"));
}

TEST(RobotsView, DropsImplausiblePoses) {
  const Sheet s;
  RobotsView dut(s.run_info);
  dut.take(frameOf(kNow, {poseOf(3, std::nan(""), 0.3)}), kNow);
  EXPECT_TRUE(Json::parse(dut.frameJson(kNow))["robots"].empty());
}

TEST(RobotsView, ReportsTheStatesOfRobots) {
  const Sheet s;
  RobotsView dut(s.run_info);
  robot_state_t state = stateOf(7, programNamed("swim"));
  state.flags = robot_state_t::FLAG_STOPPED;
  state.light_front = 0.25F;
  state.light_back = 0.75F;
  state.link_errors = 4;
  state.wheel_left = 0.05;
  dut.take(statusOf({state}), kNow);
  const Json row = Json::parse(dut.robotsJson(kNow + 2 * kSecond))[0];
  EXPECT_EQ(row["id"], 7);
  EXPECT_EQ(row["owner"], "sim_svc");
  EXPECT_EQ(row["age_s"], 2);
  EXPECT_EQ(row["light"], 0.5);
  EXPECT_EQ(row["program"], "swim");
  EXPECT_EQ(row["link_errors"], 4);
  EXPECT_EQ(row["stopped"], true);
  const Json one = Json::parse(dut.robotJson(7, kNow).value());
  EXPECT_EQ(one["wheel_left_cm_s"], 5);
  EXPECT_EQ(one["program"], "swim");
  EXPECT_EQ(one["phase"], "run");
  EXPECT_EQ(one["x_cm"], nullptr);
  dut.take(frameOf(kNow, {poseOf(7, 0.123456, 1e300), poseOf(7, 0.5, 0.5)}), kNow);
  dut.take(frameOf(kNow, {poseOf(7, 0.123456, 0.2, 1)}), kNow);
  const std::string text = dut.robotJson(7, kNow).value();
  EXPECT_NE(text.find("\"x_cm\":12.3,"), std::string::npos) << text;
  EXPECT_NE(text.find("\"theta_deg\":57.3,"), std::string::npos) << text;
  EXPECT_FALSE(dut.robotJson(8, kNow));
}

TEST(RobotsView, NamesTheProgramAndItsPhase) {
  const Sheet s;
  RobotsView dut(s.run_info);
  const auto answer = [&dut](const program_id_t& program, std::int8_t phase) {
    robot_state_t state = stateOf(7, program);
    state.phase = phase;
    dut.take(statusOf({state}), kNow);
    const Json robot = Json::parse(dut.robotJson(7, kNow).value());
    return robot["program"].get<std::string>() + "/" + robot["phase"].get<std::string>();
  };
  EXPECT_EQ(answer(programNamed("tumble"), 0), "tumble/run");
  EXPECT_EQ(answer(programNamed("tumble"), 1), "tumble/tumble");
  EXPECT_EQ(answer(programNamed("tumble"), 2), "tumble/") << "it has two phases";
  EXPECT_EQ(answer(program_id_t{}, 0), "standing/");
  program_id_t other{};
  other.name = "driven";
  EXPECT_EQ(answer(other, 0), "driven/");
  other.hash = 5;
  other.name = "of ROS 2";
  EXPECT_EQ(answer(other, 0), "of ROS 2/");
  // The experiment's name counts, not that of the message.
  other.hash = programNamed("swim").hash;
  EXPECT_EQ(answer(other, 0), "swim/run");
}

TEST(TracksView, KeepsOnePositionPer200msForAMinute) {
  TracksView dut;
  for (int i = 0; i < 50 * 70; ++i) {  // 70 s at 50 Hz, 4 cm/s along x
    const double t = i * 0.02;
    std::vector<tracked_pose_t> poses{poseOf(3, 0.04 * t, 0.5)};
    if (t >= 69.5) poses.push_back(poseOf(7, 0.1, 0.2));
    dut.take(frameOf(kNow + i * 20'000, poses));
  }
  EXPECT_EQ(dut.steps(), TracksView::kSteps);
  const Json trails = Json::parse(dut.trailsJson());
  EXPECT_EQ(trails["step_s"], 0.2);
  EXPECT_EQ(trails["robots"]["3"].size(), 2 * TracksView::kSteps);
  EXPECT_EQ(trails["robots"]["7"].size(), 2U * 2U);
  EXPECT_NEAR(trails["robots"]["3"][600].get<double>(), 4 * 69.8, 0.06);
  const Json speeds = Json::parse(dut.speedsJson(3));
  ASSERT_EQ(speeds["t_s"].size(), TracksView::kSteps - 1);
  for (const auto& speed : speeds["speed_cm_s"]) EXPECT_NEAR(speed.get<double>(), 4, 1e-3);
  EXPECT_NEAR(speeds["t_s"].back().get<double>(), -0.1, 1e-9);
}

/// Whoever can send on the bus may use new ids in each frame.
TEST(TracksView, HasTrailsOfTheRobotsOfTheNewestFrames) {
  TracksView dut;
  constexpr auto kMost = static_cast<std::int32_t>(TracksView::kMaxRobots);
  for (std::int32_t step = 0; step < 300; ++step) {
    std::vector<tracked_pose_t> poses;
    for (std::int32_t robot = 0; robot < kMost; ++robot) {
      poses.push_back(poseOf(step < 298 ? 1000 + step * kMost + robot : robot, 0.1, 0.2));
    }
    if (step == 299) poses.resize(20);
    dut.take(frameOf(kNow + step * TracksView::kStep_us, poses));
  }

  const std::string text = dut.trailsJson();

  EXPECT_LT(text.size(), 50'000U);
  const Json trails = Json::parse(text)["robots"];
  EXPECT_EQ(trails.size(), TracksView::kMaxRobots);
  EXPECT_EQ(trails["0"], Json::parse("[10.0,20.0,10.0,20.0]"));
  EXPECT_EQ(trails["499"], Json::parse("[10.0,20.0,null,null]"));
}

TEST(TracksView, HasGapsWhereARobotWasNotDetected) {
  TracksView dut;
  dut.take(frameOf(kNow, {poseOf(3, 0.1, 0.1)}));
  dut.take(frameOf(kNow + 200'000, {}));
  dut.take(frameOf(kNow + 400'000, {poseOf(3, 0.2, 0.1)}));
  dut.take(frameOf(kNow + 600'000, {}));
  EXPECT_EQ(Json::parse(dut.trailsJson())["robots"]["3"],
            Json::parse("[10.0,10.0,null,null,20.0,10.0,null,null]"));
  EXPECT_TRUE(Json::parse(dut.speedsJson(3))["t_s"].empty());
}

TEST(CurvesView, ConvertsAPoolToCentimetres) {
  CurvesView dut;
  dut.take(poolOf("swim", kNow));
  EXPECT_EQ(dut.takeChanged(), std::vector<std::string>{"swim"});
  EXPECT_TRUE(dut.takeChanged().empty());
  const Json json = Json::parse(toText(analysisJson(*dut.pool("swim"))));
  EXPECT_EQ(json["verdict"], "agrees");
  EXPECT_EQ(json["curves"][0]["value"], Json({100, 200}));
  EXPECT_EQ(json["curves"][0]["unit"], "cm²");
  EXPECT_EQ(json["curves"][0]["biased"], Json({0, 1}));
  EXPECT_EQ(json["estimates"][0]["value"], 4);
  EXPECT_EQ(json["estimates"][0]["theory"], nullptr);
  EXPECT_EQ(json["estimates"][0]["note"], "by \"speed\"");
}

TEST(CurvesView, SelectsTheAnalysisOfOneRobot) {
  CurvesView dut;
  analysis_t analysis = poolOf("swim", kNow);
  analysis.robot_id = 7;
  dut.take(analysis);
  EXPECT_EQ(Json::parse(dut.robotJson(7)).size(), 1U);
  EXPECT_TRUE(Json::parse(dut.robotJson(3)).empty());
  EXPECT_TRUE(dut.takeChanged().empty());
}

/// A message about all robots.
collective_t crowdOf(std::int64_t utime, double order) {
  collective_t message{};
  message.utime = utime;
  message.robots = 20;
  observable_t polar{};
  polar.name = "polar_order";
  polar.unit = "1";
  polar.now = order;
  polar.mean = 0.25;
  polar.low = polar.high = units::kNan;
  observable_t speed = polar;
  speed.name = "speed";
  speed.unit = "m/s";
  message.observables = {polar, speed};
  observable_curve_t pairs{};
  pairs.name = "pair_distribution";
  pairs.x_unit = "m";
  pairs.unit = "1";
  pairs.x = {0.08F};
  pairs.value = {1.5F};
  pairs.low = {1.25F};
  pairs.high = {1.75F};
  message.curves = {pairs};
  crowd_member_t member{};
  member.robot_id = 7;
  member.cluster = 2;
  member.density = 0.5F;
  member.hexatic = static_cast<float>(units::kNan);
  message.members = {member};
  return message;
}

TEST(CrowdView, ConvertsTheCrowdToCentimetres) {
  CrowdView dut;
  dut.take(crowdOf(kNow, 0.5), kNow - 3 * kSecond);
  EXPECT_EQ(dut.takeChanged(), std::vector<std::string>{""});
  EXPECT_TRUE(dut.takeChanged().empty());
  const Json json = Json::parse(dut.json(""));
  EXPECT_EQ(json["robots"], 20);
  EXPECT_EQ(json["observables"][1]["now"], 50);
  EXPECT_EQ(json["observables"][1]["unit"], "cm/s");
  EXPECT_EQ(json["observables"][0]["low"], nullptr);
  EXPECT_EQ(json["curves"][0]["x"], Json({8}));
  EXPECT_EQ(json["curves"][0]["low"], Json({1.25}));
  EXPECT_EQ(json["members"], Json::parse("[[7, 2, 0.5, null]]"));
  EXPECT_EQ(json["history"]["t_s"], Json({3}));
  EXPECT_EQ(json["history"]["polar_order"]["now"], Json({0.5}));
  EXPECT_EQ(json["history"]["largest_cluster"]["now"], Json::parse("[null]"));
  EXPECT_EQ(dut.json("swim"), "");
}

TEST(CrowdView, KeepsProgramsApartAndTheirHistoryBounded) {
  CrowdView dut;
  for (int i = 0; i < 3000; ++i) {
    collective_t message = crowdOf(kNow + i * kSecond, 0.5);
    message.program = programNamed("swim");
    dut.take(message, kNow);
  }
  EXPECT_EQ(dut.takeChanged(), std::vector<std::string>{"swim"});
  const Json history = Json::parse(dut.json("swim"))["history"];
  EXPECT_LE(history["t_s"].size(), CrowdView::kMaxPoints);
  EXPECT_GE(history["t_s"].size(), CrowdView::kMaxPoints / 2);
  EXPECT_EQ(history["polar_order"]["now"].size(), history["t_s"].size());
  EXPECT_GE(history["t_s"].back().get<double>(), 2980);
  dut.clear();
  EXPECT_EQ(dut.json("swim"), "");
}

TEST(HistoryView, DropsEverySecondPointWhenFull) {
  HistoryView dut;
  const int points = 1000;
  for (int i = 0; i < points * 5; ++i) dut.take(poolOf("swim", kNow + i * kSecond), kNow);
  EXPECT_LE(dut.points("swim"), HistoryView::kMaxPoints);
  EXPECT_GE(dut.points("swim"), HistoryView::kMaxPoints / 2);
  const Json json = Json::parse(dut.json("swim"));
  EXPECT_EQ(json["t_s"].front(), 0);
  EXPECT_GE(json["t_s"].back().get<double>(), points * 5 - 11);
  EXPECT_EQ(json["estimates"][0]["value"].size(), json["t_s"].size());
  EXPECT_EQ(json["estimates"][0]["low"][7], 3.8);
  for (std::size_t i = 1; i < json["t_s"].size(); ++i) {
    EXPECT_GT(json["t_s"][i].get<double>(), json["t_s"][i - 1].get<double>());
  }
}

TEST(RunTimes, MeasuresRunsBetweenConsecutiveTumbles) {
  const Sheet s;
  RunTimes dut(s.run_info);
  // A robot runs 1.5 s and tumbles 0.3 s, reported at 20 Hz; the reports begin during a run.
  const double cycle = 1.8;
  for (int i = 0; i < 20 * 19; ++i) {
    const double t = 0.71 + i * 0.05;
    const double in_cycle = std::fmod(t, cycle);
    robot_state_t state = stateOf(3, programNamed("tumble"));
    state.tumble_count = static_cast<int>(t / cycle) + (in_cycle >= 1.5 ? 1 : 0);
    state.run_time = std::floor(t / cycle) * 1.5 + std::min(in_cycle, 1.5);
    dut.take(statusOf({state}));
  }
  EXPECT_EQ(dut.takeChanged(), std::vector<std::string>{"tumble"});
  const Json json = Json::parse(dut.json("tumble"));
  // Tumbles begin at 1.5 + 1.8 n up to 19.65: eleven, so ten runs between them.
  EXPECT_EQ(json["runs"], 10);
  EXPECT_NEAR(json["mean_s"].get<double>(), 1.5, 1e-5);
  EXPECT_EQ(json["edges_s"][1], 0.5);
  EXPECT_EQ(json["counts"][3].get<int>() + json["counts"][2].get<int>(), 10);
}

TEST(RunTimes, SkipsRunsWithAMissedTumble) {
  const Sheet s;
  RunTimes dut(s.run_info);
  robot_state_t state = stateOf(3, programNamed("tumble"));
  for (const int count : {0, 1, 3, 4}) {
    state.tumble_count = count;
    state.run_time = 1.0 * count;
    dut.take(statusOf({state}));
  }
  // The begin of 0 was not observed, 1 -> 3 misses a tumble, and so the begin of 3 is unknown.
  EXPECT_TRUE(dut.takeChanged().empty());
}

TEST(TimelineView, KeepsTheNewestStepsAndCountsOmittedOnes) {
  TimelineView dut;
  experiment_event_t event{};
  event.kind = experiment_event_t::STEP;
  for (int i = 0; i < 2100; ++i) {
    event.step = i;
    event.commanded_utime = kNow + i;
    dut.take(event);
    dut.take(event);  // events are repeated
  }
  event.kind = experiment_event_t::MARK;
  event.utime = kNow;
  event.text = "odd \xff";
  dut.take(event);
  dut.take(event);
  const Json json = Json::parse(dut.json());
  EXPECT_EQ(json["steps"].size(), TimelineView::kMaxSteps);
  EXPECT_EQ(json["steps_before"], 1600);
  EXPECT_EQ(json["steps"][0]["number"], 1600);
  EXPECT_EQ(json["steps"][0]["presented_us"], nullptr);
  EXPECT_EQ(json["marks"].size(), 1U);
  EXPECT_EQ(json["marks"][0]["text"], "odd \xEF\xBF\xBD");
  EXPECT_EQ(json["end"], nullptr);
}

TEST(TimelineView, ReportsTheStatesOfScriptAndPlayer) {
  experiment_status_t status{};
  status.phase = experiment_status_t::SCRIPT;
  status.elapsed = 10;
  status.left = 50;
  status.step_left = std::nan("");
  Json json = Json::parse(scriptJson(status));
  EXPECT_EQ(json["phase"], "script");
  EXPECT_EQ(json["step_left_s"], nullptr);
  EXPECT_FALSE(isPlayed(status));
  status.phase = experiment_status_t::PLAY_PAUSED;
  status.rate = 4;
  EXPECT_TRUE(isPlayed(status));
  json = Json::parse(playerJson(status));
  EXPECT_EQ(json["length_s"], 60);
  EXPECT_EQ(json["speed"], 4);
  EXPECT_EQ(json["paused"], true);
}

light_status_t halfWhite() {
  light_status_t status{};
  light_layer_t layer{};
  layer.kind = light_layer_t::HALF_PLANE;
  layer.x = 0.6;
  layer.y = 0.45;
  layer.intensity = 1;
  layer.intensity2 = 0;
  status.layers = {layer};
  status.num_layers = 1;
  status.mix = 1;
  status.commander = "lab";
  status.label = "half";
  return status;
}

TEST(LightPicture, PaintsTheLightOfTheStatus) {
  LightPicture dut;
  EXPECT_FALSE(dut.paint(kNow));
  dut.take(halfWhite());
  ASSERT_TRUE(dut.paint(kNow));
  const Json json = Json::parse(dut.json("lab"));
  EXPECT_EQ(json["columns"], 120);
  EXPECT_EQ(json["rows"], 90);
  EXPECT_NEAR(json["mean"].get<double>(), 0.5, 0.01);
  EXPECT_EQ(json["manual"], false);
  ASSERT_EQ(dut.pixels().size(), 120U * 90U);
  EXPECT_NE(dut.pixels()[0], dut.pixels()[119]);
  EXPECT_FALSE(dut.paint(kNow + kSecond)) << "nothing has changed";
  dut.take(halfWhite());
  EXPECT_FALSE(dut.paint(kNow + kSecond)) << "the same status again";
}

TEST(LightPicture, PaintsMovingLightAtFiveHertz) {
  LightPicture dut;
  light_status_t status = halfWhite();
  status.moving = 1;
  int painted = 0;
  for (int i = 0; i < 100; ++i) {  // 1 s
    status.layers[0].x = 0.6 + i * 1e-3;
    dut.take(status);
    painted += dut.paint(kNow + i * 10'000) ? 1 : 0;
  }
  EXPECT_EQ(painted, 5);
}

TEST(LightPicture, SaysWhyALightCannotBePainted) {
  LightPicture dut;
  light_status_t status = halfWhite();
  status.layers[0].kind = 99;
  dut.take(status);
  dut.paint(kNow);
  EXPECT_NE(Json::parse(dut.json("lab"))["trouble"], "");
  status.layers[0].kind = light_layer_t::IMAGE;
  status.layers[0].size = status.layers[0].inner = 0.5;
  status.layers[0].image = std::string(64, 'a');
  status.command_seq = 1;
  dut.take(status);
  dut.paint(kNow + kSecond);
  const std::string trouble = Json::parse(dut.json("lab"))["trouble"];
  EXPECT_NE(trouble.find("an image that was loaded here"), std::string::npos) << trouble;
}

}  // namespace
}  // namespace lab::dashboard
