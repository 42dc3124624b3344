#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <lab/analysis_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/bus/message_header.hpp"
#include "tests/support/lab_process.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class VirtualRun : public testing::Test {
 protected:
  /// Runs an experiment in virtual time and returns its folder.
  fs::path labRun(const std::string& name, const std::string& more) {
    const fs::path out = folder_.path() / std::to_string(++runs_);
    const Finished lab = run("lab run " + experiment(name).string() + " --virtual-time --out " +
                             out.string() + " " + more);
    EXPECT_EQ(lab.exit_code, 0) << lab.output;
    return onlyRun(out);
  }

 private:
  TemporaryFolder folder_;
  int runs_ = 0;
};

TEST_F(VirtualRun, IsBitIdenticalForTheSameSeed) {
  const fs::path a = labRun("swarm", "--set duration_s=20");
  const fs::path b = labRun("swarm", "--set duration_s=20");
  for (const char* file : {"log.lcmlog", "summary.json", "trajectories.csv", "report.html"}) {
    EXPECT_TRUE(readFile(a / file) == readFile(b / file)) << file;
  }
  const fs::path c = labRun("swarm", "--set duration_s=20 --seed 2");
  EXPECT_FALSE(readFile(a / "log.lcmlog") == readFile(c / "log.lcmlog"));
}

TEST_F(VirtualRun, OfMoreRobotsThanALiveLabHasIsBitIdenticalWithAnyNumberOfThreads) {
  const std::string many =
      "--no-report --set robots[0].count=600 --set arena.width_cm=300 --set arena.height_cm=300 "
      "--set reversal.on='\"never\"' --set camera.fps=10 --set robot.status_rate_hz=10 "
      "--set duration_s=4 --threads ";
  const std::string one = readFile(labRun("abp", many + "1") / "log.lcmlog");
  EXPECT_GT(one.size(), 1'000'000U);
  for (const char* threads : {"2", "8"}) {
    EXPECT_TRUE(readFile(labRun("abp", many + threads) / "log.lcmlog") == one) << threads;
  }
}

/// The number of different times of the results of all robots in the log.
std::size_t resultTimes(const fs::path& directory) {
  std::set<std::int64_t> times;
  readLog({directory / "log.lcmlog"}, [&times](const Packet& packet) {
    analysis_t analysis{};
    if (packet.channel != channels::kAnalysis || !decode(packet.data, analysis)) return;
    if (analysis.robot_id == analysis_t::POOL) times.insert(analysis.utime);
  });
  return times.size();
}

TEST_F(VirtualRun, ComputesResultsAsOftenAsTheyAreRead) {
  const std::string run = "--no-report --set duration_s=120 ";
  // Each second for 10 s, then at each tenth of the time so far: 10 + 10 ln(100 / 10), then each 10
  // s.
  const std::size_t unread = resultTimes(labRun("abp", run));
  EXPECT_GE(unread, 25U);
  EXPECT_LE(unread, 40U);
  const std::string rule =
      R"('stop_when=[{estimate="v", program="abp", relative_error_percent=50, at_least_s=80}]')";
  const std::size_t waited = resultTimes(labRun("abp", run + "--set " + rule));
  EXPECT_GE(waited, 75U);
  EXPECT_LE(waited, 85U);
  const std::size_t asked = resultTimes(labRun("abp", run + "--set analysis.results_every_s=30"));
  EXPECT_GE(asked, 4U);
  EXPECT_LE(asked, 5U);
}

TEST_F(VirtualRun, IsTheOnlyRunOfMoreRobotsThanALiveLabHas) {
  const Finished lab = run("lab run " + experiment("abp").string() +
                           " --no-report --set robots[0].count=300 --set arena.width_cm=300");
  EXPECT_EQ(lab.exit_code, 2);
  EXPECT_THAT(lab.output,
              HasSubstr("robots: found 300 robots, a lab in real time has at most 250"));
}

TEST_F(VirtualRun, AnalyzeRebuildsTheSameBytesFromTheLogAlone) {
  const fs::path directory = labRun("light_switching", "");
  const std::vector<std::string> results{"summary.json", "report.html", "trajectories.csv"};
  std::map<std::string, std::string> before;
  for (const std::string& file : results) {
    before[file] = readFile(directory / file);
    fs::remove(directory / file);
  }
  const Finished again = run("lab analyze " + directory.string());
  ASSERT_EQ(again.exit_code, 0) << again.output;
  for (const std::string& file : results) {
    EXPECT_TRUE(readFile(directory / file) == before[file]) << file;
  }
}

TEST_F(VirtualRun, AnalyzeFreesTimesOfTheProgramsThatRan) {
  const fs::path directory = labRun("abp", "--no-report --set duration_s=300 ");
  const std::string analyze = "lab analyze " + directory.string() + " --no-figures --free ";
  const Finished freed = run(analyze + "epsilon");
  ASSERT_EQ(freed.exit_code, 0) << freed.output;
  const auto summary = readJson(directory / "summary.json");
  const auto& fit = summary.at("programs").at(0).at("pool").at("fit");
  EXPECT_NEAR(fit.at("parameters").at("epsilon_s").at("value").get<double>(), 0.5, 0.05);

  const Finished other = run(analyze + "tau_t");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.output, HasSubstr("found --free tau_t, expected epsilon"));
}

TEST_F(VirtualRun, TheDefaultExperimentEndsWithAVerdictForEveryProgram) {
  const auto summary = readJson(labRun("light_switching", "") / "summary.json");

  ASSERT_EQ(summary.at("programs").size(), 3U);
  for (const auto& program : summary.at("programs")) {
    EXPECT_EQ(program.at("pool").at("verdict"), "agrees") << program.at("name");
    EXPECT_EQ(program.at("pool").at("robots"), 6) << program.at("name");
  }
}

/// The wheel speeds of the program of robot 1 in every status report.
std::vector<std::pair<double, double>> drawsOfRobotOne(const fs::path& directory) {
  std::vector<std::pair<double, double>> draws;
  readLog({directory / "log.lcmlog"}, [&draws](const Packet& packet) {
    robot_status_t status{};
    if (packet.channel != channels::kRobotStatus || !decode(packet.data, status)) return;
    for (const robot_state_t& robot : status.robots) {
      if (robot.robot_id == 1) draws.emplace_back(robot.program_left, robot.program_right);
    }
  });
  return draws;
}

TEST_F(VirtualRun, AddingRobotsDoesNotChangeTheDrawsOfTheFirst) {
  const std::string alone = "--no-report --set reversal.on=never --set duration_s=60 ";
  const auto draws = drawsOfRobotOne(labRun("swarm", alone + "--set robots[0].count=1"));
  const auto among_others = drawsOfRobotOne(labRun("swarm", alone + "--set robots[0].count=12"));
  ASSERT_GT(draws.size(), 2900U);
  EXPECT_TRUE(draws == among_others);
}

TEST_F(VirtualRun, EverySwitchOfTheLightReachesAllRobotsWithinASensorPeriodAndAFrame) {
  const fs::path directory = labRun("light_switching", "--set duration_s=1800");
  const auto summary = readJson(directory / "summary.json");
  constexpr double kSensorPeriod_ms = 20 * 1.02;  // the robot's clock may be 2 % slow
  constexpr double kFrame_ms = 1000.0 / 60;
  const auto& steps = summary.at("steps");
  EXPECT_GE(steps.size(), 60U);
  for (const auto& step : steps) {
    EXPECT_EQ(step.at("robots_acted"), 6) << step;
    const double presented_s = step.at("presented_s");
    EXPECT_LE((presented_s - step.at("commanded_s").get<double>()) * 1000, kFrame_ms + 0.01)
        << step;
    const double latency_ms = (step.at("last_acted_s").get<double>() - presented_s) * 1000;
    EXPECT_GE(latency_ms, 0) << step;
    EXPECT_LE(latency_ms, kSensorPeriod_ms + kFrame_ms) << step;
  }
}

TEST_F(VirtualRun, LostMessagesAreCountedExactly) {
  const fs::path directory =
      labRun("light_switching", "--set duration_s=300 --set faults.message_loss=0.05");
  // Frames are numbered by the camera, so the log shows how many there were.
  std::int64_t frames = 0;
  std::int64_t last_frame = -1;
  std::map<std::string, std::int64_t> logged;
  readLog({directory / "log.lcmlog"}, [&](const Packet& packet) {
    const auto header = peekHeader(packet.data);
    ASSERT_TRUE(header.has_value());
    ++logged[std::string(packet.channel) + " " + std::string(header->sender)];
    tracked_frame_t frame{};
    if (packet.channel != channels::kTrackedFrame || !decode(packet.data, frame)) return;
    ++frames;
    last_frame = std::max(last_frame, frame.frame);
  });
  const auto summary = readJson(directory / "summary.json");
  int compared = 0;
  for (const auto& stream : summary.at("losses").at("log")) {
    const double lost = stream.at("lost");
    const double received = stream.at("received");
    const std::string name =
        stream.at("channel").get<std::string>() + " " + stream.at("sender").get<std::string>();
    EXPECT_FALSE(stream.at("lost_is_at_least").get<bool>()) << name;
    EXPECT_EQ(received, static_cast<double>(logged.at(name))) << name;
    const double expected = 0.05 * (lost + received);
    EXPECT_LT(std::abs(lost - expected), 4 * std::sqrt(expected) + 1) << name << ": not 5 %";
    if (stream.at("channel") == "TRACKED_FRAME") {
      ++compared;
      // The last frames may be lost too.
      EXPECT_NEAR(lost, static_cast<double>(last_frame + 1 - frames), 3);
    }
  }
  EXPECT_EQ(compared, 1);
}

TEST_F(VirtualRun, LostMessagesDoNotBiasTheEstimates) {
  const fs::path directory = labRun("abp", "--set faults.message_loss=0.05");
  const auto summary = readJson(directory / "summary.json");
  const auto& pool = summary.at("programs").at(0).at("pool");
  EXPECT_EQ(pool.at("verdict"), "agrees") << pool.at("max_z");
  EXPECT_GT(pool.at("judged_lags"), 50);
  for (const auto& [name, estimate] : pool.at("estimates").items()) {
    if (estimate.at("theory").is_null() || estimate.at("value").is_null()) continue;
    const double deviation =
        estimate.at("value").get<double>() - estimate.at("theory").get<double>();
    EXPECT_LT(std::abs(deviation), 4 * estimate.at("standard_error").get<double>()) << name;
  }
}

TEST_F(VirtualRun, ClosesTheRunMarkedWhenTheLogCannotGrow) {
  const TemporaryFolder folder;
  // Files are limited to 2 MB, which acts like a full disk.
  const Finished lab =
      run("trap '' XFSZ; ulimit -f 2000; exec lab run " + experiment("light_switching").string() +
          " --virtual-time --out " + folder.path().string());
  EXPECT_EQ(lab.exit_code, 3) << lab.output;
  EXPECT_THAT(lab.output, HasSubstr("fault    cannot go on writing"));
  EXPECT_TRUE(fs::exists(onlyRun(folder.path()) / "report.html"));
  EXPECT_TRUE(fs::exists(onlyRun(folder.path()) / "provenance.json"));
}

TEST_F(VirtualRun, MakesItsReportInAFolderNamedLikeAnOption) {
  const TemporaryFolder folder;
  const Finished lab =
      run("cd " + folder.path().string() + " && exec lab run " + experiment("abp").string() +
          " --virtual-time --out=--set --set duration_s=5");
  EXPECT_EQ(lab.exit_code, 0) << lab.output;
  EXPECT_TRUE(fs::exists(onlyRun(folder.path() / "--set") / "report.html"));
}

TEST_F(VirtualRun, ReportsAnInvalidExperimentAndStartsNothing) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "runs";
  const Finished lab = run("lab run " + experiment("abp").string() + " --virtual-time --out " +
                           out.string() + " --set programs.abp.eta_rad_s=9");
  EXPECT_EQ(lab.exit_code, 2);
  EXPECT_THAT(lab.output, HasSubstr("found a wheel speed of 36.75 cm/s"));
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace lab::system_test
