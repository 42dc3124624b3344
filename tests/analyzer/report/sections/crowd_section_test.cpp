// Collective states in summary.json and report.html, from a log and from a file of poses.
#include "analyzer/report/sections/crowd_section.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "analyzer/analyze_run.hpp"
#include "analyzer/report/figures/figures.hpp"
#include "analyzer/report/html/report_page.hpp"
#include "analyzer/report/summary/summary.hpp"
#include "tests/analyzer/report/synthetic_lab.hpp"

namespace lab::report::crowd_section_test {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::ordered_json;

RunRecord recordOf(int robots) {
  const TemporaryFolder folder;
  SyntheticLab(folder.path() / "log.lcmlog",
               syntheticExperiment(robots, 60, 20, {paperAbp(), paperRtp()}, 15))
      .run();
  return readRun(logFiles(folder.path()), {analysis::Depth::kLive});
}

const RunRecord& sixRobots() {
  static const RunRecord record = recordOf(6);
  return record;
}

TEST(CrowdSection, HasAllRobotsAndThePrograms) {
  const Json all = crowdsJson(sixRobots());

  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0]["robots"], "all robots");
  EXPECT_EQ(all[1]["robots"], "abp");
  EXPECT_EQ(all[2]["robots"], "rtp");
  EXPECT_EQ(all[0]["mean_number"], 6);
  EXPECT_NEAR(all[0]["frames"].get<double>(), 300, 15);
  EXPECT_NEAR(all[1]["observed_s"].get<double>() + all[2]["observed_s"].get<double>(),
              all[0]["observed_s"].get<double>(), 1);
  const Json& numbers = all[0]["numbers"];
  EXPECT_EQ(numbers["speed"]["unit"], "cm/s");
  EXPECT_GT(numbers["speed"]["value"].get<double>(), 1);
  EXPECT_LT(numbers["speed"]["value"].get<double>(), 12);
  EXPECT_GT(numbers["polar_order"]["value"].get<double>(), 0.1);
  EXPECT_LT(numbers["polar_order"]["low95"].get<double>(),
            numbers["polar_order"]["high95"].get<double>());
  const Json& pairs = all[0]["curves"]["pair_distribution"];
  EXPECT_EQ(pairs["distance_cm"].size(), pairs["value"].size());
  EXPECT_EQ(all[0]["light_bands"].size(), 3U) << "two bands and the light outside of them";
}

TEST(CrowdSection, IsInTheSummaryOfTwoRobotsAndInTheReportOfFour) {
  const RunRecord two = recordOf(2);

  EXPECT_THAT(summaryJson(two), HasSubstr("\"collective\""));
  EXPECT_THAT(reportHtml(two, {}), Not(HasSubstr("Collective states")));
  EXPECT_THAT(reportHtml(sixRobots(), {}), HasSubstr("Collective states"));
  EXPECT_THAT(reportHtml(sixRobots(), {}), HasSubstr("polar order"));
}

TEST(CrowdSection, SaysThatItIsOfTheFirstRobotsOnly) {
  EXPECT_FALSE(crowdsJson(sixRobots())[0].contains("first_of_robots"));
  EXPECT_THAT(reportHtml(sixRobots(), {}), Not(HasSubstr("the first 1000")));
  RunRecord record = recordOf(6);
  record.crowd_most = 1234;
  record.crowd_left_out = 5;

  EXPECT_EQ(crowdsJson(record)[0]["first_of_robots"], 1234);
  const std::string page = reportHtml(record, {});
  EXPECT_THAT(page, HasSubstr("These are the numbers of the first 1000 of "));
  EXPECT_THAT(page, HasSubstr("5 poses not in the collective numbers, which are of the first "
                              "1000 of up to "));
}

TEST(CrowdSection, IsNotThereForOneRobot) {
  const RunRecord one = recordOf(1);

  EXPECT_THAT(summaryJson(one), Not(HasSubstr("\"collective\"")));
  EXPECT_THAT(reportHtml(one, {}), Not(HasSubstr("Collective states")));
}

TEST(CrowdSection, HasFiguresWithTheirData) {
  const TemporaryFolder scratch;

  const std::vector<Figure> figures = drawFigures(sixRobots(), scratch.path());

  for (const std::string& name : crowdFigureNames()) {
    const auto figure = std::find_if(figures.begin(), figures.end(),
                                     [&](const Figure& one) { return one.name == name; });
    ASSERT_NE(figure, figures.end()) << name;
    EXPECT_THAT(figure->svg, HasSubstr("<svg")) << name << ": " << figure->sentence;
    EXPECT_GT(std::count(figure->csv.begin(), figure->csv.end(), '\n'), 5) << name;
  }
  const std::string page = reportHtml(sixRobots(), figures);
  // Each picture once, in its own section.
  for (const std::string& name : crowdFigureNames()) {
    const std::size_t first = page.find("id=\"" + name + "_");
    ASSERT_NE(first, std::string::npos) << name;
  }
}

TEST(CrowdSection, IsMadeOfAFileOfPosesToo) {
  const TemporaryFolder folder;
  std::ofstream file(folder.path() / "poses.csv");
  file << "frame,particle,x_cm,y_cm,t,theta\n";
  for (int k = 0; k < 400; ++k) {
    for (int i = 0; i < 5; ++i) {
      file << k << ',' << i + 1 << ',' << 20 + 15 * i + 2 * std::sin(0.05 * k + i) << ','
           << 40 + 2 * std::cos(0.05 * k + i) << ',' << 0.1 * k << ',' << 0.1 << '\n';
    }
  }
  file.close();
  AnalyzeOptions options;
  options.figures = false;
  options.depth = analysis::Depth::kLive;

  const AnalyzedRun run =
      analyzePoses(folder.path() / "poses.csv", folder.path() / "out", {}, {}, options);

  const Json summary = Json::parse(readFile(folder.path() / "out" / "summary.json"));
  ASSERT_EQ(summary["collective"].size(), 1U);
  EXPECT_EQ(summary["collective"][0]["mean_number"], 5);
  EXPECT_NEAR(summary["collective"][0]["numbers"]["polar_order"]["value"].get<double>(), 1, 1e-6);
}

}  // namespace
}  // namespace lab::report::crowd_section_test
