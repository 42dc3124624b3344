#include "runner/live/child_process.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

class ChildProcessTest : public testing::Test {
 protected:
  fs::path output = fs::path(testing::TempDir()) / "child_process_test_output";
  ~ChildProcessTest() override { fs::remove(output); }
};

TEST_F(ChildProcessTest, AppendsItsOutputAndTellsItsExitCode) {
  ChildProcess dut("shell", {"/bin/sh", "-c", "echo said; exit 3"}, output);
  dut.waitOrKill(5000);
  EXPECT_EQ(dut.ending(), "exit code 3");
  std::string text;
  std::ifstream(output) >> text;
  EXPECT_EQ(text, "said");
}

TEST_F(ChildProcessTest, EndsWhenAsked) {
  ChildProcess dut("sleeper", {"/bin/sleep", "60"}, output);
  EXPECT_TRUE(dut.running());
  dut.terminate();
  EXPECT_FALSE(dut.waitOrKill(5000));
  EXPECT_EQ(dut.ending(), "killed by signal 15");
}

TEST_F(ChildProcessTest, IsKilledWhenItDoesNotListen) {
  ChildProcess dut("deaf", {"/bin/sh", "-c", "trap '' TERM; while :; do sleep 0.05; done"}, output);
  EXPECT_TRUE(dut.waitOrKill(100));
  EXPECT_EQ(dut.ending(), "killed by signal 9");
}

TEST_F(ChildProcessTest, AMissingProgramEndsWithTheShellsCode) {
  ChildProcess dut("missing", {"/nonexistent"}, output);
  dut.waitOrKill(5000);
  EXPECT_EQ(dut.ending(), "exit code 127");
}

}  // namespace
}  // namespace lab::runner
