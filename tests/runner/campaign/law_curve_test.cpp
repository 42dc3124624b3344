#include "runner/campaign/law_curve.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "runner/campaign/campaign_figures.hpp"
#include "runner/campaign/campaign_laws.hpp"

namespace lab::runner::campaign::law_curve_test {
namespace {

using testing::HasSubstr;
using testing::Not;

using Law = std::function<double(double eta, double epsilon)>;

/// One run at each of 3 x 3 points, with errors of 1 %.
/// @param exact none: the quantity has no exact law
CampaignData dataOf(const Law& measured, const Law& exact, bool zip = false) {
  CampaignData data;
  data.request.name = "sample";
  data.request.over = {"programs.abp.eta_rad_s=1,2,3", "programs.abp.epsilon_s=0.1,0.2,0.4"};
  data.request.zip = zip;
  data.code = {"0.1.0", 5};
  data.axes = data.request.design().axes;
  for (PointValues& values : pointsOf(data.request.design())) {
    const std::string text = values[0] + " " + values[1];
    data.points.push_back(makePoint(std::move(values), text, 60));
  }
  data.rows = rowsOf(data.request, data.points, data.code);
  for (const Row& row : data.rows) {
    const PointValues& values = data.points[row.point].values;
    const double eta = numberIn(values[0]).value();
    const double epsilon = numberIn(values[1]).value();
    const double value = measured(eta, epsilon);
    RunResult result;
    result.identity = row.identity;
    result.code = "0.1.0";
    result.columns = {{"abp.D_r_rad2_s", value},
                      {"abp.D_r_rad2_s.standard_error", 0.01 * value},
                      {"abp.D_r_rad2_s.low95", 0.98 * value},
                      {"abp.D_r_rad2_s.high95", 1.02 * value}};
    if (exact) result.columns.emplace_back("abp.D_r_rad2_s.theory", exact(eta, epsilon));
    data.survey.rows.push_back({RowState::Kind::kDone, std::move(result), {}});
  }
  return data;
}

report::ScriptedFigure figureOf(const CampaignData& data) {
  const PooledTable pooled = poolCampaign(data);
  return curveFigure(data, pooled, leadingQuantities(pooled, {}, 1).at(0));
}

double powerLaw(double eta, double epsilon) { return epsilon * eta * eta / 6; }
double noPowerLaw(double eta, double epsilon) { return 1 / (1 + 5 * eta * epsilon); }

TEST(LawCurve, HasTheLawBetweenThePoints) {
  const CampaignData data = dataOf(powerLaw, powerLaw);
  const auto law = drawnLaw(data, poolCampaign(data), 0);
  ASSERT_TRUE(law.has_value());
  EXPECT_TRUE(law->is_exact);
  const auto curve = lawCurve(*law, 0, {"", "0.4"}, 1, 3, false);

  ASSERT_EQ(curve.size(), 101U);
  EXPECT_DOUBLE_EQ(curve[25].first, 1.5);
  EXPECT_NEAR(curve[25].second, 0.15, 1e-6);  // straight lines would have 0.1667
  EXPECT_NEAR(curve[100].second, 0.6, 1e-6);
}

TEST(LawCurve, IsEquallySpacedOnALogarithmicAxis) {
  const CampaignData data = dataOf(powerLaw, powerLaw);
  const auto law = drawnLaw(data, poolCampaign(data), 0);
  ASSERT_TRUE(law.has_value());
  const auto curve = lawCurve(*law, 0, {"", "0.6"}, 1, 100, true);

  ASSERT_EQ(curve.size(), 101U);
  EXPECT_NEAR(curve[50].first, 10, 1e-9);
  EXPECT_NEAR(curve[50].second, 10, 1e-4);
  EXPECT_TRUE(lawCurve(*law, 0, {"", "0.6"}, 2, 2, false).empty());
}

TEST(LawCurve, IsInTheFigureForEachSeries) {
  const report::ScriptedFigure figure = figureOf(dataOf(powerLaw, powerLaw));

  for (const char* block : {"$p0s0law using 1:2", "$p0s1law using 1:2", "$p0s2law using 1:2"}) {
    EXPECT_THAT(figure.script, HasSubstr(block));
  }
  EXPECT_THAT(figure.script, HasSubstr("title 'exact law'"));
  EXPECT_THAT(figure.script, Not(HasSubstr("using 1:5")));
  EXPECT_THAT(figure.caption, HasSubstr("Lines: the exact law"));
}

TEST(LawCurve, IsNotDrawnForAnExactLawThatIsNoPowerLaw) {
  const report::ScriptedFigure figure = figureOf(dataOf(noPowerLaw, noPowerLaw));

  EXPECT_THAT(figure.script, HasSubstr("using 1:5 with lines"));
  EXPECT_THAT(figure.script, Not(HasSubstr("law using")));
  EXPECT_THAT(figure.caption, HasSubstr("joined by straight lines"));
}

TEST(LawCurve, IsNotDrawnWhereKeysVaryTogether) {
  const report::ScriptedFigure figure = figureOf(dataOf(powerLaw, powerLaw, true));

  EXPECT_THAT(figure.script, Not(HasSubstr("law using")));
}

TEST(LawCurve, IsTheFittedLawWhereNoExactOneIsKnown) {
  const report::ScriptedFigure figure = figureOf(dataOf(powerLaw, {}));

  EXPECT_THAT(figure.script, HasSubstr("$p0s0law using 1:2 with lines lw 1.2 dt 2"));
  EXPECT_THAT(figure.script, HasSubstr("title 'power law'"));
  EXPECT_THAT(figure.caption, HasSubstr("Dashed: the power law"));
}

TEST(LawCurve, IsNotTheFittedLawIfThePointsDisagreeWithIt) {
  const report::ScriptedFigure figure = figureOf(dataOf(noPowerLaw, {}));

  EXPECT_THAT(figure.script, Not(HasSubstr("law using")));
  EXPECT_THAT(figure.caption, Not(HasSubstr("Dashed")));
}

}  // namespace
}  // namespace lab::runner::campaign::law_curve_test
