#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <lab/robot_status_t.hpp>
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

using std::chrono::seconds;
using testing::HasSubstr;
namespace fs = std::filesystem;

/// Short live runs of the light-switching experiment with steps of 1.5 s.
class LiveRun : public testing::Test {
 protected:
  LiveRun() { setenv("XDG_RUNTIME_DIR", folder.path().c_str(), 1); }

  [[nodiscard]] std::string labRun(double duration_s, const std::string& more = "") const {
    return "exec lab run " + experiment("light_switching").string() + " --out " + runs().string() +
           " --set duration_s=" + std::to_string(duration_s) +
           " --set light.steps[0].hold_s=1.5 --set light.steps[1].hold_s=1.5"
           " --set light.steps[2].hold_s=1.5 " +
           more;
  }
  [[nodiscard]] fs::path runs() const { return folder.path() / "runs"; }
  [[nodiscard]] fs::path theRun() const { return onlyRun(runs()); }

  /// The LCM URL that a running lab has printed.
  static std::string busOf(Background& lab) {
    std::string url;
    waitUntil(
        [&] {
          const std::string output = lab.output();
          const auto at = output.find("udpm://");
          const auto end = output.find('\n', at);
          if (at == std::string::npos || end == std::string::npos) return false;
          url = output.substr(at, end - at);
          return true;
        },
        seconds(60));
    return url;
  }

  static bool waitUntilRunning(Background& lab) {
    return waitUntil([&] { return lab.output().find("running ") != std::string::npos; },
                     seconds(60));
  }

  TemporaryFolder folder;
};

using Numbers = std::set<std::int64_t>;

/// Numbers of the messages by "channel sender".
std::map<std::string, Numbers> streams(const fs::path& log) {
  std::map<std::string, Numbers> all;
  readLog({log}, [&all](const Packet& packet) {
    const auto header = peekHeader(packet.data);
    if (!header) return;
    all[std::string(packet.channel) + " " + std::string(header->sender)].insert(header->seq);
  });
  return all;
}

TEST_F(LiveRun, WritesLogReportAndSummary) {
  const Finished lab = run(labRun(6));
  ASSERT_EQ(lab.exit_code, 0) << lab.output;
  for (const char* file : {"experiment.toml", "log.lcmlog", "summary.json", "report.html",
                           "trajectories.csv", "provenance.json"}) {
    EXPECT_GT(fs::file_size(theRun() / file), 100U) << file;
  }
  EXPECT_THAT(lab.output, HasSubstr((theRun() / "report.html").string()));
  EXPECT_THAT(processesWith(runs().string()), testing::IsEmpty());
}

TEST_F(LiveRun, SaysThatABusIsOpenToTheNetwork) {
  const Finished lab = run(labRun(1, "--no-report --no-web --set network.ttl=1"));
  EXPECT_EQ(lab.exit_code, 0) << lab.output;
  EXPECT_THAT(lab.output,
              HasSubstr("warn     the bus is open to the network (ttl 1): every machine "
                        "there can read it and drive the robots\n"));
}

TEST_F(LiveRun, StopAndLightCommandsReachTheRobots) {
  Background lab(labRun(12));
  ASSERT_TRUE(waitUntilRunning(lab)) << lab.output();
  const Finished light = run("lab light 0.9 --for 3");
  EXPECT_EQ(light.exit_code, 0) << light.output;
  const Finished stop = run("lab stop");
  EXPECT_EQ(stop.exit_code, 0) << stop.output;
  EXPECT_THAT(stop.output, HasSubstr("confirmed by 6 robots"));
  const Finished clear = run("lab stop --clear");
  EXPECT_EQ(clear.exit_code, 0) << clear.output;
  const Finished spy = run("lab spy --seconds 1.5");
  for (const char* channel : {"TRACKED_FRAME", "ROBOT_STATUS", "LIGHT_STATUS", "ANALYSIS"}) {
    EXPECT_THAT(spy.output, HasSubstr(channel));
  }
  EXPECT_EQ(lab.wait(seconds(60)).exit_code, 0) << lab.output();
}

TEST_F(LiveRun, AnotherLoggerReceivesTheSameStreams) {
  Background lab(labRun(6));
  const std::string url = busOf(lab);
  const fs::path other_log = folder.path() / "other_log.lcmlog";
  Background logger("exec lcm-logger -q '--lcm-url=" + url + "' " + other_log.string());
  ASSERT_EQ(lab.wait(seconds(60)).exit_code, 0) << lab.output();
  logger.signal(SIGTERM);
  logger.wait(seconds(60));
  const auto own = streams(theRun() / "log.lcmlog");
  const auto other = streams(other_log);
  EXPECT_GE(own.size(), 11U);
  for (const auto& [stream, recorded] : own) {
    ASSERT_TRUE(other.contains(stream)) << stream;
    const Numbers& received = other.at(stream);
    EXPECT_EQ(*received.rbegin(), *recorded.rbegin()) << stream;
    // One of the two has started earlier.
    const std::int64_t first = std::max(*received.begin(), *recorded.begin());
    const auto messages = [first](const Numbers& numbers) {
      return static_cast<double>(std::distance(numbers.lower_bound(first), numbers.end()));
    };
    EXPECT_NEAR(messages(received), messages(recorded), 0.1 * messages(recorded) + 5) << stream;
  }
}

TEST_F(LiveRun, AStopOutlastsARestartOfTheSimulator) {
  Background lab(labRun(12));
  ASSERT_TRUE(waitUntilRunning(lab)) << lab.output();
  ASSERT_EQ(run("lab stop").exit_code, 0);
  for (const pid_t pid : childrenWith(lab.pid(), "/sim_svc")) kill(pid, SIGKILL);
  const Finished ended = lab.wait(seconds(60));
  ASSERT_EQ(ended.exit_code, 0) << ended.output;
  EXPECT_THAT(ended.output, HasSubstr("sim_svc died"));
  int moving_after_restart = 0;
  std::int64_t first_instance = 0;
  readLog({theRun() / "log.lcmlog"}, [&](const Packet& packet) {
    robot_status_t status{};
    if (packet.channel != channels::kRobotStatus || !decode(packet.data, status)) return;
    if (first_instance == 0) first_instance = status.instance;
    const robot_state_t& robot = status.robots.at(0);
    const bool moves = robot.wheel_left != 0 || robot.wheel_right != 0;
    if (status.instance != first_instance && moves) ++moving_after_restart;
  });
  EXPECT_EQ(moving_after_restart, 0);
}

TEST_F(LiveRun, ClosesTheRunWithItsDataWhenTheNetworkGoesDown) {
  Background lab(
      "unshare -n bash -c 'ip link set lo up; ip route add 224.0.0.0/4 dev lo; "
      "{ " +
      whenLogHasData(runs()) + "ip link set lo down; } & " + labRun(30) + "'");
  const Finished ended = lab.wait(seconds(60));
  EXPECT_EQ(ended.exit_code, 3) << ended.output;
  EXPECT_TRUE(fs::exists(theRun() / "report.html"));
  EXPECT_THAT(processesWith(runs().string()), testing::IsEmpty());
}

TEST_F(LiveRun, ARunEndedByTheUserKeepsItsData) {
  Background lab(labRun(60));
  ASSERT_TRUE(waitUntilRunning(lab)) << lab.output();
  waitUntil([] { return false; }, seconds(2));
  lab.signal(SIGINT);
  const Finished ended = lab.wait(seconds(60));
  EXPECT_EQ(ended.exit_code, 0) << ended.output;
  EXPECT_TRUE(fs::exists(theRun() / "report.html"));
  EXPECT_THAT(processesWith(runs().string()), testing::IsEmpty());
}

TEST_F(LiveRun, ClosesTheRunWhenTheDiskFills) {
  fs::create_directories(runs());
  const std::string disk = runs().string();
  const Finished lab = run("exec unshare -Urm bash -c 'mount -t tmpfs -o size=200m none " + disk +
                           " && { " + whenLogHasData(disk) + "head -c 160M /dev/zero >" + disk +
                           "/ballast; } & " + whenMounted(disk) + labRun(30) + "'");
  EXPECT_EQ(lab.exit_code, 3) << lab.output;
  EXPECT_THAT(lab.output, HasSubstr("the disk is full"));
}

TEST_F(LiveRun, KillingTheRunnerLeavesNoOrphans) {
  Background lab(labRun(60));
  ASSERT_TRUE(waitUntilRunning(lab)) << lab.output();
  ASSERT_GE(processesWith(runs().string()).size(), 4U);
  lab.signal(SIGKILL);
  EXPECT_TRUE(waitUntil([&] { return processesWith(runs().string()).empty(); }, seconds(60)));
}

class KilledService : public LiveRun, public testing::WithParamInterface<const char*> {};

TEST_P(KilledService, IsRestartedAndTheRunIsMarked) {
  const std::string name = GetParam();
  Background lab(labRun(8));
  ASSERT_TRUE(waitUntilRunning(lab)) << lab.output();
  waitUntil([] { return false; }, seconds(2));
  const std::vector<pid_t> processes = childrenWith(lab.pid(), "/" + name);
  ASSERT_FALSE(processes.empty());
  for (const pid_t pid : processes) kill(pid, SIGKILL);
  const Finished ended = lab.wait(seconds(60));
  EXPECT_EQ(ended.exit_code, 0) << ended.output;
  EXPECT_THAT(ended.output, HasSubstr("fault    " + name + " died (killed by signal 9)"));
  EXPECT_THAT(readFile(theRun() / "report.html"), HasSubstr(name + " died"));
  EXPECT_EQ(fs::exists(theRun() / "log.lcmlog.01"), name == "recorder");
  EXPECT_EQ(run("lab analyze " + theRun().string()).exit_code, 0);
}

INSTANTIATE_TEST_SUITE_P(Each, KilledService,
                         testing::Values("sim_svc", "projector_ctl", "analyzer", "recorder"),
                         [](const auto& parameter) {
                           std::string name = parameter.param;
                           std::erase_if(name, [](char c) { return c == '_' || c == '-'; });
                           return name;
                         });

/// Errors that are reported before anything starts.
class Refusal : public LiveRun {
 protected:
  void expectRefused(const Finished& lab, const std::string& text) const {
    EXPECT_EQ(lab.exit_code, 2) << lab.output;
    EXPECT_THAT(lab.output, HasSubstr(text));
    EXPECT_FALSE(fs::exists(runs())) << "a run was started";
    EXPECT_THAT(processesWith(runs().string()), testing::IsEmpty());
  }
};

TEST_F(Refusal, WithoutAMulticastRoute) {
  expectRefused(run("unshare -n bash -c 'ip link set lo up; " + labRun(5) + "'"), "ip route add");
}

TEST_F(LiveRun, NeedsNoStockLogger) {
  // PATH contains gnuplot but not lcm-logger.
  const fs::path programs = folder.path() / "bin";
  fs::create_directories(programs);
  const std::string gnuplot = run("command -v gnuplot").output;
  fs::create_symlink(gnuplot.substr(0, gnuplot.find('\n')), programs / "gnuplot");
  const Finished lab = run("PATH=" + programs.string() + ":" LAB_PROGRAMS "; " + labRun(2));
  EXPECT_EQ(lab.exit_code, 0) << lab.output;
  EXPECT_THAT(readFile(theRun() / "logs/recorder.txt"), HasSubstr("recorded "));
}

TEST_F(Refusal, OnAPortWithTraffic) {
  // A service that was started separately sends a heartbeat every second.
  Background analyzer("exec analyzer --lcm-url 'udpm://239.255.76.67:23457?ttl=0'");
  ASSERT_TRUE(waitUntil(
      [] {
        return run("lab spy --lcm-url 'udpm://239.255.76.67:23457?ttl=0' --seconds 1.5")
                   .output.find("analyzer") != std::string::npos;
      },
      std::chrono::seconds(60)));
  expectRefused(run(labRun(5, "--set network.port=23457")), "SERVICE_STATUS from analyzer");
}

TEST_F(Refusal, OnThePortOfAnotherLab) {
  Background first(labRun(20, "--set network.port=23456"));
  ASSERT_TRUE(waitUntilRunning(first));
  const TemporaryFolder other;
  const Finished second = run("lab run " + experiment("abp").string() + " --out " +
                              (other.path() / "runs").string() + " --set network.port=23456");
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.output, HasSubstr("23456"));
  EXPECT_FALSE(fs::exists(other.path() / "runs"));
  first.signal(SIGINT);
  EXPECT_EQ(first.wait(seconds(60)).exit_code, 0);
}

TEST_F(Refusal, WithTooLittleDisk) {
  expectRefused(run("lab run " + experiment("swarm").string() + " --out " + runs().string() +
                    " --set robots[0].count=100 --set duration_s=860000"),
                "too little disk");
}

}  // namespace
}  // namespace lab::system_test
