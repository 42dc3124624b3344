#include "analyzer/report/poses/pose_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <numbers>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "analyzer/analyze_run.hpp"
#include "analyzer/report/summary/findings.hpp"
#include "analyzer/report_error.hpp"
#include "common/experiment/experiment_file.hpp"
#include "tests/analyzer/report/synthetic_lab.hpp"

namespace lab::report {
namespace {

using testing::HasSubstr;

constexpr double kSpeed = 0.03;   // [m/s]
constexpr double kEpsilon = 0.5;  // [s]
constexpr double kEta = 3;        // [rad/s]
constexpr double kNoise = 2e-5;   // [m]
constexpr double kPeriod = 1.0 / 30;

/// Active Brownian particles (the paper's ABP) in an infinite arena.
PoseFile recording(int robots, double duration, bool headings = true, double sigma = kNoise) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> turning(-kEta, kEta);
  std::normal_distribution<double> noise(0, sigma);
  PoseFile poses;
  poses.headings = headings;
  poses.frame_period = kPeriod;
  struct Robot {
    double x, y, theta, omega, left;
  };
  std::vector<Robot> all;
  for (int i = 0; i < robots; ++i) all.push_back({i * 50.0, 0, i * 1.0, turning(random), kEpsilon});
  for (std::int64_t k = 0; static_cast<double>(k) * kPeriod < duration; ++k) {
    std::vector<Pose> frame;
    for (std::size_t i = 0; i < all.size(); ++i) {
      Robot& robot = all[i];
      frame.push_back({static_cast<int>(i) + 1, true, robot.x + noise(random),
                       robot.y + noise(random),
                       headings ? std::remainder(robot.theta, 2 * std::numbers::pi) : 0});
      for (double left = kPeriod; left > 1e-12;) {
        const double step = std::min(left, robot.left);
        const double turn = robot.omega * step;
        // The chord of an arc.
        const double chord =
            std::abs(turn) > 1e-9 ? kSpeed * step * std::sin(turn / 2) / (turn / 2) : kSpeed * step;
        robot.x += chord * std::cos(robot.theta + turn / 2);
        robot.y += chord * std::sin(robot.theta + turn / 2);
        robot.theta += turn;
        left -= step;
        robot.left -= step;
        if (robot.left <= 1e-12) {
          robot.left = kEpsilon;
          robot.omega = turning(random);
        }
      }
    }
    poses.add(static_cast<double>(k) * kPeriod, k, frame);
  }
  poses.rows = static_cast<std::int64_t>(poses.frames.size()) * robots;
  return poses;
}

PoseProgram abp() { return {"abp", {"v_cm_s=3", "epsilon_s=0.5", "eta_rad_s=3"}}; }

const analysis::Estimate& estimateOf(const RunRecord& record, std::string_view name) {
  for (const analysis::Estimate& estimate : record.results.front().result.estimates) {
    if (estimate.name == name) return estimate;
  }
  throw std::runtime_error("no " + std::string(name));
}

TEST(PoseRun, FindsTheLawThatTheRobotsFollow) {
  const RunRecord dut = poseRun(recording(4, 300), "recording", abp());

  ASSERT_EQ(dut.results.size(), 5U);
  EXPECT_EQ(dut.results.front().result.verdict.kind, analysis::VerdictKind::kAgrees);
  const analysis::Estimate& turning = estimateOf(dut, "D_r");
  EXPECT_LT(std::abs(turning.value - kEpsilon * kEta * kEta / 6), 4 * turning.sigma);
  EXPECT_EQ(dut.robots.size(), 4U);
  EXPECT_EQ(dut.tracks.rows.size(), 4U * 9000U);
  EXPECT_EQ(dut.tracks.rows.front().segment, dut.tracks.rows[400].segment);
  EXPECT_GE(dut.tracks.rows.front().segment, 0);
}

TEST(PoseRun, DisagreesWithAnotherLaw) {
  PoseProgram other = abp();
  other.set.back() = "eta_rad_s=4";

  const RunRecord dut = poseRun(recording(4, 300), "recording", other);

  EXPECT_EQ(dut.results.front().result.verdict.kind, analysis::VerdictKind::kDisagrees);
}

TEST(PoseRun, HasCurvesWithoutALaw) {
  const RunRecord dut = poseRun(recording(2, 60), "recording", {});

  const analysis::ProgramResult& pool = dut.results.front().result;
  ASSERT_FALSE(pool.curves.msd.empty());
  EXPECT_NEAR(pool.curves.msd.front().value, kSpeed * kSpeed * kPeriod * kPeriod,
              10 * kNoise * kNoise);
  EXPECT_TRUE(std::isnan(pool.curves.msd.front().exact));
  EXPECT_GT(pool.curves.msd.front().sigma, 0);
  EXPECT_EQ(pool.verdict.judged, 0);
  EXPECT_EQ(verdictText(pool), "no law to compare with");
  EXPECT_NEAR(estimateOf(dut, "v").value, kSpeed, 1e-5);
}

TEST(PoseRun, ComparesOnlyTheMsdWithoutHeadings) {
  const RunRecord dut = poseRun(recording(4, 300, false), "recording", abp());

  const analysis::ProgramResult& pool = dut.results.front().result;
  EXPECT_EQ(pool.verdict.kind, analysis::VerdictKind::kAgrees);
  for (const analysis::CurvePoint& point : pool.curves.angular_msd) EXPECT_EQ(point.windows, 0);
  EXPECT_TRUE(std::isnan(estimateOf(dut, "D_r").value));
  EXPECT_TRUE(std::isnan(estimateOf(dut, "v").value));
}

// Between two frames, 0.3 mm of noise is a fifth of the displacement.
TEST(PoseRun, RemovesTheFittedNoiseWithoutHeadings) {
  const RunRecord dut = poseRun(recording(4, 300, false, 3e-4), "recording", abp());

  const analysis::ProgramResult& pool = dut.results.front().result;
  EXPECT_EQ(pool.verdict.kind, analysis::VerdictKind::kAgrees) << pool.verdict.max_z;
  EXPECT_NEAR(pool.curves.msd.front().noise, 4 * 3e-4 * 3e-4, 0.1 * 4 * 3e-4 * 3e-4);

  PoseProgram other = abp();
  other.set.back() = "eta_rad_s=4";
  const RunRecord wrong = poseRun(recording(4, 300, false, 3e-4), "recording", other);
  EXPECT_EQ(wrong.results.front().result.verdict.kind, analysis::VerdictKind::kDisagrees);
}

// Noise of 0.2 rad exceeds the possible turn between two frames, but is not a jump.
TEST(PoseRun, DistinguishesNoisyHeadingsFromJumps) {
  PoseFile noisy = recording(4, 300);
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0, 0.2);
  noisy.poses.each([&](Pose& pose) { pose.theta += noise(random); });

  const RunRecord dut = poseRun(noisy, "recording", abp());

  const analysis::ProgramResult& pool = dut.results.front().result;
  EXPECT_EQ(pool.lost, 0);
  EXPECT_EQ(pool.segments, 4);
  EXPECT_EQ(pool.verdict.kind, analysis::VerdictKind::kAgrees) << pool.verdict.max_z;
  EXPECT_NEAR(pool.curves.angular_msd.front().noise, 2 * 0.2 * 0.2, 0.1 * 2 * 0.2 * 0.2);
}

TEST(PoseRun, ReportsThatMostOfARecordingIsNotJudged) {
  PoseFile wrong_unit = recording(2, 60);
  wrong_unit.poses.each([](Pose& pose) {
    pose.x *= 30;
    pose.y *= 30;
  });
  const RunRecord jumps = poseRun(wrong_unit, "recording", abp());
  EXPECT_THAT(headlines(jumps), testing::Contains(HasSubstr("faster than wheels")));
  EXPECT_THAT(headlines(jumps).front(), testing::Not(HasSubstr("D_r")));
  EXPECT_THAT(headlines(poseRun(recording(2, 60), "recording", abp())),
              testing::Not(testing::Contains(HasSubstr("faster than wheels"))));

  PoseFile at_walls = recording(1, 60);
  at_walls.in_arena = true;
  at_walls.poses.each([](Pose& pose) {
    pose.x += 0.1;
    pose.y += 0.1;
  });
  const RunRecord walls = poseRun(at_walls, "recording", abp());
  EXPECT_THAT(headlines(walls), testing::Contains(HasSubstr("wall of the 120 x 90 cm arena")));
}

TEST(PoseRun, GivesNoTumbleRateIfPosesShowNoTumbles) {
  const RunRecord dut = poseRun(
      recording(2, 60), "recording",
      {"rtp", {"v_cm_s=3", "gamma_per_s=1", "tau_t_s=0.05", "robot.max_wheel_speed_cm_s=300"}});

  EXPECT_TRUE(std::isnan(estimateOf(dut, "gamma").value));
  EXPECT_THAT(estimateOf(dut, "gamma").note, HasSubstr("fewer than three frames in a tumble"));
}

/// Run-and-tumble particles in an infinite arena.
PoseFile tumblers(int robots, double duration) {
  constexpr double kTumble = 0.5;  // [s]
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> turn(-std::numbers::pi, std::numbers::pi);
  std::exponential_distribution<double> run(1);
  std::normal_distribution<double> noise(0, 3e-4);
  PoseFile poses;
  poses.headings = true;
  poses.frame_period = kPeriod;
  struct Robot {
    double x, y, theta, left, omega;
  };
  std::vector<Robot> all;
  for (int i = 0; i < robots; ++i) all.push_back({i * 50.0, 0, i * 1.0, run(random), 0});
  for (std::int64_t k = 0; static_cast<double>(k) * kPeriod < duration; ++k) {
    std::vector<Pose> frame;
    for (std::size_t i = 0; i < all.size(); ++i) {
      Robot& robot = all[i];
      frame.push_back({static_cast<int>(i) + 1, true, robot.x + noise(random),
                       robot.y + noise(random), std::remainder(robot.theta, 2 * std::numbers::pi)});
      for (double left = kPeriod; left > 1e-12;) {
        const double step = std::min(left, robot.left);
        if (robot.omega == 0) {
          robot.x += kSpeed * step * std::cos(robot.theta);
          robot.y += kSpeed * step * std::sin(robot.theta);
        }
        robot.theta += robot.omega * step;
        left -= step;
        robot.left -= step;
        if (robot.left <= 1e-12) {
          robot.omega = robot.omega == 0 ? turn(random) / kTumble : 0;
          robot.left = robot.omega == 0 ? run(random) : kTumble;
        }
      }
    }
    poses.add(static_cast<double>(k) * kPeriod, k, frame);
  }
  poses.rows = static_cast<std::int64_t>(poses.frames.size()) * robots;
  return poses;
}

TEST(PoseRun, FindsTheTumblesInThePoses) {
  const RunRecord dut =
      poseRun(tumblers(3, 300), "recording", {"rtp", {"v_cm_s=3", "gamma_per_s=1", "tau_t_s=0.5"}},
              {.depth = analysis::Depth::kLive});

  for (const char* name : {"gamma", "tau_r", "v", "D", "L_s"}) {
    const analysis::Estimate& estimate = estimateOf(dut, name);
    EXPECT_LT(std::abs(estimate.value - estimate.theory), 4 * estimate.sigma) << name;
  }
  ASSERT_TRUE(dut.results.front().result.runs);
  const analysis::RunStatistics& runs = *dut.results.front().result.runs;
  EXPECT_NEAR(runs.find("tau_t")->value, 0.5, 4 * runs.find("tau_t")->sigma);
  EXPECT_GT(runs.uniform.p, 1e-3);
  EXPECT_GT(runs.exponential.p, 1e-3);
}

/// Places in cm.
void writeCsv(const PoseFile& poses, std::ostream& file) {
  file << "frame,particle,x,y,theta,t\n";
  poses.eachFrame([&](const PoseFrame& frame, std::span<const Pose> robots) {
    for (const Pose& pose : robots) {
      file << frame.frame << ',' << pose.robot << ',' << pose.x * 100 << ',' << pose.y * 100 << ','
           << pose.theta << ',' << frame.time << '\n';
    }
  });
}

TEST(AnalyzePoses, ShowsRunsAndTumbles) {
  const TemporaryFolder folder;
  {
    std::ofstream file(folder.path() / "poses.csv");
    writeCsv(tumblers(2, 120), file);
  }
  const AnalyzedRun dut =
      analyzePoses(folder.path() / "poses.csv", folder.path() / "out", {.scale = 0.01, .fps = {}},
                   {"rtp", {"v_cm_s=3", "gamma_per_s=1", "tau_t_s=0.5"}});

  const std::string page = readFile(dut.report);
  EXPECT_THAT(page, HasSubstr("Runs and tumbles"));
  EXPECT_THAT(page, HasSubstr("run times are exponential"));
  const std::string summary = readFile(folder.path() / "out" / "summary.json");
  EXPECT_THAT(summary, HasSubstr("\"run_time_distribution\""));
  EXPECT_THAT(summary, HasSubstr("\"gamma_truncated_per_s\""));
  EXPECT_THAT(readFile(folder.path() / "out" / "run_times_rtp.svg"), HasSubstr("<svg"));
  EXPECT_THAT(readFile(folder.path() / "out" / "tumble_angles_rtp.svg"), HasSubstr("<svg"));
}

TEST(PoseRun, CutsAtContacts) {
  PoseFile poses = recording(2, 10);
  poses.eachFrame([](const PoseFrame& frame, std::span<Pose> robots) {
    if (frame.time < 4 || frame.time > 5) return;
    robots[1].x = robots[0].x + 0.075;
    robots[1].y = robots[0].y;
  });

  const RunRecord dut = poseRun(poses, "recording", abp());

  EXPECT_GT(dut.results.front().result.contact_share, 0.09);
  EXPECT_EQ(dut.tracks.rows[2 * 135].segment, -1);
  EXPECT_NE(dut.tracks.rows[2 * 100].segment, dut.tracks.rows[2 * 200].segment);
}

/// Pairs of neighbours would be 1.5e9 here.
TEST(PoseRun, BoundsTheWorkForManyRobotsAtOnePlace) {
  PoseFile poses;
  constexpr int kMany = 10'000;
  std::vector<Pose> robots(kMany);
  for (int i = 0; i < kMany; ++i) robots[static_cast<std::size_t>(i)] = {i + 1, true, 0.4, 0.4, 0};
  for (int k = 0; k < 30; ++k) poses.add(0.1 * k, k, robots);
  poses.times = true;
  poses.frame_period = 0.1;

  const RunRecord dut = poseRun(poses, "recording", {});

  EXPECT_EQ(dut.poses->in_contact, 30 * kMany);
}

TEST(PoseRun, RefusesIdsThatComeBackAfterHours) {
  PoseFile poses;
  constexpr int kFrames = 20'000;
  for (int k = 0; k < 2 * kFrames; ++k) {
    const std::vector<Pose> one{{k % kFrames + 1, true, 0.4, 0.4, 0}};
    poses.add(0.1 * k, k, one);
  }
  poses.times = true;
  poses.frame_period = 0.1;
  try {
    static_cast<void>(poseRun(poses, "recording", {}));
    FAIL() << "accepted";
  } catch (const ReportError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("found 20000 robots that are seen in 0.01 % of the frames"));
  }
}

TEST(PoseRun, CutsAtAnImpossibleJump) {
  PoseFile poses = recording(1, 20);
  poses.eachFrame([](const PoseFrame& frame, std::span<Pose> robots) {
    if (frame.time > 10) robots[0].x += 0.5;
  });

  const RunRecord dut = poseRun(poses, "recording", abp());

  EXPECT_EQ(dut.results.front().result.segments, 2);
}

TEST(PoseRun, BridgesMissingFrames) {
  const PoseFile whole = recording(1, 20);
  PoseFile poses;
  poses.headings = whole.headings;
  poses.frame_period = whole.frame_period;
  whole.eachFrame([&](const PoseFrame& frame, std::span<const Pose> robots) {
    if (frame.frame % 10 != 5) poses.add(frame.time, frame.frame, robots);
  });

  const RunRecord dut = poseRun(poses, "recording", abp());

  EXPECT_EQ(dut.results.front().result.segments, 1);
}

TEST(PoseRun, SaysThatRobotsBeyondTheLimitsAreLeftOut) {
  PoseFile crowd;
  crowd.headings = true;
  crowd.frame_period = kPeriod;
  for (std::int64_t k = 0; k < 40; ++k) {
    const double time = static_cast<double>(k) * kPeriod;
    std::vector<Pose> frame;
    for (int i = 0; i < 1100; ++i) {
      frame.push_back({i + 1, true, 0.2 * (i % 40) + kSpeed * time, 0.2 * (i / 40), 0});
    }
    crowd.add(time, k, frame);
  }
  crowd.rows = 40 * 1100;

  const RunRecord dut = poseRun(crowd, "crowd", {}, {.depth = analysis::Depth::kLive});

  EXPECT_GE(dut.left_out, 40 * 100);
  EXPECT_EQ(dut.crowd_left_out, 40 * 100);
  EXPECT_EQ(dut.crowd_most, 1100);
  EXPECT_THAT(headlines(dut), testing::Contains(HasSubstr("beyond 1000 robots")));
  EXPECT_THAT(headlines(dut), testing::Contains(HasSubstr("of the first 1000 of up to ")));
}

TEST(PoseRun, RejectsAnInvalidProgram) {
  EXPECT_THROW((void)poseRun(recording(1, 1), "recording", {"abb", {}}), ExperimentError);
  EXPECT_THROW((void)poseRun(recording(1, 1), "recording", {"abp", {"v_cm_s=3"}}), ExperimentError);
  EXPECT_THROW((void)poseRun(recording(1, 1), "recording", {"", {"v_cm_s=3"}}), ExperimentError);
  const auto problemOf = [](const PoseProgram& program) -> std::string {
    try {
      static_cast<void>(poseRun(recording(1, 1), "recording", program));
    } catch (const ExperimentError& error) {
      return error.problems().front();
    }
    return "none";
  };
  EXPECT_THAT(problemOf({"zig", {}}),
              testing::StartsWith("--program: found \"zig\", expected one of abp, aoup, bp, "));
  EXPECT_THAT(problemOf({"abp", {"v_cm_s=3", "eta_rad_s=3"}}),
              testing::StartsWith("--set epsilon: found nothing, expected the value"));
}

TEST(AnalyzePoses, WritesSummaryFiguresAndReport) {
  const TemporaryFolder folder;
  {
    std::ofstream file(folder.path() / "poses.csv");
    writeCsv(recording(2, 60), file);
  }

  const AnalyzedRun dut = analyzePoses(folder.path() / "poses.csv", folder.path() / "out",
                                       {.scale = 0.01, .fps = {}}, abp());

  const std::string page = readFile(dut.report);
  EXPECT_THAT(page, HasSubstr("from poses alone"));
  EXPECT_THAT(page, testing::Not(HasSubstr("cut short")));
  EXPECT_THAT(readFile(folder.path() / "out" / "summary.json"), HasSubstr("\"poses\""));
  EXPECT_THAT(readFile(folder.path() / "out" / "msd_abp.svg"), HasSubstr("<svg"));
  ASSERT_FALSE(dut.headline.empty());
  EXPECT_THAT(dut.headline.front(), HasSubstr("abp: "));
}

}  // namespace
}  // namespace lab::report
