#include "common/process/orphan_guard.hpp"

#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <optional>
#include <thread>

#include "common/process/child_process.hpp"
#include "common/process/pipe.hpp"

namespace lab::orphan_guard_test {
namespace {

using std::chrono::milliseconds;

/// A parent with a guard and a child, as the runner with a service. This process becomes the
/// child's new parent when the parent dies, and is in the same session: in such a case the kernel
/// does not wake stopped orphans by itself.
class OrphanGuardTest : public testing::Test {
 protected:
  OrphanGuardTest() { prctl(PR_SET_CHILD_SUBREAPER, 1); }
  ~OrphanGuardTest() override {
    while (waitpid(-1, nullptr, 0) > 0) {  // guards, and children of the shells
    }
    prctl(PR_SET_CHILD_SUBREAPER, 0);
  }

  void startParent(const char* script, bool guarded) {
    Pipe pipe = makePipe();
    parent_ = fork();
    if (parent_ == 0) {
      std::optional<OrphanGuard> guard;
      if (guarded) guard.emplace();
      Pipe started = makePipe();
      ChildProcess child(
          {.arguments = {"sh", "-c", script}, .output = started.in.get(), .death_signal = SIGTERM});
      if (guard) guard->watch(child.pid());
      char ready = 0;
      while (read(started.out.get(), &ready, 1) < 0) {
      }
      const pid_t pid = child.pid();
      static_cast<void>(!write(pipe.in.get(), &pid, sizeof pid));
      pause();
      _exit(1);
    }
    ASSERT_EQ(read(pipe.out.get(), &child_, sizeof child_), static_cast<ssize_t>(sizeof child_));
  }

  void killParent() const {
    kill(parent_, SIGKILL);
    waitpid(parent_, nullptr, 0);
  }

  /// @return the wait status of the child; -1: it still runs
  [[nodiscard]] int waitForChild(milliseconds timeout) const {
    int status = 0;
    for (milliseconds waited{0}; waited < timeout; waited += milliseconds(10)) {
      if (waitpid(child_, &status, WNOHANG) == child_) return status;
      std::this_thread::sleep_for(milliseconds(10));
    }
    return -1;
  }

  pid_t parent_ = 0;
  pid_t child_ = 0;
};

constexpr const char* kCleanly = "trap 'exit 7' TERM; echo; while :; do sleep 0.02; done";
constexpr const char* kDeaf = "trap '' TERM; echo; while :; do sleep 0.02; done";

TEST_F(OrphanGuardTest, AStoppedChildOfAKilledParentEndsCleanly) {
  startParent(kCleanly, true);
  kill(child_, SIGSTOP);
  killParent();
  const int status = waitForChild(milliseconds(4000));
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

TEST_F(OrphanGuardTest, WithoutAGuardItWouldStayStopped) {
  startParent(kCleanly, false);
  kill(child_, SIGSTOP);
  killParent();
  EXPECT_EQ(waitForChild(milliseconds(300)), -1);
  kill(child_, SIGKILL);
  EXPECT_NE(waitForChild(milliseconds(4000)), -1);
}

TEST_F(OrphanGuardTest, AChildThatHangsIsKilledAfterAWhile) {
  startParent(kDeaf, true);
  killParent();
  const int status = waitForChild(milliseconds(OrphanGuard::kTimeout_ms + 4000));
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGKILL);
}

TEST(OrphanGuard, EndsWithItsOwner) {
  const auto begin = std::chrono::steady_clock::now();
  {
    OrphanGuard dut;
    ChildProcess child({.arguments = {"sleep", "60"}, .death_signal = SIGTERM});
    dut.watch(child.pid());
    child.signal(SIGTERM);
    child.wait();
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, milliseconds(OrphanGuard::kTimeout_ms));
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD) << "the guard was not waited for";
}

}  // namespace
}  // namespace lab::orphan_guard_test
