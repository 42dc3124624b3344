/// Live runs in which something fails or that the user ends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <lab/experiment_event_t.hpp>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/codec.hpp"
#include "common/bus/log_file.hpp"
#include "tests/support/lab_process.hpp"

namespace lab::system_test::broken_run_test {
namespace {

using std::chrono::seconds;
using testing::Contains;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
namespace fs = std::filesystem;

class BrokenRun : public testing::Test {
 protected:
  BrokenRun() { setenv("XDG_RUNTIME_DIR", folder.path().c_str(), 1); }

  [[nodiscard]] std::string labRun(double duration_s, const std::string& more = "") const {
    return "exec lab run " + experiment("abp").string() + " --no-web --out " + runs().string() +
           " --set duration_s=" + std::to_string(duration_s) + " " + more;
  }
  [[nodiscard]] fs::path runs() const { return folder.path() / "runs"; }
  [[nodiscard]] fs::path theRun() const { return onlyRun(runs()); }

  static bool waitUntilRunning(Background& lab) {
    return waitUntil([&] { return lab.output().find("running ") != std::string::npos; },
                     seconds(60));
  }

  /// The process id of a program of the lab; -1 if there is not exactly one.
  static pid_t processOf(const Background& lab, const std::string& name) {
    const std::vector<pid_t> found = childrenWith(lab.pid(), "/" + name);
    return found.size() == 1 ? found.front() : -1;
  }

  /// The texts of the events of one kind in the logs of the run.
  [[nodiscard]] std::vector<std::string> recorded(std::int8_t kind) const {
    std::vector<fs::path> logs;
    for (const auto& entry : fs::directory_iterator(theRun())) {
      if (entry.path().filename().string().starts_with("log.lcmlog")) logs.push_back(entry.path());
    }
    std::sort(logs.begin(), logs.end());
    std::vector<std::string> texts;
    readLog(logs, [&texts, kind](const Packet& packet) {
      experiment_event_t event{};
      if (packet.channel != channels::kExperimentEvent || !decode(packet.data, event)) return;
      if (event.kind == kind) texts.push_back(event.text);
    });
    return texts;
  }

  static void pass(seconds time) {
    waitUntil([] { return false; }, time);
  }

  TemporaryFolder folder;
};

class EndedByTheUser : public BrokenRun, public testing::WithParamInterface<int> {};

TEST_P(EndedByTheUser, ReportsTheElapsedTime) {
  Background lab(labRun(600));
  ASSERT_TRUE(waitUntilRunning(lab)) << lab.output();
  pass(seconds(2));
  lab.signal(GetParam());

  const Finished ended = lab.wait(seconds(60));

  EXPECT_EQ(ended.exit_code, 0) << ended.output;
  EXPECT_THAT(ended.output, ContainsRegex("\nended by the user after [1-9] s of 600 s\n"));
}

TEST_P(EndedByTheUser, ReportsTheElapsedTimeInVirtualTime) {
  Background lab(labRun(100'000, "--virtual-time"));
  ASSERT_TRUE(waitUntilRunning(lab)) << lab.output();
  pass(seconds(1));
  lab.signal(GetParam());

  const Finished ended = lab.wait(seconds(60));

  EXPECT_EQ(ended.exit_code, 0) << ended.output;
  EXPECT_THAT(ended.output, ContainsRegex("\nended by the user after [1-9][0-9]* s of 100000 s\n"));
}

INSTANTIATE_TEST_SUITE_P(Each, EndedByTheUser, testing::Values(SIGINT, SIGTERM),
                         [](const auto& parameter) {
                           return parameter.param == SIGINT ? "CtrlC" : "Sigterm";
                         });

/// The runner is halted while its services become ready, so that it receives their last READY and
/// the SIGINT together.
TEST_F(BrokenRun, EndsOnSigintTogetherWithTheLastReady) {
  Background lab(labRun(600));
  ASSERT_TRUE(waitUntil([&] { return processOf(lab, "sim_svc") > 0; }, seconds(60)));
  lab.signal(SIGSTOP);
  pass(seconds(2));

  lab.signal(SIGINT);
  lab.signal(SIGCONT);

  const Finished ended = lab.wait(seconds(60));
  EXPECT_GE(ended.exit_code, 0) << ended.output;
  EXPECT_THAT(ended.output, HasSubstr("ended by the user"));
  EXPECT_THAT(processesWith(runs().string()), IsEmpty());
}

/// The disk fills so quickly that the run cannot be closed: nothing can be written any more.
TEST_F(BrokenRun, ReportsTheReasonWhenTheDiskFillsAtOnce) {
  fs::create_directories(runs());
  const std::string disk = runs().string();
  const fs::path kept = folder.path() / "kept";
  const Finished lab =
      run("exec unshare -Urm bash -c 'mount -t tmpfs -o size=170m none " + disk + " && { " +
          whenLogHasData(disk) + "dd if=/dev/zero of=" + disk + "/ballast bs=1M status=none; } & " +
          whenMounted(disk) + "(" + labRun(60) + "); code=$?; cp -r " + disk + "/abp-* " +
          kept.string() + "; exit $code'");

  EXPECT_EQ(lab.exit_code, 3) << lab.output;
  EXPECT_THAT(lab.output, HasSubstr("fault    the disk is full"));
  EXPECT_THAT(lab.output, ContainsRegex("no report: .*(disk is full|is the disk full)"));
  EXPECT_LT(lab.output.find("fault    the disk is full"), lab.output.find("no report: "))
      << "the cause must be printed first";
  EXPECT_TRUE(fs::exists(kept / "log.lcmlog")) << lab.output;
  const fs::path provenance = kept / "provenance.json";
  EXPECT_TRUE(!fs::exists(provenance) || fs::file_size(provenance) > 0) << lab.output;
  EXPECT_FALSE(fs::exists(kept / "provenance.json.part"));
}

TEST_F(BrokenRun, ClosesTheRunWhenItsFolderIsDeleted) {
  Background lab(labRun(600));
  ASSERT_TRUE(waitUntilRunning(lab)) << lab.output();
  fs::remove_all(theRun());

  const Finished ended = lab.wait(seconds(60));

  EXPECT_EQ(ended.exit_code, 3) << ended.output;
  EXPECT_THAT(ended.output, HasSubstr("fault    the run's folder"));
  EXPECT_THAT(processesWith(runs().string()), IsEmpty());
}

TEST_F(BrokenRun, ClosesTheRunWhenItsLogIsDeleted) {
  Background lab(labRun(600));
  ASSERT_TRUE(waitUntilRunning(lab)) << lab.output();
  fs::remove(theRun() / "log.lcmlog");

  const Finished ended = lab.wait(seconds(60));

  EXPECT_EQ(ended.exit_code, 3) << ended.output;
  EXPECT_THAT(ended.output, HasSubstr("log.lcmlog is gone"));
}

TEST_F(BrokenRun, RecordsTheDeathOfTheLoggerInTheNextLog) {
  Background lab(labRun(8));
  ASSERT_TRUE(waitUntilRunning(lab)) << lab.output();
  const pid_t logger = processOf(lab, "recorder");
  ASSERT_GT(logger, 0);
  kill(logger, SIGKILL);

  const Finished ended = lab.wait(seconds(60));

  EXPECT_EQ(ended.exit_code, 0) << ended.output;
  const std::string fault = "recorder died (killed by signal 9) and was restarted";
  EXPECT_THAT(ended.output, HasSubstr("fault    " + fault));
  EXPECT_THAT(recorded(experiment_event_t::FAULT), Contains(fault));
}

TEST_F(BrokenRun, ReportsAHangingServiceAndItsReturn) {
  Background lab(labRun(14));
  ASSERT_TRUE(waitUntilRunning(lab)) << lab.output();
  const pid_t simulator = processOf(lab, "sim_svc");
  ASSERT_GT(simulator, 0);
  kill(simulator, SIGSTOP);
  pass(seconds(5));
  kill(simulator, SIGCONT);

  const Finished ended = lab.wait(seconds(60));

  EXPECT_EQ(ended.exit_code, 0) << ended.output;
  const std::string fault = "sim_svc has sent no heartbeat for 3 s";
  EXPECT_THAT(ended.output, HasSubstr("fault    " + fault));
  EXPECT_THAT(recorded(experiment_event_t::FAULT), Contains(fault));
  EXPECT_THAT(recorded(experiment_event_t::MARK),
              Contains(HasSubstr("sim_svc sends heartbeats again")));
}

TEST_F(BrokenRun, KillsAServiceThatHangsAtTheEnd) {
  Background lab(labRun(8));
  ASSERT_TRUE(waitUntilRunning(lab)) << lab.output();
  const pid_t analyzer = processOf(lab, "analyzer");
  ASSERT_GT(analyzer, 0);
  kill(analyzer, SIGSTOP);

  const Finished ended = lab.wait(seconds(600));

  EXPECT_THAT(ended.output, HasSubstr("fault    analyzer has sent no heartbeat for 3 s"));
  const std::string fault = "analyzer did not end on request and was killed after 10 s";
  EXPECT_THAT(ended.output, HasSubstr("fault    " + fault));
  EXPECT_THAT(recorded(experiment_event_t::FAULT), Contains(fault));
}

/// The run needs robots, light and tracker; the log can be analyzed later.
TEST_F(BrokenRun, GoesOnWithoutAnAnalyzerThatKeepsDying) {
  Background lab(labRun(20));
  ASSERT_TRUE(waitUntilRunning(lab)) << lab.output();
  pid_t killed = -1;
  // Restarted at once, then after 0.5, 1, 2 and 4 s.
  for (int deaths = 0; deaths < 6; ++deaths) {
    pid_t analyzer = -1;
    ASSERT_TRUE(waitUntil(
        [&] {
          analyzer = processOf(lab, "analyzer");
          return analyzer > 0 && analyzer != killed;
        },
        seconds(60)))
        << "death " << deaths << "\n"
        << lab.output();
    kill(analyzer, SIGKILL);
    killed = analyzer;
  }

  const Finished ended = lab.wait(seconds(60));

  EXPECT_EQ(ended.exit_code, 0) << ended.output;
  EXPECT_THAT(ended.output,
              HasSubstr("fault    analyzer died (killed by signal 9) and is not started again: "
                        "it died too often (6 times in 60 s); the run continues"));
  EXPECT_THAT(recorded(experiment_event_t::END), Contains("the script is over"));
  EXPECT_THAT(recorded(experiment_event_t::FAULT),
              Contains("analyzer died (killed by signal 9) and is restarted in 0.5 s"));
}

/// This process becomes the parent of what the runner leaves behind, in the same session: the
/// kernel then does not wake a stopped orphan by itself.
TEST_F(BrokenRun, AStoppedServiceDoesNotOutliveAKilledRunner) {
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  Background lab(labRun(600));
  ASSERT_TRUE(waitUntilRunning(lab)) << lab.output();
  const pid_t simulator = processOf(lab, "sim_svc");
  ASSERT_GT(simulator, 0);
  kill(simulator, SIGSTOP);
  lab.signal(SIGKILL);

  EXPECT_TRUE(waitUntil([&] { return processesWith(runs().string()).empty(); }, seconds(60)));
  prctl(PR_SET_CHILD_SUBREAPER, 0);
}

TEST_F(BrokenRun, ReportsAHangingLogger) {
  Background lab(labRun(8));
  ASSERT_TRUE(waitUntilRunning(lab)) << lab.output();
  const pid_t logger = processOf(lab, "recorder");
  ASSERT_GT(logger, 0);
  kill(logger, SIGSTOP);

  const Finished ended = lab.wait(seconds(60));

  EXPECT_THAT(ended.output, HasSubstr("fault    recorder has written nothing for 3 s"));
  EXPECT_THAT(ended.output, HasSubstr("fault    recorder did not end on request"));
}

/// After SIGCONT the runner receives the heartbeats again.
TEST_F(BrokenRun, AHaltedRunnerReportsNoSilentServices) {
  Background lab(labRun(12));
  ASSERT_TRUE(waitUntilRunning(lab)) << lab.output();
  lab.signal(SIGSTOP);
  pass(seconds(6));
  lab.signal(SIGCONT);

  const Finished ended = lab.wait(seconds(60));

  EXPECT_EQ(ended.exit_code, 0) << ended.output;
  EXPECT_THAT(ended.output, Not(HasSubstr("heartbeat")));
  EXPECT_THAT(ended.output, Not(HasSubstr("written nothing")));
}

}  // namespace
}  // namespace lab::system_test::broken_run_test
