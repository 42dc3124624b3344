/// summary.json, trajectories.csv and report.html of the same record.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "analyzer/laws/law_of.hpp"
#include "analyzer/report/html/html_verdicts.hpp"
#include "analyzer/report/html/report_page.hpp"
#include "analyzer/report/summary/findings.hpp"
#include "analyzer/report/summary/summary.hpp"
#include "analyzer/report/summary/trajectories.hpp"
#include "common/programs/shipped_programs.hpp"
#include "tests/analyzer/report/synthetic_lab.hpp"

namespace lab::report {
namespace {

using testing::HasSubstr;
using testing::Not;

RunRecord recordOf(const Experiment& experiment) {
  const TemporaryFolder folder;
  SyntheticLab(folder.path() / "log.lcmlog", experiment).run();
  return readRun(logFiles(folder.path()));
}

const RunRecord& smallRun() {
  static const RunRecord record =
      recordOf(syntheticExperiment(2, 60, 20, {paperAbp(), paperRtp()}, 15));
  return record;
}

analysis::ProgramResult resultOf(const Program& program, analysis::VerdictKind verdict) {
  analysis::ProgramResult result;
  result.law = analysis::lawOf(program, analysis::kPaperWheelBase);
  result.no_verdict = result.law->whyNoVerdict();
  result.verdict = {verdict, 2.5, 0.5, false, false, false, false, 40};
  return result;
}

TEST(Verdict, NamesItsReference) {
  using analysis::VerdictKind;
  const auto exact = resultOf(shippedProgram("abp"), VerdictKind::kAgrees);
  EXPECT_EQ(verdictText(exact), "agrees with the exact law");
  const auto simulated = resultOf(shippedProgram("levy"), VerdictKind::kDisagrees);
  EXPECT_EQ(verdictText(simulated), "deviates from the simulated reference");
  EXPECT_THAT(verdictReason(simulated),
              testing::StartsWith("The largest deviation from the simulated reference at 40 judged "
                                  "lags is 2.5 standard errors"));
}

TEST(Verdict, SaysWhyThereIsNone) {
  const auto dut = resultOf(shippedProgram("phototaxis"), analysis::VerdictKind::kUndecided);
  EXPECT_EQ(verdictText(dut), "no law to compare with");
  EXPECT_THAT(verdictReason(dut), testing::StartsWith("The program reads light"));
}

analysis::ProgramResult jam(double contact) {
  using analysis::VerdictKind;
  analysis::ProgramResult result = resultOf(shippedProgram("abp"), VerdictKind::kAgrees);
  result.shares = {.free = 1 - contact, .contact = contact};
  result.whole.emplace();
  result.whole->speed = 0.0034;
  result.whole->lags.push_back({10, 2.1e-4, 0.1, 100});
  return result;
}

TEST(Verdict, NamesFramesThatKeepStepWithTheHolds) {
  auto result = resultOf(shippedProgram("abp"), analysis::VerdictKind::kAgrees);
  const auto named = testing::Contains(testing::HasSubstr("The frames keep step with the holds"));
  EXPECT_THAT(caveats(result), testing::Not(named));
  result.curves.frames_in_step = 12;  // their phases are many
  EXPECT_THAT(caveats(result), testing::Not(named));
  result.curves.frames_in_step = 2;
  EXPECT_THAT(caveats(result), named);
  EXPECT_THAT(caveats(result), testing::Contains(testing::HasSubstr("after 2 frames")));
}

TEST(Verdict, IsNotGreenAmongContacts) {
  EXPECT_STREQ(html::verdictClass(jam(0.05)), "agrees");
  EXPECT_STREQ(html::verdictClass(jam(0.3)), "partly");
  EXPECT_THAT(verdictReason(jam(0.95)), HasSubstr("in contact most of the time"));
}

TEST(Headline, SaysFirstWhatIsNotFreeMotion) {
  RunRecord record;
  record.results.emplace_back().result = jam(0.3);
  record.results.back().program.name = "abp";

  EXPECT_THAT(headlines(record).front(),
              testing::StartsWith("abp: 30.0 % of the time is not free motion (contact 30.0 %); "
                                  "whole motion: speed 0.34 cm/s, MSD 2.1 cm² in 10 s; free "
                                  "motion: agrees with the exact law"));
  record.results.back().result = jam(0.05);
  EXPECT_THAT(headlines(record).front(), testing::StartsWith("abp: agrees with the exact law"));
}

TEST(Headline, IsInTheSummaryBeforeTheVerdict) {
  RunRecord record;
  record.results.emplace_back().result = jam(0.3);
  const std::string dut = summaryJson(record);

  EXPECT_LT(dut.find("30.0 % of the time is not free motion"), dut.find("\"verdict\""));
  const auto pool = nlohmann::json::parse(dut)["programs"][0]["pool"];
  EXPECT_DOUBLE_EQ(pool["time_shares"]["contact"], 0.3);
  EXPECT_DOUBLE_EQ(pool["whole_motion"]["speed_cm_s"], 0.34);
  EXPECT_DOUBLE_EQ(pool["whole_motion"]["msd_cm2"][0], 2.1);
}

TrackRow rowOf(std::int32_t robot, float x, float y, float theta) {
  TrackRow row;
  row.robot = robot;
  row.x = x;
  row.y = y;
  row.theta = theta;
  return row;
}

std::string trajectoriesOf(const RunRecord& record) {
  std::ostringstream text;
  writeTrajectories(record, text);
  return text.str();
}

TEST(Trajectories, BeginsWithTheColumnsOfTrackpy) {
  std::istringstream dut(trajectoriesOf(smallRun()));
  std::string header;
  std::string first;
  std::getline(dut, header);
  std::getline(dut, first);

  EXPECT_EQ(header,
            "frame,particle,x,y,t,theta,program,segment,state,contact,light_front,light_back,"
            "x_stitched,y_stitched");
  const std::string number = "[0-9]+\\.[0-9][0-9][0-9][0-9]";
  EXPECT_THAT(first, testing::MatchesRegex("1,1," + number + "," + number +
                                           ",0\\.050000,-?[0-9]\\.[0-9]+,abp,[0-9]+,free,none," +
                                           number + "," + number + "," + number + "," + number));
}

TEST(Trajectories, SayForEveryRowWhyItIsNotFree) {
  std::istringstream dut(trajectoriesOf(smallRun()));
  std::string line;
  std::getline(dut, line);
  std::map<std::string, int> states;
  while (std::getline(dut, line)) {
    std::vector<std::string> fields;
    std::istringstream row(line);
    for (std::string field; std::getline(row, field, ',');) fields.push_back(field);
    ASSERT_EQ(fields.size(), 14U) << line;
    const bool is_free = fields[8] == "free";
    EXPECT_EQ(is_free, fields[7] != "-1") << line;
    EXPECT_EQ(is_free, fields[12] != "nan") << line;
    ++states[fields[8]];
  }
  EXPECT_GT(states["free"], 1500);
  EXPECT_GT(states["reversing"], 0);
  EXPECT_LE(states["lost"], 20);  // the last frames, after the last telemetry
}

TEST(Trajectories, HasARowForEachRobotInEachFrame) {
  const std::string dut = trajectoriesOf(smallRun());

  EXPECT_EQ(std::count(dut.begin(), dut.end(), '\n'), 1 + 2 * 1200);
}

TEST(Trajectories, WritesPositionsInCentimetresToTheMicrometre) {
  RunRecord record;
  record.tracks.frames.push_back({-250'000, 7, 0});
  record.tracks.rows.push_back(rowOf(3, 0.5F, -0.000004F, -3.0F));

  EXPECT_EQ(trajectoriesOf(record),
            "frame,particle,x,y,t,theta,program,segment,state,contact,light_front,light_back,"
            "x_stitched,y_stitched\n"
            "7,3,50.0000,-0.0004,-0.250000,-3.000000,standing,-1,lost,none,nan,nan,nan,nan\n");
}

TEST(Trajectories, WritesNanForInvalidNumbers) {
  RunRecord record;
  record.tracks.frames.push_back({0, 1, 0});
  record.tracks.rows.push_back(rowOf(1, std::numeric_limits<float>::quiet_NaN(),
                                     std::numeric_limits<float>::infinity(), 1e30F));

  EXPECT_THAT(trajectoriesOf(record), HasSubstr("\n1,1,nan,nan,0.000000,nan,standing,-1,"));
}

TEST(Trajectories, QuotesProgramNamesThatNeedIt) {
  RunRecord record;
  record.programs.push_back({{}, "a,\"b\""});
  record.tracks.frames.push_back({0, 1, 0});
  TrackRow& row = record.tracks.rows.push_back(rowOf(1, 0, 0, 0));
  row.program = 0;
  row.segment = 2;
  row.state = analysis::FrameState::kContact;
  row.contact_wall = row.contact_robot = true;

  EXPECT_THAT(trajectoriesOf(record), HasSubstr(",\"a,\"\"b\"\"\",2,contact,both,"));
}

/// Names come from logs, and `program` is a column of text: a spreadsheet would compute it.
TEST(Trajectories, WriteNoNameThatASpreadsheetComputes) {
  RunRecord record;
  record.programs.push_back({{}, "=HYPERLINK(\"http://x\",1)"});
  record.tracks.frames.push_back({0, 1, 0});
  TrackRow& row = record.tracks.rows.push_back(rowOf(1, -0.5F, 0, 0));
  row.program = 0;

  EXPECT_THAT(trajectoriesOf(record), HasSubstr("\n1,1,-50.0000,0.0000,0.000000,0.000000,"
                                                "\"'=HYPERLINK(\"\"http://x\"\",1)\","));
  for (const char* name : {"=1", "+1", "-1", "@SUM(A1)", "\t=1"}) {
    EXPECT_EQ(csvField(name), std::string("'") + name);
  }
  EXPECT_EQ(csvField("abp-2 = @x"), "abp-2 = @x");
}

TEST(Summary, HasTheResultsOfTheRun) {
  const auto dut = nlohmann::json::parse(summaryJson(smallRun()));

  EXPECT_EQ(dut["experiment"], "synthetic");
  EXPECT_EQ(dut["seed"], 7);
  EXPECT_EQ(dut["contract_version"], 5);
  EXPECT_DOUBLE_EQ(dut["duration_s"], 60);
  ASSERT_EQ(dut["programs"].size(), 2U);
  const auto& abp = dut["programs"][0];
  EXPECT_EQ(abp["name"], "abp");
  EXPECT_EQ(abp["pool"]["robots"], 2);
  EXPECT_EQ(abp["each_robot"].size(), 2U);
  EXPECT_EQ(abp["parameter_values"],
            nlohmann::json::parse(R"({"v_cm_s": 3, "epsilon_s": 0.5, "eta_rad_s": 3})"));
  EXPECT_NEAR(abp["pool"]["estimates"]["v_cm_s"]["value"], 3, 0.1);
  EXPECT_DOUBLE_EQ(abp["pool"]["estimates"]["D_r_rad2_s"]["theory"], 0.75);
  EXPECT_EQ(abp["pool"]["msd"]["lag_s"].size(), abp["pool"]["msd"]["value_cm2"].size());
  EXPECT_EQ(dut["steps"].size(), 4U);
  EXPECT_DOUBLE_EQ(dut["latency"]["presented"]["p50_ms"], 17);
  for (const auto& stream : dut["losses"]["log"]) EXPECT_EQ(stream["lost"], 0);
}

TEST(Summary, IsTheSameForTheSameRunInAnotherFolder) {
  const Experiment experiment = syntheticExperiment(1, 15, 20, {paperAbp()}, 15);

  EXPECT_EQ(summaryJson(recordOf(experiment)), summaryJson(recordOf(experiment)));
}

TEST(Summary, WritesNullForUndeterminedValues) {
  const std::string dut = summaryJson(recordOf(syntheticExperiment(1, 1, 20, {paperAbp()}, 15)));

  EXPECT_THAT(dut, HasSubstr("null"));
  EXPECT_THAT(dut, Not(HasSubstr("nan")));
  EXPECT_THAT(dut, Not(HasSubstr("inf")));
}

TEST(Summary, ToleratesInvalidUtf8) {
  RunRecord record;
  record.faults.push_back({0, "\xff\xfe broken"});

  EXPECT_TRUE(nlohmann::json::accept(summaryJson(record)));
}

TEST(Html, EscapesEverythingThatComesFromTheLog) {
  const std::string hostile = "<script>alert('x')</script>&\"";
  RunRecord record = smallRun();
  record.experiment->name = hostile;
  record.experiment->description = hostile;
  record.experiment_text = hostile;
  record.experiment_problem = hostile;
  record.version = hostile;
  record.calibration = hostile;
  record.programs[0].name = hostile;
  record.faults.push_back({record.start_utime, hostile});
  record.marks.push_back({record.start_utime, hostile});
  for (StepRecord& step : record.steps) step.label = hostile;
  record.services[0].name = hostile;
  record.services[0].last_error = hostile;
  record.services[0].version = hostile;
  record.log.streams[0].sender = hostile;
  record.log.streams[0].channel = hostile;
  record.log.decode_errors[hostile] = 1;
  record.listeners.push_back({hostile, hostile, hostile, 1, 1});

  const std::string dut = reportHtml(record, {{"x", hostile, hostile, hostile, "", "", ""}});

  EXPECT_THAT(dut, Not(HasSubstr("<script")));
  EXPECT_THAT(dut, HasSubstr("&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt;&amp;&quot;"));
}

TEST(Html, HasNoExternalReferences) {
  const std::string dut = reportHtml(smallRun(), {});

  for (const char* reference : {"http", "src=", "url(", "@import", "<link", "file:"}) {
    EXPECT_THAT(dut, Not(HasSubstr(reference)));
  }
}

TEST(Html, ShowsFaultsFirst) {
  RunRecord record = smallRun();
  record.faults.push_back({record.start_utime + 2'500'000, "robot 1 has two owners"});

  const std::string dut = reportHtml(record, {});

  const std::size_t fault = dut.find("<b>Fault at 2.5 s:</b> robot 1 has two owners");
  ASSERT_NE(fault, std::string::npos);
  EXPECT_LT(fault, dut.find("<h2>"));
}

TEST(Html, OpensWithThePicturesThenTheVerdictsThenFoldedDetails) {
  std::vector<Figure> figures;
  for (const char* name : {"trajectory_time", "trajectory_program", "light", "msd", "msd_abp"}) {
    figures.push_back({name, std::string("title of ") + name, "", "", "<svg></svg>", "", ""});
  }

  const std::string dut = reportHtml(smallRun(), figures);

  std::vector<std::size_t> places;
  for (const char* text :
       {"title of trajectory_program", "title of msd.", "title of light", "<th>verdict</th>",
        "<details class=\"part\">", "title of trajectory_time", "title of msd_abp"}) {
    places.push_back(dut.find(text));
    EXPECT_NE(places.back(), std::string::npos) << text;
  }
  EXPECT_TRUE(std::is_sorted(places.begin(), places.end()));
}

TEST(Html, OpensWithTheMsdOfTheOnlyProgram) {
  const RunRecord record = recordOf(syntheticExperiment(1, 15, 20, {paperAbp()}, 15));
  const Figure msd{"msd_abp", "title of msd_abp", "", "", "<svg></svg>", "", ""};

  const std::string dut = reportHtml(record, {msd});

  EXPECT_LT(dut.find("title of msd_abp"), dut.find("<th>verdict</th>"));
}

// Results of programs are limited too, with no wheel at a limit.
TEST(Html, CountsReportsWithLimitedResults) {
  RunRecord record = smallRun();
  RobotRecord& robot = record.robots.begin()->second;
  robot.states = 200;
  robot.limited = 17;
  const std::string dut = reportHtml(record, {});
  EXPECT_THAT(dut, HasSubstr("limited</th>"));
  EXPECT_THAT(dut, HasSubstr("a division by 0"));
  EXPECT_THAT(dut, Not(HasSubstr("wheel at its limit")));
  const nlohmann::json json = nlohmann::json::parse(summaryJson(record));
  EXPECT_EQ(json["robots"][0]["limited_reports"], 17);
  EXPECT_EQ(json["robots"][0]["limited_share"], 0.085);
}

TEST(Html, ReportsLostMessages) {
  RunRecord record = smallRun();
  EXPECT_THAT(reportHtml(record, {}), HasSubstr("Every message that was sent is in the log."));

  record.log.streams[0].lost = 3;
  EXPECT_THAT(reportHtml(record, {}), HasSubstr("<b>Lost:</b> 3 of "));

  record.log.streams[0].at_least = true;
  EXPECT_THAT(reportHtml(record, {}), HasSubstr("<p>At least 3 of "));
}

TEST(Html, MakesAPageForAnEmptyLog) {
  const std::string dut = reportHtml({}, {});

  EXPECT_THAT(dut, HasSubstr("No camera frame is in the log"));
  EXPECT_THAT(dut, HasSubstr("</html>"));
}

}  // namespace
}  // namespace lab::report
