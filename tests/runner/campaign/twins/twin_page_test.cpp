#include "runner/campaign/twins/twin_page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace lab::runner::campaign::twin_page_test {
namespace {

using testing::HasSubstr;
using testing::Not;

TwinReport reportWith(double run) {
  std::vector<double> twins;
  for (int i = 0; i < 20; ++i) twins.push_back(10 + 0.1 * std::sin(i));
  return {
      "run<1>", "0.1.0", compareWithTwins({{"abp.D_r_rad2_s", run, twins}}), {"a remark & more"}};
}

TEST(TwinPage, SaysWhetherTheRunDeviates) {
  EXPECT_THAT(verdictOf(reportWith(10)), HasSubstr("agrees with its 20 twins"));
  EXPECT_THAT(verdictOf(reportWith(12)), HasSubstr("deviates from its 20 twins"));
  EXPECT_THAT(verdictOf(reportWith(12)), HasSubstr("D_r of abp (rad²/s): 12"));
  EXPECT_THAT(verdictOf(TwinReport{}), HasSubstr("nothing was measured"));
}

TEST(TwinPage, WritesTheSameIntoJsonAndCsv) {
  const TwinReport report = reportWith(12);
  const auto json = nlohmann::json::parse(twinJson(report));
  const std::string csv = twinCsv(report);

  EXPECT_EQ(json["agrees"], false);
  EXPECT_EQ(json["looks"][0]["look"], "abp.D_r_rad2_s");
  EXPECT_EQ(json["looks"][0]["twins_below"], 20);
  EXPECT_THAT(csv, HasSubstr("\n\"abp.D_r_rad2_s\",12,"));
}

TEST(TwinPage, EscapesNamesAndRemarks) {
  const std::string page = twinHtml(reportWith(10), {});

  EXPECT_THAT(page, HasSubstr("run&lt;1&gt;"));
  EXPECT_THAT(page, HasSubstr("a remark &amp; more"));
  EXPECT_THAT(page, Not(HasSubstr("run<1>")));
}

TEST(TwinPage, HasOneSectionInTheReportHoweverOftenItIsMade) {
  const std::string page = "<html><body><h1>Report</h1>\n</body>\n</html>\n";
  const std::string once = withTwinSection(page, reportWith(10));
  const std::string again = withTwinSection(once, reportWith(12));

  EXPECT_THAT(once, HasSubstr("agrees with its 20 twins"));
  EXPECT_THAT(again, HasSubstr("deviates from its 20 twins"));
  EXPECT_THAT(again, Not(HasSubstr("agrees with")));
  EXPECT_EQ(withTwinSection(again, reportWith(10)), once);
  EXPECT_LT(again.find("Simulated twins"), again.find("</body>"));
}

}  // namespace
}  // namespace lab::runner::campaign::twin_page_test
