#include "analyzer/analyze_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "analyzer/report_error.hpp"
#include "common/bus/channels.hpp"
#include "tests/analyzer/report/synthetic_lab.hpp"

namespace lab::report {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

std::string problemOf(const fs::path& path) {
  try {
    static_cast<void>(analyzeRun(path));
  } catch (const ReportError& error) {
    return error.what();
  }
  return "none";
}

/// Whether the text contains a date like 2026-01-31.
bool holdsDate(const std::string& text) {
  const std::string pattern = "dddd-dd-dd";
  const auto fits = [](char letter, char wanted) {
    return wanted == 'd' ? letter >= '0' && letter <= '9' : letter == wanted;
  };
  return std::search(text.begin(), text.end(), pattern.begin(), pattern.end(), fits) != text.end();
}

std::vector<std::string> namesIn(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

TEST(AnalyzeRun, WritesAllFilesBesideTheLog) {
  const TemporaryFolder run;
  SyntheticLab(run.path() / "log.lcmlog", syntheticExperiment(2, 30, 20, {paperAbp()}, 30)).run();

  const AnalyzedRun dut = analyzeRun(run.path());

  EXPECT_EQ(dut.report, run.path() / "report.html");
  EXPECT_THAT(namesIn(run.path()),
              testing::ElementsAre("angular_msd_abp.svg", "figures", "light.svg", "log.lcmlog",
                                   "msd_abp.svg", "report.html", "segments.csv", "speed.svg",
                                   "summary.json", "trajectories.csv", "trajectory_program.svg",
                                   "trajectory_time.svg"));
  ASSERT_FALSE(dut.headline.empty());
  EXPECT_THAT(dut.headline[0], HasSubstr("abp: "));
  EXPECT_THAT(dut.headline.back(), testing::AllOf(HasSubstr("diffusion of 2 robots"),
                                                  HasSubstr("abp: D = "), HasSubstr(" (law: ")));
  EXPECT_THAT(readFile(dut.report), HasSubstr("<svg"));
}

TEST(AnalyzeRun, WritesNothingWhereALinkInTheRunLeads) {
  const TemporaryFolder run;
  const TemporaryFolder elsewhere;
  SyntheticLab(run.path() / "log.lcmlog", syntheticExperiment(2, 30, 20, {paperAbp()}, 30)).run();
  fs::create_directory_symlink(elsewhere.path(), run.path() / "figures");
  EXPECT_THAT(problemOf(run.path()),
              testing::AllOf(HasSubstr("figures: found a symbolic link"), HasSubstr("--out")));
  EXPECT_TRUE(fs::is_empty(elsewhere.path()));

  fs::remove(run.path() / "figures");
  std::ofstream(elsewhere.path() / "kept") << "kept";
  fs::create_symlink(elsewhere.path() / "kept", run.path() / "report.html");
  static_cast<void>(analyzeRun(run.path()));
  EXPECT_EQ(readFile(elsewhere.path() / "kept"), "kept");
  EXPECT_FALSE(fs::is_symlink(run.path() / "report.html"));
}

TEST(AnalyzeRun, DoesNotWaitForALogThatIsAPipe) {
  const TemporaryFolder run;
  ASSERT_EQ(mkfifo((run.path() / "log.lcmlog").c_str(), 0600), 0);
  EXPECT_THAT(problemOf(run.path()), HasSubstr("log.lcmlog: found a pipe"));
}

TEST(AnalyzeRun, WritesTheSameBytesEveryTimeAndEverywhere) {
  const TemporaryFolder run;
  const TemporaryFolder elsewhere;
  SyntheticLab(run.path() / "log.lcmlog",
               syntheticExperiment(3, 40, 20, {paperAbp(), paperBp(), paperRtp()}, 10))
      .run();

  const AnalyzedRun first = analyzeRun(run.path());
  fs::rename(run.path() / "log.lcmlog", elsewhere.path() / "renamed.lcmlog");
  const AnalyzedRun again = analyzeRun(elsewhere.path() / "renamed.lcmlog", elsewhere.path() / "x");

  ASSERT_EQ(first.files.size(), again.files.size());
  for (std::size_t i = 0; i < first.files.size(); ++i) {
    EXPECT_EQ(first.files[i].filename(), again.files[i].filename());
    EXPECT_TRUE(readFile(first.files[i]) == readFile(again.files[i])) << first.files[i];
  }
}

TEST(AnalyzeRun, ContainsNeitherPlaceNorTimeOfTheAnalysis) {
  const TemporaryFolder run;
  SyntheticLab(run.path() / "log.lcmlog", syntheticExperiment(1, 10, 20, {paperAbp()}, 30)).run();

  for (const fs::path& file : analyzeRun(run.path()).files) {
    const std::string text = readFile(file);
    EXPECT_EQ(text.find(run.path().filename().string()), std::string::npos) << file;
    EXPECT_FALSE(holdsDate(text)) << file;
  }
}

TEST(AnalyzeRun, MakesAReportOfARunOfOneSecond) {
  const TemporaryFolder run;
  SyntheticLab(run.path() / "log.lcmlog", syntheticExperiment(1, 1, 10, {paperAbp()}, 30)).run();

  const AnalyzedRun dut = analyzeRun(run.path());

  EXPECT_THAT(readFile(dut.report), HasSubstr("Undecided"));
}

TEST(AnalyzeRun, MakesAReportOfManyRobots) {
  const TemporaryFolder run;
  SyntheticLab(run.path() / "log.lcmlog",
               syntheticExperiment(40, 20, 10, {paperAbp(), paperRtp()}, 5))
      .run();

  const AnalyzedRun dut = analyzeRun(run.path());

  EXPECT_THAT(readFile(dut.report), HasSubstr("40 robots"));
}

TEST(AnalyzeRun, ReportsAMissingFile) {
  const TemporaryFolder folder;

  EXPECT_THAT(problemOf(folder.path() / "nothing"), HasSubstr("no such file or folder"));
  EXPECT_THAT(problemOf(folder.path()), HasSubstr("no log.lcmlog in this folder"));
}

TEST(AnalyzeRun, ReportsAFileThatIsNotALog) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "notes.txt") << "frame,particle,x,y\n1,1,2,3\n";

  EXPECT_THAT(problemOf(folder.path() / "notes.txt"), HasSubstr("not an LCM log"));

  const std::filesystem::path packed = folder.path() / "log.lcmlog.xz";
  std::ofstream(packed) << "7zXZ";
  EXPECT_THAT(problemOf(packed), HasSubstr("; unpack it first: xz -dk " + packed.string()));
}

TEST(AnalyzeRun, ReportsAnEmptyLog) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "log.lcmlog") << "";

  EXPECT_THAT(problemOf(folder.path()), HasSubstr("the log is empty"));
}

TEST(AnalyzeRun, ReportsTheContentOfALogWithoutFrames) {
  const TemporaryFolder run;
  SyntheticLab(run.path() / "log.lcmlog", syntheticExperiment(1, 5, 20, {paperAbp()}, 30),
               [](const Packet& packet) { return packet.channel != channels::kTrackedFrame; })
      .run();

  EXPECT_THAT(problemOf(run.path()), HasSubstr("no TRACKED_FRAME in this log"));
  EXPECT_THAT(problemOf(run.path()), HasSubstr("100 ROBOT_STATUS from sim_svc"));
  EXPECT_THAT(namesIn(run.path()), testing::ElementsAre("log.lcmlog"));
}

TEST(AnalyzeRun, AnalyzesARunWithoutFramesIfAsked) {
  const TemporaryFolder run;
  SyntheticLab(run.path() / "log.lcmlog", syntheticExperiment(1, 5, 20, {paperAbp()}, 30),
               [](const Packet& packet) { return packet.channel != channels::kTrackedFrame; })
      .run();

  const AnalyzedRun dut = analyzeRun(run.path(), {}, {.needs_frames = false});

  EXPECT_THAT(readFile(dut.report), HasSubstr("No camera frame is in the log"));
  EXPECT_THAT(readFile(dut.report), HasSubstr("<b>Lost:</b> 100 of "));
}

TEST(AnalyzeRun, ErrorNamesThePackageOfGnuplot) {
  const TemporaryFolder run;
  SyntheticLab(run.path() / "log.lcmlog", syntheticExperiment(1, 5, 20, {paperAbp()}, 30)).run();
  const std::string path = std::getenv("PATH");
  setenv("PATH", run.path().c_str(), 1);

  const std::string dut = problemOf(run.path());

  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(dut, HasSubstr("sudo apt-get install gnuplot-nox"));
  EXPECT_THAT(namesIn(run.path()), testing::ElementsAre("log.lcmlog"));
}

}  // namespace
}  // namespace lab::report
