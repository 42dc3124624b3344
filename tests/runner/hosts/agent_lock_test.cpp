#include "runner/hosts/agent_lock.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <future>
#include <memory>

namespace lab::runner::only_agent_test {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

std::atomic<int> asked_to_end = 0;

/// All agents are of this process: whoever waits for another sends it a SIGTERM.
class OnlyAgentTest : public testing::Test {
 protected:
  OnlyAgentTest() {
    fs::create_directories(folder / "active-lab");
    setenv("XDG_RUNTIME_DIR", folder.c_str(), 1);
    asked_to_end = 0;
    signal(SIGTERM, [](int) { ++asked_to_end; });
  }
  ~OnlyAgentTest() override {
    signal(SIGTERM, SIG_DFL);
    fs::remove_all(folder);
  }

  static std::future<std::unique_ptr<AgentLock>> another() {
    return std::async(std::launch::async, [] { return std::make_unique<AgentLock>("run-bench"); });
  }

  fs::path folder = fs::path(testing::TempDir()) / ("only_agent_" + std::to_string(getpid()));
};

TEST_F(OnlyAgentTest, EndsTheOneBeforeAndWaitsForIt) {
  auto first = another().get();
  auto second = another();
  EXPECT_EQ(second.wait_for(milliseconds(200)), std::future_status::timeout);
  EXPECT_GT(asked_to_end, 0);
  first.reset();
  EXPECT_NE(second.get(), nullptr);
}

TEST_F(OnlyAgentTest, AThirdDoesNotDriveBesideTheOneThatHasWaited) {
  auto first = another().get();
  auto second = another();
  while (asked_to_end == 0) {  // it waits for the file of the first
    second.wait_for(milliseconds(1));
  }
  first.reset();
  auto driving = second.get();

  auto third = another();

  EXPECT_EQ(third.wait_for(milliseconds(200)), std::future_status::timeout);
  driving.reset();
  EXPECT_NE(third.get(), nullptr);
}

}  // namespace
}  // namespace lab::runner::only_agent_test
