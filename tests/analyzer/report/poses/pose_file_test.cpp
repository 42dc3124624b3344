#include "analyzer/report/poses/pose_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <sstream>

#include "analyzer/report_error.hpp"
#include "tests/analyzer/report/synthetic_lab.hpp"

namespace lab::report::pose_file_test {
namespace {

using testing::HasSubstr;

PoseFile read(const std::string& text, const PoseFileOptions& options = {}) {
  std::istringstream stream(text);
  return readPoses(stream, "poses.csv", options);
}

std::string problemOf(const std::string& text, const PoseFileOptions& options = {}) {
  try {
    static_cast<void>(read(text, options));
  } catch (const ReportError& error) {
    return error.what();
  }
  return "none";
}

TEST(PoseFile, ReadsFilesOfLabTrack) {
  const PoseFile dut = read(
      "frame,id,x_cm,y_cm,theta_rad,u,v,confidence,t_s\n"
      "0,1,10.5,20,1.5,640.1,360.2,0.98,0.0\n"
      "0,2,30,40,-3.1,1,2,0.3,0.0\n"
      "1,1,11,20,1.6,641,360,0.97,0.033333\n");

  ASSERT_EQ(dut.frames.size(), 2U);
  ASSERT_EQ(dut.posesOf(0).size(), 2U);
  EXPECT_DOUBLE_EQ(dut.posesOf(0)[0].x, 0.105);
  EXPECT_DOUBLE_EQ(dut.posesOf(0)[0].y, 0.2);
  EXPECT_DOUBLE_EQ(dut.posesOf(0)[0].theta, 1.5);
  EXPECT_TRUE(dut.posesOf(0)[0].valid);
  EXPECT_FALSE(dut.posesOf(0)[1].valid);
  EXPECT_DOUBLE_EQ(dut.frames[1].time, 0.033333);
  EXPECT_DOUBLE_EQ(dut.frame_period, 0.033333);
  EXPECT_TRUE(dut.headings);
  EXPECT_TRUE(dut.in_arena);
}

TEST(PoseFile, ReadsBlobsWithoutHeading) {
  const PoseFile dut = read(
      "frame,id,x_cm,y_cm,theta_rad,u,v,confidence,t_s,area_cm2,length_cm,width_cm,merged,swap\n"
      "0,1,10.5,20,,640.1,360.2,0.98,0.0,1.1,1.2,1.2,1,0\n"
      "0,2,30,40,0.2,1,2,0.9,0.0,1.1,1.4,1.2,1,0\n"
      "1,1,11,20,,641,360,0.97,0.033333,1.1,1.2,1.2,1,1e-5\n");

  EXPECT_FALSE(dut.headings);
  ASSERT_EQ(dut.frames.size(), 2U);
  EXPECT_EQ(dut.posesOf(0).size(), 2U);
  EXPECT_EQ(dut.posesOf(0)[1].theta, 0);
}

TEST(PoseFile, LeavesOutTheFewRowsWithoutHeading) {
  const PoseFile dut = read(
      "frame,id,x_cm,y_cm,theta_rad,confidence,t_s\n"
      "0,1,10.5,20,1.5,0.98,0.0\n"
      "1,1,11,20,,0.97,0.1\n"
      "2,1,12,20,1.4,0.97,0.2\n");

  EXPECT_TRUE(dut.headings);
  EXPECT_EQ(dut.frames.size(), 2U);
  EXPECT_EQ(dut.without_pose, 1);
}

TEST(PoseFile, ReadsFilesOfIdtracker) {
  const PoseFile dut = read(
      "time,x1,y1,x2,y2\n"
      "0.000,100,200,300,400\n"
      "0.100,101,200,nan,nan\n",
      {.scale = 0.001, .fps = {}});

  ASSERT_EQ(dut.frames.size(), 2U);
  ASSERT_EQ(dut.posesOf(0).size(), 2U);
  EXPECT_EQ(dut.posesOf(0)[1].robot, 2);
  EXPECT_DOUBLE_EQ(dut.posesOf(0)[1].x, 0.3);
  EXPECT_EQ(dut.posesOf(1).size(), 1U);
  EXPECT_DOUBLE_EQ(dut.frames[1].time, 0.1);
  EXPECT_FALSE(dut.headings);
  EXPECT_EQ(dut.without_pose, 1);
}

TEST(PoseFile, NeedsScaleAndTimesOfIdtracker) {
  EXPECT_THAT(problemOf("x1,y1\n1,2\n", {.scale = {}, .fps = 10}), HasSubstr("--scale-cm"));
  EXPECT_THAT(problemOf("x1,y1\n1,2\n", {.scale = 0.001, .fps = {}}), HasSubstr("--fps"));
  EXPECT_THAT(problemOf("time,x1,y1\n0,1,2\n", {.scale = 0.001, .fps = 10}),
              HasSubstr("beside --fps"));
}

TEST(PoseFile, ReadsFilesOfTrackpy) {
  const PoseFile dut = read(
      ",y,x,mass,frame,particle\n"
      "0,200.5,100.0,331.2,0.0,7\n"
      "1,300,400,331.2,0.0,8\n"
      "0,201,101,330.1,2.0,7\n",
      {.scale = 0.001, .fps = 10});

  ASSERT_EQ(dut.frames.size(), 2U);
  EXPECT_EQ(dut.posesOf(0)[0].robot, 7);
  EXPECT_DOUBLE_EQ(dut.posesOf(0)[0].x, 0.1);
  EXPECT_DOUBLE_EQ(dut.posesOf(0)[0].y, 0.2005);
  EXPECT_DOUBLE_EQ(dut.frames[1].time, 0.2);
  EXPECT_FALSE(dut.headings);
  EXPECT_FALSE(dut.in_arena);
}

TEST(PoseFile, SortsRowsGroupedByRobot) {
  const PoseFile dut = read(
      "frame\tid\tx_cm\ty_cm\tt\n0\t1\t1\t1\t0\n1\t1\t2\t1\t0.1\n0\t2\t5\t5\t0\n1\t2\t6\t5\t0.1\n");

  ASSERT_EQ(dut.frames.size(), 2U);
  EXPECT_EQ(dut.posesOf(0).size(), 2U);
  EXPECT_EQ(dut.posesOf(1).size(), 2U);
}

TEST(PoseFile, ReadsWindowsLineEndsAndMarks) {
  const PoseFile dut = read(
      "\xEF\xBB\xBF"
      "frame;id;x_cm;y_cm;t\r\n0;1;1;2;0\r\n\r\n1;1;1;3;0.5\r\n");

  EXPECT_EQ(dut.frames.size(), 2U);
  EXPECT_DOUBLE_EQ(dut.posesOf(1)[0].y, 0.03);
}

TEST(PoseFile, OmitsRowsWithoutAPose) {
  const PoseFile dut =
      read("frame,id,x_cm,y_cm,t\n0,1,1,1,0\n0,2,,,0\n1,1,nan,nan,0.1\n1,0,4,4,0.1\n2,1,3,1,0.2\n");

  EXPECT_EQ(dut.rows, 5);
  EXPECT_EQ(dut.without_pose, 2);
  EXPECT_EQ(dut.without_id, 1);
  EXPECT_EQ(dut.frames.size(), 2U);
  EXPECT_EQ(dut.missing_frames, 0);
}

TEST(PoseFile, CountsMissingFrames) {
  const std::string rows = "0,1,1,1,0\n2,1,1,1,0.2\n4,1,1,1,0.4\n10,1,1,1,1.0\n";

  // Every second picture was tracked: 6 and 8 are missing, the odd ones are not.
  EXPECT_EQ(read("frame,id,x_cm,y_cm,t\n" + rows).missing_frames, 2);
}

TEST(PoseFile, ErrorsNameLineColumnFoundAndExpected) {
  const std::string head = "frame,id,x_cm,y_cm,t\n0,1,1,1,0\n";

  EXPECT_EQ(problemOf(head + "1,1,abc,1,0.1\n"),
            "poses.csv:3: x_cm: found \"abc\", expected a number");
  EXPECT_THAT(problemOf("frame;id;x_cm;y_cm;t\n0;1;1,5;1;0\n"),
              HasSubstr("x_cm: found \"1,5\", expected a number with a point, not a comma"));
  EXPECT_THAT(problemOf(std::string("f\0r\0a\0m\0e\0\n", 11)), HasSubstr("UTF-16"));
  EXPECT_EQ(problemOf(head + "1.5,1,1,1,0.1\n"),
            "poses.csv:3: frame: found \"1.5\", expected a whole number");
  EXPECT_EQ(problemOf(head + "1,1,1\n"),
            "poses.csv:3: found 3 fields, expected 5 as in the first line");
  EXPECT_THAT(problemOf(head + "1,1,1,1,0\n"), HasSubstr("poses.csv:3: t: found 0 s in frame 1"));
  EXPECT_THAT(problemOf(head + "0,2,1,1,7\n"),
              HasSubstr("poses.csv:3: t: found 7 s, expected 0 s"));
}

TEST(PoseFile, RejectsTimesThatCannotBeSeconds) {
  const std::string head = "frame,id,x_cm,y_cm,t_s\n";

  EXPECT_EQ(problemOf(head + "0,1,2,3,1.76e9\n1,1,2,3,1760000001\n"), "none");
  EXPECT_EQ(
      problemOf(head + "0,1,2,3,1.76e18\n1,1,2,3,1.7600000001e18\n"),
      "poses.csv:2: t_s: found 1.76e+18 s, expected less than 1e11 s; times in other units: leave "
      "the column out and give --fps");
  EXPECT_EQ(
      problemOf("frame,id,x_cm,y_cm\n2,1,2,3\n3,1,2,3\n", {.scale = std::nullopt, .fps = 1e-12}),
      "poses.csv:2: --fps: found 2000000000000 s, expected less than 1e11 s");
  EXPECT_EQ(
      problemOf("time,x1,y1\n0,1,2\n1.76e12,1,2\n", {.scale = 0.001, .fps = std::nullopt}),
      "poses.csv:3: time: found 1760000000000 s, expected less than 1e11 s; times in other units: "
      "leave the column out and give --fps");
  EXPECT_EQ(
      problemOf(head + "0,1,2,3,0\n1,1,2,3,1e-9\n"),
      "poses.csv:1: t_s: found 1e-09 s from frame to frame, expected 1e-6 s or more; times in "
      "other units: leave the column out and give --fps");
}

TEST(PoseFile, RejectsPlacesAndAnglesThatNoRobotHas) {
  const std::string head = "frame,id,x_cm,y_cm,theta_rad,t_s\n";

  EXPECT_EQ(problemOf(head + "0,1,99999,3,0,0\n1,1,2,3,0,0.1\n"), "none");
  EXPECT_EQ(problemOf(head + "0,1,1e300,3,0,0\n"),
            "poses.csv:2: x_cm: found 1e+300, more than 1 km away; expected a place in cm");
  EXPECT_EQ(problemOf(head + "0,1,2,3,-1e7,0\n"),
            "poses.csv:2: theta_rad: found -10000000, expected an angle in rad, of at most 1e6");
  EXPECT_THAT(problemOf("time,x1,y1\n0,1,-1e9\n", {.scale = 0.01, .fps = std::nullopt}),
              HasSubstr("y1: found -1000000000, more than 1 km away; expected a place in units of "
                        "--scale-cm"));
}

TEST(PoseFile, RefusesLinesAndColumnsWithoutEnd) {
  std::string header = "time";
  for (int robot = 1; robot <= 2100; ++robot) {
    header += ",x" + std::to_string(robot) + ",y" + std::to_string(robot);
  }
  EXPECT_THAT(problemOf(header + "\n", {.scale = 0.01, .fps = std::nullopt}),
              HasSubstr("poses.csv:1: found 4201 columns, expected at most 4096"));
  EXPECT_THAT(problemOf(std::string(2'000'000, 'x')),
              HasSubstr("poses.csv:1: found a line of more than 1 MB"));
  EXPECT_THAT(problemOf("frame,id,x_cm,y_cm,t_s\n0,1,2,3,0\n" + std::string(2'000'000, '1')),
              HasSubstr("poses.csv:3: found a line of more than 1 MB"));
  EXPECT_EQ(problemOf("frame,id,x_cm,y_cm,t_s\n0,1,2,3,0\n1,1,2,3,0.1"), "none")
      << "without an end of the last line";
}

TEST(PoseFile, ReadsFilesOfTrex) {
  // The format of TRex: the frame twice, units in brackets, inf for unknown values.
  const std::string text =
      "frame,X#wcentroid (cm),Y#wcentroid (cm),X (cm),Y (cm),ANGLE,time,missing,frame\n"
      "0,10.5,20,11,20,0.5,0.0,0,0\n"
      "1,inf,inf,inf,inf,inf,0.04,1,1\n"
      "2,10.9,20.1,11.4,20.1,0.6,0.08,0,2,,\n"
      "3,11,20.2,11.5,20.2,0.6,0.12,1,3\n";
  const PoseFile dut = read(text);

  ASSERT_EQ(dut.frames.size(), 2U);
  EXPECT_DOUBLE_EQ(dut.posesOf(0)[0].x, 0.105);
  EXPECT_DOUBLE_EQ(dut.posesOf(1)[0].y, 0.201);
  EXPECT_DOUBLE_EQ(dut.posesOf(1)[0].theta, 0.6);
  EXPECT_EQ(dut.without_pose, 2);
  EXPECT_TRUE(dut.headings);
  EXPECT_FALSE(dut.in_arena);
}

TEST(PoseFile, ReadsAFolderOfTrexFiles) {
  const TemporaryFolder folder;
  for (const int fish : {0, 1, 10}) {
    std::ofstream file(folder.path() / ("recording_fish" + std::to_string(fish) + ".csv"));
    file << "frame,X#wcentroid,Y#wcentroid,time\n0," << fish << ",1,0\n1," << fish << ",2,0.1\n";
  }
  std::ofstream(folder.path() / "notes.csv") << "nothing\n";

  const PoseFile dut = readPoses(folder.path());

  ASSERT_EQ(dut.frames.size(), 2U);
  ASSERT_EQ(dut.posesOf(0).size(), 3U);
  EXPECT_EQ(dut.posesOf(0)[2].robot, 10);
  EXPECT_DOUBLE_EQ(dut.posesOf(1)[2].x, 0.1);
}

TEST(PoseFile, OpensNoPipeOrDeviceInAFolderOfTrexFiles) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder.path() / "x_id0.csv").c_str(), 0600), 0);
  EXPECT_THROW(static_cast<void>(readPoses(folder.path())), ReportError);
  std::filesystem::remove(folder.path() / "x_id0.csv");
  std::filesystem::create_symlink("/dev/zero", folder.path() / "x_id0.csv");
  EXPECT_THROW(static_cast<void>(readPoses(folder.path())), ReportError);
}

TEST(PoseFile, OmitsFramesWhoseTimeDoesNotIncrease) {
  std::string text = "frame,id,x_cm,y_cm,t\n";
  for (int i = 0; i < 100; ++i) {
    text += std::to_string(i) + ",1,1,1," + std::to_string(i == 50 ? 4.9 : 0.1 * i) + "\n";
  }
  const PoseFile dut = read(text);

  EXPECT_EQ(dut.bad_times, 1);
  EXPECT_EQ(dut.frames.size(), 99U);
  EXPECT_EQ(dut.missing_frames, 0);
  EXPECT_TRUE(dut.clock_steps.empty());
}

TEST(PoseFile, CountsARobotOncePerFrame) {
  std::string text = "frame,id,x_cm,y_cm,t\n";
  for (int i = 0; i < 100; ++i) {
    const std::string row =
        std::to_string(i) + ",1," + std::to_string(i) + ",1," + std::to_string(0.1 * i) + "\n";
    text += row;
    if (i % 2 == 0) text += row;
    if (i == 50) text += std::to_string(i) + ",1,2,2,5\n";
  }
  const PoseFile dut = read(text);

  EXPECT_EQ(dut.repeated, 49);
  EXPECT_EQ(dut.contradicted, 1);
  EXPECT_EQ(dut.frames.size(), 99U);
  for (std::size_t i = 0; i < dut.frames.size(); ++i) EXPECT_EQ(dut.posesOf(i).size(), 1U);
}

TEST(PoseFile, RejectsRobotsAtTwoPositions) {
  std::string text = "frame,id,x_cm,y_cm,t\n";
  for (int i = 0; i < 20; ++i) {
    for (const char* place : {"1,1", "50,50"}) {
      text += std::to_string(i) + ",7," + place + "," + std::to_string(0.1 * i) + "\n";
    }
  }
  EXPECT_THAT(problemOf(text),
              HasSubstr("poses.csv:3: id: found 7 twice, and not alike, in frame 0"));
  EXPECT_THAT(problemOf(text), HasSubstr("20 of 20 poses"));
}

TEST(PoseFile, RecordsStepsOfTheClock) {
  std::string text = "frame,id,x_cm,y_cm,t\n";
  for (int i = 0; i < 100; ++i) {
    text += std::to_string(i) + ",1,1,1," + std::to_string(0.1 * i + (i < 60 ? 0 : 5)) + "\n";
  }
  const PoseFile dut = read(text);

  ASSERT_EQ(dut.clock_steps.size(), 1U);
  EXPECT_DOUBLE_EQ(dut.clock_steps[0], 11);
}

TEST(PoseFile, ErrorNamesMissingColumns) {
  EXPECT_THAT(problemOf("frame,id,x_cm\n0,1,1\n"), HasSubstr("poses.csv:1: found the columns"));
  EXPECT_THAT(problemOf("frame,particle,x,y,t\n0,1,1,1,0\n"), HasSubstr("--scale-cm"));
  EXPECT_THAT(problemOf("frame,X (px),Y (px),time\n0,1,1,0\n"),
              HasSubstr("X (px): found a place that is not in cm"));
  EXPECT_THAT(problemOf("frame,particle,x,y\n0,1,1,1\n", {.scale = 0.01, .fps = {}}),
              HasSubstr("--fps"));
  EXPECT_THAT(problemOf(""), HasSubstr("poses.csv:1"));
  EXPECT_THAT(problemOf("frame,id,x_cm,y_cm,t\n"), HasSubstr("no pose"));
}

}  // namespace
}  // namespace lab::report::pose_file_test
