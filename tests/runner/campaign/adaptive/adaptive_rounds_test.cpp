#include "runner/campaign/adaptive/adaptive_rounds.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "runner/campaign/adaptive/adaptive_goal.hpp"
#include "runner/campaign/adaptive/adaptive_page.hpp"
#include "runner/command_line/exit_code.hpp"
#include "tests/runner/campaign/adaptive/adaptive_samples.hpp"

namespace lab::runner::campaign::adaptive_rounds_test {
namespace {

using adaptive_samples::kRunTime;
using adaptive_samples::run;
using adaptive_samples::scan;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::uint64_t kSeed = 7;

AdaptivePlan lawPlan() {
  return {.goal = AdaptiveGoal::kLaw, .quantity = "D_r_rad2_s", .robot_time_s = 30 * kRunTime};
}

void runAll(CampaignData& data, const AdaptiveRound& round) {
  for (const PlannedRun& planned : round.runs) run(data, planned.row, kSeed);
}

std::vector<std::size_t> rowsIn(const AdaptiveRound& round) {
  std::vector<std::size_t> rows;
  for (const PlannedRun& planned : round.runs) rows.push_back(planned.row);
  return rows;
}

/// All rounds of a campaign, as lines.
std::string play(CampaignData& data) {
  std::string lines;
  for (std::int64_t number = 1;; ++number) {
    const AdaptiveRound round = nextRound(data, number);
    if (round.runs.empty()) return lines;
    lines += roundLine(round);
    runAll(data, round);
  }
}

TEST(AdaptiveRounds, BeginSpreadOverTheKeys) {
  CampaignData data = scan(lawPlan(), 5);
  std::set<std::string> etas;
  std::set<std::vector<std::string>> places;
  for (std::int64_t number = 1; number <= 2; ++number) {
    const AdaptiveRound round = nextRound(data, number);
    for (const PlannedRun& planned : round.runs) {
      places.insert(planned.values);
      etas.insert(planned.values.front());
    }
    runAll(data, round);
  }

  // A law alone would ask for two values of each key.
  EXPECT_GE(places.size(), 5U);
  EXPECT_GE(etas.size(), 3U);
}

TEST(AdaptiveRounds, TakeTheRunThatReducesTheVarianceMostOfAll) {
  AdaptivePlan plan = lawPlan();
  plan.runs_per_round = 1;
  CampaignData data = scan(plan, 9);
  for (std::size_t row = 0; row < 40; row += 3) run(data, row, kSeed);
  const Eigen::VectorXd noise = goalState(data).design.noise;

  const AdaptiveRound round = nextRound(data, 1);

  // The mean variance of both exponents after a run at each point, by the normal equations.
  const auto row_of = [&](std::size_t point) {
    const std::vector<double> keys = adaptive_samples::keysOf(data, point);
    return Eigen::Vector3d(1, std::log(keys[0]), std::log(keys[1]));
  };
  Eigen::Matrix3d information = 1e-3 * Eigen::Matrix3d::Identity();  // about the weak prior
  for (std::size_t row = 0; row < 40; row += 3) {
    const std::size_t point = data.rows[row].point;
    information += row_of(point) * row_of(point).transpose() / noise(static_cast<int>(point));
  }
  std::size_t best = 0;
  double smallest = 1e9;
  for (std::size_t point = 0; point < data.points.size(); ++point) {
    const Eigen::Matrix3d after =
        information + row_of(point) * row_of(point).transpose() / noise(static_cast<int>(point));
    const double variance = after.inverse().diagonal().tail(2).mean();
    if (variance >= smallest) continue;
    smallest = variance;
    best = point;
  }
  ASSERT_EQ(round.runs.size(), 1U);
  EXPECT_EQ(data.rows[round.runs.front().row].point, best);
  EXPECT_NEAR(round.expected_error, std::sqrt(smallest), 0.001 * round.expected_error);
  const double before = information.inverse().diagonal().tail(2).mean();
  EXPECT_NEAR(round.error, std::sqrt(before), 0.001 * round.error);
  EXPECT_NEAR(round.runs.front().reduction, before - smallest, 0.01 * (before - smallest));
}

TEST(AdaptiveRounds, KnowAboutAsMuchAsWasExpected) {
  CampaignData data = scan(lawPlan(), 9);
  double expected = 0;
  for (std::int64_t number = 1; number <= 6; ++number) {
    const AdaptiveRound round = nextRound(data, number);
    expected = round.expected_error;
    runAll(data, round);
  }

  EXPECT_NEAR(goalState(data).error, expected, 0.2 * expected);
}

TEST(AdaptiveRounds, AreTheSameForTheSameResults) {
  CampaignData one = scan(lawPlan(), 5);
  CampaignData other = scan(lawPlan(), 5);

  EXPECT_EQ(play(one), play(other));
}

TEST(AdaptiveRounds, GoOnAfterAnInterruptionAsWithoutOne) {
  CampaignData whole = scan(lawPlan(), 5);
  const std::string expected = play(whole);
  ASSERT_GT(readRounds(expected, whole.axes.size()).size(), 6U);

  // Interrupted in every round, after its first run: the rest of it comes first.
  CampaignData data = scan(lawPlan(), 5);
  std::string lines;
  while (true) {
    const std::vector<AdaptiveRound> rounds = readRounds(lines, data.axes.size());
    for (const std::size_t row : openRows(data, rounds)) run(data, row, kSeed);
    const AdaptiveRound round = nextRound(data, static_cast<std::int64_t>(rounds.size()) + 1);
    if (round.runs.empty()) break;
    lines += roundLine(round);
    run(data, round.runs.front().row, kSeed);
    EXPECT_EQ(openRows(data, readRounds(lines, data.axes.size())).size(), round.runs.size() - 1);
  }

  EXPECT_EQ(lines, expected);
}

TEST(AdaptiveRounds, EndWithTheRobotTime) {
  AdaptivePlan plan = lawPlan();
  plan.robot_time_s = 10.5 * (kRunTime + 60);
  plan.between_runs_s = 60;
  CampaignData data = scan(plan, 5);

  const auto rounds = readRounds(play(data), data.axes.size());

  std::size_t runs = 0;
  for (const AdaptiveRound& round : rounds) runs += round.runs.size();
  EXPECT_EQ(runs, 10U);
  EXPECT_EQ(nextRound(data, 9).end, "the robot time of 1 h 55 min is spent");
}

TEST(AdaptiveRounds, EndWithTheError) {
  AdaptivePlan plan = lawPlan();
  plan.error = 0.008;
  plan.robot_time_s = 0;
  CampaignData data = scan(plan, 50);

  const auto rounds = readRounds(play(data), data.axes.size());

  EXPECT_GT(rounds.back().error, 0.008);
  const AdaptiveRound last = nextRound(data, 99);
  EXPECT_LE(last.error, 0.008);
  EXPECT_EQ(last.end, "the error is at most 0.008");
}

TEST(AdaptiveRounds, EndWithTheGrid) {
  CampaignData data = scan(lawPlan(), 1);
  for (std::size_t row = 0; row < data.rows.size(); ++row) run(data, row, kSeed);

  EXPECT_EQ(nextRound(data, 1).end, "all runs of the grid are made");
}

TEST(AdaptiveRounds, DoNotRepeatARunThatFailed) {
  CampaignData data = scan(lawPlan(), 1);
  const std::vector<std::size_t> first = rowsIn(nextRound(data, 1));
  for (const std::size_t row : first) data.survey.rows[row].kind = RowState::Kind::kFailed;

  const AdaptiveRound next = nextRound(data, 2);

  for (const std::size_t row : rowsIn(next)) EXPECT_THAT(first, Not(testing::Contains(row)));
  EXPECT_DOUBLE_EQ(next.robot_time_s, 4 * kRunTime);
}

TEST(AdaptiveRounds, TakeLongRunsIfThereIsTimeBetweenRuns) {
  AdaptivePlan plan = lawPlan();
  plan.between_runs_s = 300;
  CampaignData data = scan(plan, 5);
  data.request.over = {"eta_rad_s=1,2,4,6", "epsilon_s=0.2,0.5", "duration_s=60,600"};
  data.axes = data.request.design().axes;
  data.points.clear();
  for (const PointValues& values : pointsOf(data.request.design())) {
    data.points.push_back(
        makePoint(values, values[0] + " " + values[1] + " " + values[2], std::stod(values[2])));
  }
  data.rows = rowsOf(data.request, data.points, {"1", 5});
  data.survey.rows.assign(data.rows.size(), {});
  for (std::size_t row = 0; row < data.points.size(); ++row) run(data, row, kSeed);

  for (const PlannedRun& planned : nextRound(data, 1).runs) EXPECT_EQ(planned.values[2], "600");
}

TEST(AdaptiveRounds, AreReadAroundDamagedLines) {
  CampaignData data = scan(lawPlan(), 5);
  const AdaptiveRound round = nextRound(data, 1);
  const std::string line = roundLine(round);

  // The values are shown beside the names of the swept keys.
  AdaptiveRound more = round;
  more.runs.front().values.emplace_back("3");
  AdaptiveRound fewer = round;
  fewer.runs.back().values.pop_back();

  const auto rounds = readRounds(
      line.substr(0, 40) + "\n{}\n" + roundLine(more) + roundLine(fewer) + line, data.axes.size());

  ASSERT_EQ(rounds.size(), 1U);
  EXPECT_EQ(rounds.front().runs, round.runs);
  EXPECT_TRUE(std::isinf(rounds.front().error));
}

TEST(AdaptiveRounds, AreToldInOneLine) {
  CampaignData data = scan(lawPlan(), 5);

  const std::string text = roundText(data, nextRound(data, 1));

  EXPECT_THAT(text, AllOf(HasSubstr("round 1"), HasSubstr("eta_rad_s="), HasSubstr("epsilon_s="),
                          HasSubstr("expected after 40 min 0 s"), Not(HasSubstr("\n"))));
}

TEST(AdaptiveRounds, AreOnThePage) {
  CampaignData data = scan(lawPlan(), 5);
  const AdaptiveRound round = nextRound(data, 1);
  runAll(data, round);

  EXPECT_EQ(chosenText(data),
            "4 of at most 150 runs, chosen for the exponents of the power law of D_r_rad2_s");
  EXPECT_THAT(roundsSection(data, {round}),
              AllOf(HasSubstr("<td>1</td><td>0 s</td><td>unknown</td>"), HasSubstr("eta_rad_s=")));
  EXPECT_EQ(roundsSection(data, {}), "");
}

TEST(AdaptiveSurface, HoldsTheTruthWithinItsErrors) {
  AdaptivePlan plan{.quantity = "abp.D_r_rad2_s", .relative = true, .robot_time_s = 60 * kRunTime};
  CampaignData data = scan(plan, 20);
  static_cast<void>(play(data));

  const GoalState state = goalState(data);

  ASSERT_EQ(state.surface.size(), 30U);
  int held = 0;
  for (const SurfacePoint& point : state.surface) {
    const double truth = adaptive_samples::truth(data, point.candidate);
    if (std::abs(point.value - truth) < 2.5 * point.sigma) ++held;
    EXPECT_NEAR(point.value, truth, 0.2 * truth);
  }
  EXPECT_GE(held, 28);
  EXPECT_LT(state.error, 0.05);
  EXPECT_THAT(
      surfaceCsv(data, state),
      HasSubstr("eta_rad_s,epsilon_s,abp.D_r_rad2_s,abp.D_r_rad2_s.standard_error\n0.5,0.1,"));
}

TEST(AdaptiveBoundary, IsMeasuredWhereTheLevelIsCrossed) {
  using adaptive_samples::transitionAt;
  AdaptivePlan plan{.goal = AdaptiveGoal::kBoundary,
                    .quantity = "order",
                    .level = 0.5,
                    .robot_time_s = 60 * kRunTime};
  CampaignData data = scan(plan, 20, adaptive_samples::kTransition);
  std::size_t near = 0;
  std::size_t all = 0;
  for (std::int64_t number = 1;; ++number) {
    const AdaptiveRound round = nextRound(data, number);
    if (round.runs.empty()) break;
    for (const PlannedRun& planned : round.runs) {
      adaptive_samples::runTransition(data, planned.row, kSeed);
      if (number <= 5) continue;
      const std::vector<double> keys = adaptive_samples::keysOf(data, data.rows[planned.row].point);
      ++all;
      // Three widths of the transition.
      if (std::abs(keys[0] - transitionAt(keys[1])) < 0.21) ++near;
    }
  }

  // Of the grid, a third of the points is that near.
  EXPECT_GT(static_cast<double>(near), 0.8 * static_cast<double>(all));
  const GoalState state = goalState(data);
  ASSERT_EQ(state.crossings.size(), 5U);
  for (const Crossing& crossing : state.crossings) {
    const double density = adaptive_samples::keysOf(data, crossing.candidate)[1];
    EXPECT_NEAR(crossing.position, transitionAt(density), std::max(0.02, 3 * crossing.sigma));
    EXPECT_LT(crossing.sigma, 0.03);
  }
  EXPECT_LT(state.error, 0.03);
  EXPECT_THAT(boundaryCsv(data, state), HasSubstr("density,noise,noise.standard_error\n0.2,0.3"));
  EXPECT_THAT(roundText(data, nextRound(scan(plan, 1, adaptive_samples::kTransition), 1)),
              HasSubstr("% expected after"));
}

/// The line with which a plan is refused.
std::string refusal(CampaignData data) {
  try {
    static_cast<void>(goalOf(data.request, data.points));
    static_cast<void>(valuesOf(data));
  } catch (const UserError& error) {
    return error.what();
  }
  return {};
}

TEST(AdaptivePlan, IsRefusedInOneLine) {
  const auto with = [](auto change) {
    CampaignData data = scan(lawPlan(), 5);
    change(data);
    return refusal(std::move(data));
  };
  EXPECT_EQ(with([](CampaignData&) {}), "");
  EXPECT_THAT(with([](CampaignData& d) { d.request.adaptive->robot_time_s = 0; }),
              HasSubstr("found neither robot_time_s nor error"));
  EXPECT_THAT(with([](CampaignData& d) { d.request.adaptive->robot_time_s = 599; }),
              HasSubstr("found 599, expected at least 600"));
  EXPECT_THAT(with([](CampaignData& d) { d.request.adaptive->parameter = "etta"; }),
              HasSubstr("expected one of exponents, prefactor, curve, eta, epsilon"));
  EXPECT_THAT(with([](CampaignData& d) {
                d.request.adaptive->goal = AdaptiveGoal::kMean;
                d.request.adaptive->parameter = "curve";
              }),
              HasSubstr("those of goal = \"law\""));
  EXPECT_THAT(with([](CampaignData& d) { d.request.adaptive->relative = true; }),
              HasSubstr("sweep.adaptive.relative"));
  EXPECT_THAT(with([](CampaignData& d) { d.request.common_seeds = true; }),
              HasSubstr("found --common-seeds"));
  EXPECT_THAT(with([](CampaignData& d) { d.points.front().values[0] = "0"; }),
              HasSubstr("found eta_rad_s=0, expected positive numbers"));
  EXPECT_THAT(with([](CampaignData& d) { d.points.resize(1); }),
              HasSubstr("found no swept key with two values"));
  EXPECT_THAT(with([](CampaignData& d) {
                while (d.points.size() <= 1000) d.points.push_back(d.points.front());
              }),
              HasSubstr("found 1001 points, expected at most 1000"));
  EXPECT_THAT(
      with([](CampaignData& d) {
        run(d, 0, kSeed);
        d.request.adaptive->quantity = "D_r";
      }),
      HasSubstr("found \"D_r\", which no estimate of the runs has as its name; expected one "
                "of abp.D_r_rad2_s"));
}

TEST(AdaptivePlan, NamesOneExponentByItsKey) {
  AdaptivePlan plan = lawPlan();
  for (const char* name : {"epsilon", "epsilon_s"}) {
    plan.parameter = name;
    const CampaignData data = scan(plan, 5);
    const CampaignGoal goal = goalOf(data.request, data.points);
    EXPECT_EQ(goal.parameter, LawParameter::kOneExponent);
    EXPECT_EQ(goal.key, 1U);
  }
}

}  // namespace
}  // namespace lab::runner::campaign::adaptive_rounds_test
