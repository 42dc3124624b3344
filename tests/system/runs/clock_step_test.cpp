// A live run during which the wall clock of the machine is set.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <lab/experiment_event_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <set>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/codec.hpp"
#include "common/bus/log_file.hpp"
#include "common/loop/wall_clock.hpp"
#include "tests/support/lab_process.hpp"

namespace lab::system_test::clock_step_test {
namespace {

using std::chrono::seconds;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

/// The wall clock of processes that are started with environment().
class SteppedClock {
 public:
  explicit SteppedClock(fs::path file) : file_(std::move(file)) { step(0); }

  /// In place: the processes have mapped the file.
  void step(std::int64_t by_s) const {
    const std::int64_t us = by_s * 1'000'000;
    std::fstream stream(file_, fs::exists(file_) ? std::ios::in | std::ios::out : std::ios::out);
    stream.write(reinterpret_cast<const char*>(&us), sizeof us);
  }

  [[nodiscard]] std::string environment() const {
    return "export LD_PRELOAD=" LAB_CLOCK_SHIM " LAB_CLOCK_FILE=" + file_.string() +
           " ASAN_OPTIONS=$ASAN_OPTIONS:verify_asan_link_order=0; ";
  }

 private:
  fs::path file_;
};

class ClockStep : public testing::TestWithParam<int> {};

TEST_P(ClockStep, WithARestartedSimulatorDoesNotEndTheRun) {
  const TemporaryFolder folder;
  setenv("XDG_RUNTIME_DIR", folder.path().c_str(), 1);
  const SteppedClock clock(folder.path() / "clock");
  const fs::path runs = folder.path() / "runs";
  Background lab(clock.environment() + "exec lab run " + experiment("abp").string() +
                 " --no-web --set duration_s=12 --out " + runs.string());
  ASSERT_TRUE(waitUntil([&] { return lab.output().find("light step 1") != std::string::npos; },
                        seconds(20)))
      << lab.output();

  clock.step(GetParam());
  const std::string date = run(clock.environment() + "date +%s").output;
  const std::int64_t now_s = wallClock() / 1'000'000;
  ASSERT_NEAR(std::stod(date), double(now_s + GetParam()), 60)
      << "the clock of programs is not set";
  const std::vector<pid_t> simulators = childrenWith(lab.pid(), "/sim_svc");
  ASSERT_EQ(simulators.size(), 1U);
  kill(simulators.front(), SIGKILL);

  const Finished ended = lab.wait(seconds(90));
  EXPECT_EQ(ended.exit_code, 0) << ended.output;
  EXPECT_THAT(ended.output, HasSubstr("sim_svc died (killed by signal 9) and was restarted"));
  EXPECT_THAT(ended.output, Not(HasSubstr("two owners")));

  // All frames have the time of the run, in spite of the restart.
  std::set<std::int64_t> instances;
  std::vector<std::int64_t> times;
  std::string end;
  static_cast<void>(readLog({onlyRun(runs) / "log.lcmlog"}, [&](const Packet& packet) {
    experiment_event_t event{};
    if (packet.channel == channels::kExperimentEvent && decode(packet.data, event) &&
        event.kind == experiment_event_t::END) {
      end = event.text;
    }
    tracked_frame_t frame{};
    if (packet.channel != channels::kTrackedFrame || !decode(packet.data, frame)) return;
    instances.insert(frame.instance);
    times.push_back(frame.utime);
  }));
  EXPECT_THAT(end, HasSubstr("the script is over"));
  EXPECT_EQ(instances.size(), 2U);
  EXPECT_TRUE(std::ranges::is_sorted(times));
  ASSERT_FALSE(times.empty());
  EXPECT_LT(times.back() - times.front(), 60'000'000);
  EXPECT_EQ(run("lab analyze --no-figures " + onlyRun(runs).string()).exit_code, 0);
}

INSTANTIATE_TEST_SUITE_P(Each, ClockStep, testing::Values(-3600, 3600), [](const auto& parameter) {
  return parameter.param < 0 ? "Back" : "Ahead";
});

}  // namespace
}  // namespace lab::system_test::clock_step_test
