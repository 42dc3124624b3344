#include "common/process/child_process.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <string>
#include <system_error>
#include <vector>

#include "common/process/output_tail.hpp"
#include "common/process/pipe.hpp"

namespace lab::child_process_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Runs a shell script to its end. @return what it printed
std::string outputOf(const std::string& script, ChildSettings settings = {}) {
  Pipe pipe = makePipe();
  settings.arguments = {"sh", "-c", script};
  settings.output = pipe.in.get();
  ChildProcess child(settings);
  pipe.in = FileDescriptor();
  OutputTail tail(65536);
  tail.open(std::move(pipe.out));
  while (!child.waitFor(milliseconds(5))) tail.take();
  tail.take();
  return tail.text();
}

/// As under `ulimit -n 16`: the error must not be lost with the descriptor that reports it.
TEST(ChildProcess, SaysThatItGetsNoDescriptors) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit few{16, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  std::string problem = "started";
  try {
    const ChildProcess child({.arguments = {"true"}});
  } catch (const std::system_error& error) {
    problem = error.what();
  }
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_EQ(problem, "cannot start true: Invalid argument");
}

TEST(ChildProcess, SaysHowItEnded) {
  ChildProcess code({.arguments = {"sh", "-c", "exit 3"}});
  code.wait();
  EXPECT_EQ(code.code(), 3);
  EXPECT_EQ(code.endingSignal(), 0);
  EXPECT_EQ(code.ending(), "exit code 3");

  ChildProcess killed({.arguments = {"sleep", "60"}});
  EXPECT_FALSE(killed.waitFor(milliseconds(1)));
  EXPECT_EQ(killed.code(), -1);
  EXPECT_EQ(killed.ending(), "");
  killed.signal(SIGTERM);
  EXPECT_TRUE(killed.waitFor(seconds(10)));
  EXPECT_EQ(killed.code(), 128 + SIGTERM);
  EXPECT_EQ(killed.ending(), "killed by signal 15");
}

TEST(CloseFrom, WorksAlsoOneByOne) {
  const FileDescriptor low(fcntl(0, F_DUPFD, 40));
  int high = fcntl(0, F_DUPFD, 60);
  closeOneByOneFrom(50, Close::kAtExec);
  EXPECT_EQ(fcntl(low.get(), F_GETFD), 0);
  EXPECT_EQ(fcntl(high, F_GETFD), FD_CLOEXEC);
  closeOneByOneFrom(50, Close::kNow);
  EXPECT_EQ(fcntl(low.get(), F_GETFD), 0);
  EXPECT_EQ(fcntl(high, F_GETFD), -1);
}

TEST(ChildProcess, AProgramThatIsNotThereIsAnError) {
  try {
    const ChildProcess child({.arguments = {"/nonexistent/program"}});
    FAIL() << "it was started";
  } catch (const std::system_error& error) {
    EXPECT_EQ(error.code(), std::errc::no_such_file_or_directory);
    EXPECT_NE(std::string(error.what()).find("cannot start /nonexistent/program"),
              std::string::npos);
  }
}

TEST(ChildProcess, InheritsNoOtherDescriptors) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);  // as LCM opens it: without SOCK_CLOEXEC
  ASSERT_GT(socket, 2);
  EXPECT_EQ(outputOf("ls -l /proc/self/fd | grep -c socket"), "0\n");
  close(socket);
}

TEST(ChildProcess, HandsDescriptorsOnUnderTheirNumbers) {
  Pipe a = makePipe();
  Pipe b = makePipe();
  ASSERT_EQ(write(a.in.get(), "a\n", 2), 2);
  ASSERT_EQ(write(b.in.get(), "b\n", 2), 2);
  // Crosswise: the numbers there are numbers that are in use here.
  ChildSettings settings;
  settings.handed_on = {{a.out.get(), b.out.get()}, {b.out.get(), a.out.get()}};
  const std::string script =
      "head -n 1 <&" + std::to_string(b.out.get()) + "; head -n 1 <&" + std::to_string(a.out.get());
  ASSERT_LT(a.out.get(), 10) << "sh knows descriptors of one digit only";
  ASSERT_LT(b.out.get(), 10);
  EXPECT_EQ(outputOf(script, settings), "a\nb\n");
}

TEST(ChildProcess, GetsACleanEnvironmentWhereAsked) {
  ChildSettings settings;
  settings.environment = std::vector<std::string>{"ONLY=this"};
  EXPECT_EQ(outputOf("echo $ONLY$HOME", settings), "this\n");
}

TEST(ChildProcess, HasItsOwnGroupOrSession) {
  const std::string own = std::to_string(getpgrp()) + "\n";
  const std::string group = "cut -d ' ' -f 5 /proc/self/stat";
  EXPECT_NE(outputOf(group), own);
  EXPECT_NE(outputOf(group, {.group = ChildSettings::Group::kSession}), own);
  EXPECT_EQ(outputOf(group, {.group = ChildSettings::Group::kShared}), own);
}

TEST(ChildProcess, OnlyAChildOfThisGroupKeepsIgnoredSignals) {
  const auto before = signal(SIGPIPE, SIG_IGN);
  const std::string script = "kill -PIPE $$; echo ignored";
  EXPECT_EQ(outputOf(script), "");
  EXPECT_EQ(outputOf(script, {.group = ChildSettings::Group::kShared}), "ignored\n");
  EXPECT_EQ(outputOf("kill -TERM $$; echo ignored", {.ignored_signals = {SIGTERM}}), "ignored\n");
  signal(SIGPIPE, before);
}

TEST(ChildProcess, IsKilledByTheDestructorUnlessItMayOutlive) {
  pid_t ended = 0;
  pid_t living = 0;
  {
    ChildProcess child({.arguments = {"sleep", "60"}});
    ChildProcess other({.arguments = {"sleep", "60"}, .death_signal = 0});
    ended = child.pid();
    living = other.pid();
  }
  EXPECT_NE(kill(ended, 0), 0);
  EXPECT_EQ(kill(living, 0), 0);
  kill(living, SIGKILL);
}

TEST(OutputTail, KeepsTheEndAndLetsTheChildGoOn) {
  Pipe pipe = makePipe();
  ChildProcess child(
      {.arguments = {"sh", "-c", "head -c 10000000 /dev/zero | tr '\\0' x; echo end"},
       .output = pipe.in.get()});
  pipe.in = FileDescriptor();
  OutputTail dut(100);
  dut.open(std::move(pipe.out));
  while (!child.waitFor(milliseconds(0))) {
    dut.take();
    ASSERT_LE(dut.text().size(), 100U);
  }
  while (dut.descriptor() >= 0) dut.take();
  // Not with operator+: g++ 12 gives a false warning for it in builds with TSan.
  std::string end(96, 'x');
  end += "end\n";
  EXPECT_EQ(dut.text(), end);
}

}  // namespace
}  // namespace lab::child_process_test
