#include "runner/hosts/agent_lock.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <future>
#include <memory>

#include "runner/command_line/exit_code.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/wait_until.hpp"

namespace lab::runner::agent_lock_test {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

std::atomic<int> asked_to_end = 0;

/// All agents run in this process, so an agent that waits for another sends SIGTERM to the test.
class AgentLockTest : public testing::Test {
 protected:
  AgentLockTest() {
    fs::create_directories(folder / "active-lab");
    setenv("XDG_RUNTIME_DIR", folder.path().c_str(), 1);
    asked_to_end = 0;
    signal(SIGTERM, [](int) { ++asked_to_end; });
  }
  ~AgentLockTest() override { signal(SIGTERM, SIG_DFL); }

  static std::future<std::unique_ptr<AgentLock>> another() {
    return std::async(std::launch::async, [] { return std::make_unique<AgentLock>("run-bench"); });
  }

  TemporaryFolder folder;
};

TEST_F(AgentLockTest, EndsThePreviousAgentAndWaitsForIt) {
  auto first = another().get();
  auto second = another();
  EXPECT_EQ(second.wait_for(milliseconds(200)), std::future_status::timeout);
  EXPECT_GT(asked_to_end, 0);
  first.reset();
  EXPECT_NE(second.get(), nullptr);
}

/// A file of another user would name the process that is ended.
TEST_F(AgentLockTest, FollowsNoLinks) {
  fs::create_symlink(folder / "elsewhere", folder / "active-lab/agent-run-bench.lock");
  EXPECT_THROW(another().get(), UserError);
  EXPECT_FALSE(fs::exists(folder / "elsewhere"));

  fs::rename(folder / "active-lab", folder / "moved");
  fs::create_directory_symlink(folder / "moved", folder / "active-lab");
  EXPECT_THROW(another().get(), UserError);
}

TEST_F(AgentLockTest, AThirdAgentWaitsForTheSecondThatHasWaitedForTheFirst) {
  auto first = another().get();
  auto second = another();
  ASSERT_TRUE(waitUntil([] { return asked_to_end > 0; }, std::chrono::seconds(20)))
      << "the second agent does not wait for the lock of the first";
  first.reset();
  auto active = second.get();

  auto third = another();

  EXPECT_EQ(third.wait_for(milliseconds(200)), std::future_status::timeout);
  active.reset();
  EXPECT_NE(third.get(), nullptr);
}

}  // namespace
}  // namespace lab::runner::agent_lock_test
