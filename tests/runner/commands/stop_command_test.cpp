#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <lab/robot_status_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <lab/service_status_t.hpp>
#include <string>
#include <thread>

#include "common/bus/channels.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/service/node.hpp"
#include "runner/commands/commands.hpp"
#include "runner/runs/lab_registry.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::runner::stop_command_test {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kStatusPeriod_us = 50'000;

/// A lab with one robot that obeys stops.
class ObedientLab {
 public:
  explicit ObedientLab(std::string url) : thread_([this, url = std::move(url)] { live(url); }) {}
  ~ObedientLab() {
    ended_ = true;
    thread_.join();
  }
  ObedientLab(const ObedientLab&) = delete;
  ObedientLab& operator=(const ObedientLab&) = delete;

  /// Whether `lab stop` has sent its ENDED status with its last counts.
  [[nodiscard]] bool receivedLastCounts() const { return last_counts_; }

  /// When the robot received the stop [us since 1970]; 0 if not yet.
  [[nodiscard]] std::int64_t stopUtime() const { return stop_utime_; }

 private:
  void live(const std::string& url) {
    AsioLoop loop;
    LcmBus bus(url);
    Node node(bus, loop, {"sim_svc", 0, loop.now()});
    robot_state_t robot{};
    robot.robot_id = 1;
    node.subscribe<robot_stop_t>(channels::kRobotStop, [&](const robot_stop_t& stop) {
      robot.stop_seq = stop.seq;
      robot.flags = stop.clear == 0 ? robot_state_t::FLAG_STOPPED : 0;
      if (stop_utime_ == 0) stop_utime_ = loop.now();
    });
    node.subscribe<service_status_t>(channels::kServiceStatus, [&](const service_status_t& status) {
      if (status.sender == "lab_stop" && status.state == service_status_t::ENDED) {
        last_counts_ = true;
      }
    });
    loop.onReadable(bus.fileDescriptor(), [&] { bus.drain(); });
    loop.every(kStatusPeriod_us, loop.now(), [&] {
      robot_status_t status{};
      robot.utime = loop.now();
      status.num_robots = 1;
      status.robots = {robot};
      node.publish(channels::kRobotStatus, status);
      if (ended_) loop.stop();
    });
    loop.run();
  }

  std::atomic<bool> ended_ = false;
  std::atomic<std::int64_t> stop_utime_ = 0;
  std::atomic<bool> last_counts_ = false;
  std::thread thread_;
};

class StopCommand : public testing::Test {
 protected:
  StopCommand() { setenv("XDG_RUNTIME_DIR", folder.path().c_str(), 1); }

  /// Runs `lab stop` and captures its output.
  ExitCode stopAll() {
    testing::internal::CaptureStdout();
    const ExitCode code = stop({});
    std::fflush(stdout);
    output = testing::internal::GetCapturedStdout();
    return code;
  }

  TemporaryFolder folder;
  std::string output;
};

TEST_F(StopCommand, ASilentLabDoesNotDelayTheOthers) {
  constexpr std::int64_t kAtOnce_us =
      1'000'000;  // sequentially it would take 5 s for each silent lab
  const Registration mute({"mute", lcmUrl(23601), getpid(), "", false});
  const Registration good({"good", lcmUrl(23602), getppid(), "", false});
  const Registration deaf({"deaf", lcmUrl(23603), 1, "", false});
  const ObedientLab lab(lcmUrl(23602));

  const std::int64_t begun = AsioLoop().now();
  const ExitCode code = stopAll();
  const std::int64_t took = AsioLoop().now() - begun;

  EXPECT_EQ(code, kFailed);
  EXPECT_THAT(output, HasSubstr("good: stopped, confirmed by 1 robot"));
  EXPECT_THAT(output, HasSubstr("mute: NOT confirmed: no robot answers"));
  EXPECT_THAT(output, HasSubstr("deaf: NOT confirmed: no robot answers"));
  EXPECT_LT(lab.stopUtime() - begun, kAtOnce_us);
  EXPECT_TRUE(lab.receivedLastCounts());
  EXPECT_LT(took, 9'000'000);
}

TEST_F(StopCommand, ABusThatCannotBeOpenedDoesNotPreventOtherStops) {
  const Registration broken({"broken", "nonsense://", getpid(), "", false});
  const Registration good({"good", lcmUrl(23602), getppid(), "", false});
  const Registration worse({"worse", "nonsense://", 1, "", false});
  const ObedientLab lab(lcmUrl(23602));

  EXPECT_EQ(stopAll(), kFailed);

  EXPECT_THAT(output, HasSubstr("good: stopped, confirmed by 1 robot"));
  EXPECT_THAT(output, HasSubstr("broken: NOT stopped, the LCM bus nonsense:// cannot be opened"));
  EXPECT_THAT(output, HasSubstr("worse: NOT stopped"));
}

}  // namespace
}  // namespace lab::runner::stop_command_test
