#include "runner/live/local_process.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;

class LocalProcessTest : public testing::Test {
 protected:
  TemporaryFolder folder;
  fs::path output = folder / "output";
};

TEST_F(LocalProcessTest, AppendsItsOutputAndReportsItsExitCode) {
  LocalProcess dut({"/bin/sh", "-c", "echo text; exit 3"}, output);
  dut.waitOrKill(5000);
  EXPECT_EQ(dut.ending(), "exit code 3");
  EXPECT_EQ(support::readFile(output), "text\n");
}

TEST_F(LocalProcessTest, EndsWhenAsked) {
  LocalProcess dut({"/bin/sleep", "60"}, output);
  EXPECT_TRUE(dut.running());
  dut.terminate();
  EXPECT_FALSE(dut.waitOrKill(5000));
  EXPECT_EQ(dut.ending(), "killed by signal 15");
}

TEST_F(LocalProcessTest, IsKilledWhenItIgnoresSigterm) {
  LocalProcess dut({"/bin/sh", "-c", "trap '' TERM; while :; do sleep 0.05; done"}, output);
  EXPECT_TRUE(dut.waitOrKill(100));
  EXPECT_EQ(dut.ending(), "killed by signal 9");
}

TEST_F(LocalProcessTest, AMissingProgramEndsWithTheShellsCode) {
  LocalProcess dut({"/nonexistent"}, output);
  dut.waitOrKill(5000);
  EXPECT_EQ(dut.ending(), "exit code 127");
}

}  // namespace
}  // namespace lab::runner
