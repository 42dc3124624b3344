#include "runner/script/stop_rules.hpp"

#include <gmock/gmock.h>

#include "common/experiment/program_messages.hpp"
#include "tests/support/programs.hpp"

namespace lab::runner::stop_rules_test {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kBegin = 1'000'000;
constexpr std::int64_t kSecond = 1'000'000;

StopRule rule(const char* estimate, double error, std::int32_t robot = 0, double at_least = 0) {
  StopRule rule;
  rule.until.estimate = estimate;
  rule.until.program = "abp";
  rule.until.relative_error = error;
  rule.until.robot = robot;
  rule.at_least = at_least;
  return rule;
}

Experiment experimentWith(const std::vector<StopRule>& rules, StopOn on = StopOn::kAll) {
  Experiment experiment;
  experiment.programs["abp"] = test::abp(0.03, 0.5, 3);
  experiment.stop_when = rules;
  experiment.stop_on = on;
  return experiment;
}

analysis_t analysis(const Experiment& experiment, double seconds, double d_r_error, double v_error,
                    std::int32_t robot = analysis_t::POOL) {
  analysis_t message{};
  message.utime = kBegin + static_cast<std::int64_t>(seconds * kSecond);
  message.robot_id = robot;
  message.program = toId(experiment.programs.at("abp"));
  message.estimates.resize(2);
  message.num_estimates = 2;
  message.estimates[0].name = "v";
  message.estimates[0].value = 0.03;
  message.estimates[0].sigma = 0.03 * v_error;
  message.estimates[1].name = "D_r";
  message.estimates[1].value = 0.75;
  message.estimates[1].sigma = 0.75 * d_r_error;
  return message;
}

TEST(StopRules, EndTheRunWhenTheEstimateIsKnown) {
  const Experiment experiment = experimentWith({rule("D_r", 0.05)});
  StopRules dut(experiment);
  EXPECT_TRUE(dut.given());
  dut.take(analysis(experiment, 50, 0.01, 1));  // before the script
  dut.begin(kBegin);
  EXPECT_FALSE(dut.met());
  EXPECT_EQ(dut.progress(), "D_r of abp not known yet, wanted to 5 %");
  dut.take(analysis(experiment, 100, 0.0999, 1));
  EXPECT_FALSE(dut.met());
  // Half the error needs four times the data: three times as long again.
  EXPECT_EQ(dut.progress(), "D_r of abp 9.99 %, wanted 5 %: about 5 min 00 s");
  EXPECT_EQ(dut.unmet(),
            "stop_when was not reached; D_r of abp is known to 5 %: relative error 0.0999, "
            "wanted 0.05");
  dut.take(analysis(experiment, 401, 0.0499, 1));
  EXPECT_EQ(dut.met(),
            "stop_when: D_r of abp is known to 5 %: relative error 0.0499 after 401 s, "
            "sample 402000000");
}

TEST(StopRules, AllMustHoldAtTheSameTime) {
  const Experiment experiment = experimentWith({rule("D_r", 0.05), rule("v", 0.01)});
  StopRules dut(experiment);
  dut.begin(kBegin);
  dut.take(analysis(experiment, 10, 0.04, 0.02));
  EXPECT_FALSE(dut.met());
  dut.take(analysis(experiment, 11, 0.06, 0.009));  // the first rule no longer holds
  EXPECT_FALSE(dut.met());
  EXPECT_THAT(dut.unmet(), HasSubstr("D_r of abp"));
  EXPECT_THAT(dut.unmet(), testing::Not(HasSubstr("v of abp")));
  dut.take(analysis(experiment, 12, 0.0499, 0.009));
  EXPECT_TRUE(dut.met());
}

TEST(StopRules, OneIsEnoughWithStopOnAny) {
  const Experiment experiment = experimentWith({rule("D_r", 0.05), rule("v", 0.01)}, StopOn::kAny);
  StopRules dut(experiment);
  dut.begin(kBegin);
  dut.take(analysis(experiment, 10, 0.4, 0.02));
  EXPECT_FALSE(dut.met());
  EXPECT_THAT(dut.progress(), HasSubstr(" or v of abp 2 %, wanted 1 %: about 30 s"));
  dut.take(analysis(experiment, 12, 0.4, 0.009));
  ASSERT_TRUE(dut.met());
  EXPECT_THAT(*dut.met(), HasSubstr("v of abp is known to 1 %"));
  EXPECT_THAT(*dut.met(), testing::Not(HasSubstr("D_r")));
}

TEST(StopRules, HoldOnlyAfterTheirMinimumTime) {
  const Experiment experiment = experimentWith({rule("D_r", 0.05, 0, 60)});
  StopRules dut(experiment);
  dut.begin(kBegin);
  dut.take(analysis(experiment, 20, 0.01, 1));
  EXPECT_FALSE(dut.met());
  EXPECT_THAT(dut.progress(), HasSubstr("about 40 s"));
  EXPECT_THAT(dut.unmet(), HasSubstr("relative error 0.01, wanted 0.05, but before 60 s"));
  dut.take(analysis(experiment, 60, 0.01, 1));
  EXPECT_TRUE(dut.met());
}

TEST(StopRules, CanConcernOneRobotAndNoRulesEndNoRun) {
  const Experiment experiment = experimentWith({rule("D_r", 0.05, 3)});
  StopRules dut(experiment);
  dut.begin(kBegin);
  dut.take(analysis(experiment, 20, 0.01, 1));
  dut.take(analysis(experiment, 20, 0.01, 1, 2));
  EXPECT_FALSE(dut.met());
  dut.take(analysis(experiment, 20, 0.01, 1, 3));
  EXPECT_TRUE(dut.met());

  const Experiment plain = experimentWith({});
  StopRules none(plain);
  none.begin(kBegin);
  none.take(analysis(plain, 20, 0.01, 1));
  EXPECT_FALSE(none.given());
  EXPECT_FALSE(none.met());
  EXPECT_EQ(none.progress(), "");
}

}  // namespace
}  // namespace lab::runner::stop_rules_test
