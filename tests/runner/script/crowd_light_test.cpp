#include "runner/script/crowd_light.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "runner/script/step_condition.hpp"
#include "runner/script/stop_rules.hpp"
#include "tests/support/programs.hpp"

namespace lab::runner::crowd_light_test {
namespace {

constexpr std::int64_t kBegin = 1'000'000'000;
constexpr std::int64_t kSecond = 1'000'000;

Experiment experiment() {
  Experiment experiment;
  experiment.programs["abp"] = test::abp(0.03, 0.5, 3);
  return experiment;
}

/// A message about all robots at this time [s].
collective_t crowd(double seconds, const std::string& name, double now, double sigma = 0.1,
                   const std::string& unit = "1") {
  collective_t message{};
  message.utime = kBegin + static_cast<std::int64_t>(seconds * kSecond);
  observable_t one{};
  one.name = name;
  one.unit = unit;
  one.now = one.mean = now;
  one.sigma = sigma;
  message.observables = {one};
  message.num_observables = 1;
  return message;
}

EndCondition until(const std::string& name, double over) {
  EndCondition until;
  until.observable = name;
  until.over = over;
  return until;
}

TEST(CrowdCondition, HoldsWhenTheMeanOverTheWholeTimeIsBeyondTheLimit) {
  EndCondition order = until("polar_order", 3);
  order.above = 0.5;
  CrowdCondition dut(experiment(), order);
  EXPECT_EQ(dut.progress(), "polar_order was not measured");
  EXPECT_TRUE(dut.take(crowd(0, "polar_order", 0.9)));
  EXPECT_TRUE(dut.take(crowd(1, "polar_order", 0.9)));
  EXPECT_FALSE(dut.holds()) << "three seconds are not over";
  EXPECT_EQ(dut.progress(),
            "0.9 over 3 s, for less than that time; wanted: polar_order is above 0.5");
  dut.take(crowd(2, "polar_order", 0.1));
  dut.take(crowd(3, "polar_order", 0.1));
  EXPECT_FALSE(dut.holds()) << "the mean is 0.5";
  dut.take(crowd(4, "polar_order", 1));
  EXPECT_TRUE(dut.holds()) << "of 0.9, 0.1, 0.1 and 1";
}

TEST(CrowdCondition, BeginsAgainWhenThereIsNoValue) {
  EndCondition order = until("hexatic_order", 1);
  order.below = 0.5;
  CrowdCondition dut(experiment(), order);
  dut.take(crowd(0, "hexatic_order", 0.1));
  dut.take(crowd(1, "hexatic_order", 0.1));
  EXPECT_TRUE(dut.holds());
  dut.take(crowd(2, "hexatic_order", units::kNan));
  EXPECT_FALSE(dut.holds());
}

TEST(CrowdCondition, ComparesInTheUnitOfTheReport) {
  EndCondition speed = until("speed", 0);
  speed.above = 3;  // cm/s
  CrowdCondition dut(experiment(), speed);
  dut.take(crowd(0, "speed", 0.029, 0.1, "m/s"));
  EXPECT_FALSE(dut.holds());
  dut.take(crowd(1, "speed", 0.031, 0.1, "m/s"));
  EXPECT_TRUE(dut.holds());
}

TEST(CrowdCondition, OfAProgramIgnoresTheOthers) {
  EndCondition order = until("polar_order", 0);
  order.above = 0.5;
  order.program = "abp";
  CrowdCondition dut(experiment(), order);
  EXPECT_FALSE(dut.take(crowd(0, "polar_order", 0.9)));
  collective_t message = crowd(1, "polar_order", 0.9);
  message.program.hash = experiment().programs.at("abp").hash;
  EXPECT_TRUE(dut.take(message));
  EXPECT_TRUE(dut.holds());
}

TEST(CrowdCondition, EndsAStepAndARun) {
  Experiment stopping = experiment();
  EndCondition clusters = until("largest_cluster", 0);
  clusters.relative_error = 0.05;
  stopping.stop_when = {{clusters, 0}};
  StopRules rules(stopping);
  rules.begin(kBegin);
  EndCondition step_until = until("largest_cluster", 0);
  step_until.above = 4;
  StepCondition step(stopping, step_until, {}, kBegin);

  rules.take(crowd(5, "largest_cluster", 10, 1));
  step.take(crowd(-1, "largest_cluster", 10));
  EXPECT_FALSE(rules.met());
  EXPECT_EQ(rules.progress(), "largest_cluster is known to 5 %: relative error 0.1, wanted 0.05");
  EXPECT_FALSE(step.met()) << "before the step";
  rules.take(crowd(6, "largest_cluster", 10, 0.4));
  step.take(crowd(6, "largest_cluster", 10));

  EXPECT_EQ(rules.met(),
            "stop_when: largest_cluster is known to 5 %: relative error 0.04, wanted 0.05 after "
            "6 s, sample 1006000000");
  EXPECT_EQ(step.met(), kBegin + 6 * kSecond);
}

CrowdRule holding(double target, double gain, double integral_time) {
  CrowdRule rule;
  rule.hold = "speed";
  rule.target = target;
  rule.gain = gain;
  rule.integral_time = integral_time;
  return rule;
}

TEST(PiRule, AnswersInProportionAndWithTheIntegral) {
  PiRule dut(holding(5, 0.1, 10), 0.3);
  EXPECT_DOUBLE_EQ(dut.take(4, 0), 0.3 + 0.1);
  EXPECT_DOUBLE_EQ(dut.take(4, 1), 0.3 + 0.1 * (1 + 0.1));
  EXPECT_DOUBLE_EQ(dut.take(5, 1), 0.3 + 0.1 * 0.1);
  EXPECT_DOUBLE_EQ(dut.take(units::kNan, 1), 0.3 + 0.1 * 0.1) << "holds its intensity";
}

TEST(PiRule, StaysWithinItsLimitsWithoutWindingUp) {
  CrowdRule rule = holding(5, 0.1, 10);
  rule.highest = 0.8;
  PiRule dut(rule, 0.5);
  for (int k = 0; k < 1000; ++k) EXPECT_LE(dut.take(0, 1), 0.8);
  EXPECT_EQ(dut.intensity(), 0.8);
  // At once, not after a thousand seconds.
  EXPECT_LT(dut.take(6, 1), 0.75);
}

TEST(PiRule, HoldsAFirstOrderSystemAtItsTarget) {
  // Speed follows the light with a time of 3 s: v = 10 cm/s at full light, as seen once a second.
  PiRule dut(holding(6, 0.05, 4), 0.1);
  double v = 1;
  for (int k = 0; k < 200; ++k) v += (10 * dut.take(v, 1) - v) / 3;

  EXPECT_NEAR(v, 6, 0.01);
  EXPECT_NEAR(dut.intensity(), 0.6, 0.001);
}

LayerSpec layerWith(const CrowdRule& rule, double intensity = 0.5) {
  LayerSpec layer;
  layer.intensity = intensity;
  layer.crowd = rule;
  return layer;
}

TEST(CrowdLight, ShowsAGatedLayerWhileItsNumberIsBeyondTheLimit) {
  CrowdRule gate;
  gate.gate = "polar_order";
  gate.above = 0.5;
  CrowdLight dut(experiment(), {LayerSpec{}, layerWith(gate)});
  EXPECT_TRUE(dut.given());
  EXPECT_EQ(dut.layers().size(), 1U) << "closed until there is a value";
  EXPECT_FALSE(dut.take(crowd(1, "polar_order", 0.4)));
  EXPECT_TRUE(dut.take(crowd(2, "polar_order", 0.6)));
  EXPECT_EQ(dut.layers().size(), 2U);
  EXPECT_FALSE(dut.take(crowd(3, "polar_order", 0.7)));
  EXPECT_TRUE(dut.take(crowd(4, "polar_order", units::kNan)));
  EXPECT_EQ(dut.layers().size(), 1U);
}

TEST(CrowdLight, SetsTheIntensityOfAHeldLayerAndReportsChangesOnly) {
  CrowdLight dut(experiment(), {layerWith(holding(5, 0.1, 0), 0.3)});
  EXPECT_TRUE(dut.take(crowd(1, "speed", 0.04, 0.1, "m/s")));
  EXPECT_DOUBLE_EQ(dut.layers()[0].intensity, 0.4);
  EXPECT_FALSE(dut.take(crowd(1, "speed", 0.01, 0.1, "m/s"))) << "the same message again";
  EXPECT_FALSE(dut.take(crowd(2, "speed", 0.04, 0.1, "m/s")));
}

TEST(CrowdLight, FollowsTheRobotsOfAQuorum) {
  CrowdRule quorum;
  quorum.quorum = true;
  quorum.above = 0.4;
  LayerSpec layer = layerWith(quorum);
  layer.drive.follow = light::Follow::kRobots;
  layer.drive.robots = {1, 2, 3};
  CrowdLight dut(experiment(), {layer});
  EXPECT_TRUE(dut.layers().empty());
  collective_t message = crowd(1, "polar_order", 0);
  for (const auto& [robot, density] :
       std::vector<std::pair<int, float>>{{3, 0.5F}, {1, 0.6F}, {2, 0.3F}, {9, 0.7F}}) {
    crowd_member_t member{};
    member.robot_id = robot;
    member.density = density;
    message.members.push_back(member);
  }

  EXPECT_TRUE(dut.take(message));

  ASSERT_EQ(dut.layers().size(), 1U);
  EXPECT_EQ(dut.layers()[0].drive.robots, (std::vector<std::int32_t>{1, 3}));
  EXPECT_FALSE(dut.take(message));
  for (crowd_member_t& member : message.members) member.density = 0.1F;
  EXPECT_TRUE(dut.take(message));
  EXPECT_TRUE(dut.layers().empty()) << "an empty list of robots would stand for all";
}

TEST(CrowdLight, WithoutRulesShowsItsLayers) {
  CrowdLight dut(experiment(), {LayerSpec{}, LayerSpec{}});
  EXPECT_FALSE(dut.given());
  EXPECT_EQ(dut.layers().size(), 2U);
}

}  // namespace
}  // namespace lab::runner::crowd_light_test
