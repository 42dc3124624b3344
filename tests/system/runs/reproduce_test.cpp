#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/lab_process.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST(Reproduce, WritesPageAndPanelsOfAShortRun) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";

  const Finished dut =
      run("lab reproduce --hours 0.1 --panels 2b,4d --no-bootstrap --out " + out.string());

  ASSERT_EQ(dut.exit_code, 0) << dut.output;
  const std::string page = readFile(out / "reproduction.html");
  EXPECT_THAT(page, HasSubstr("<svg"));
  EXPECT_THAT(page, HasSubstr("Chosen here:"));
  EXPECT_THAT(page, HasSubstr("eq. 6 is the exact law here"));
  EXPECT_THAT(page, Not(HasSubstr(folder.path().string())));
  for (const char* panel : {"fig2b", "fig4d"}) {
    EXPECT_THAT(readFile(out / (std::string(panel) + ".svg")), HasSubstr("<svg"));
    EXPECT_THAT(readFile(out / (std::string(panel) + ".pdf")), StartsWith("%PDF"));
    EXPECT_THAT(readFile(out / (std::string(panel) + ".csv")),
                StartsWith("what,set,lag_s,value_cm2,standard_error_cm2,noise_cm2,exact_cm2,"
                           "paper_cm2,z,judged\ncurve,"));
  }
  EXPECT_THAT(readFile(out / "estimates.csv"), HasSubstr("rtp_gamma2_taut0.5,gamma,per_s,"));
  EXPECT_TRUE(fs::exists(out / "films" / "abp_eps0.5_eta3" / "experiment.toml"));
  EXPECT_FALSE(fs::exists(out / "films" / "abp_eps0.5_eta3" / "log.lcmlog"));
}

TEST(Reproduce, IsByteIdenticalForAnyNumberOfJobs) {
  const TemporaryFolder folder;
  const std::string command = "lab reproduce --hours 0.01 --panels 3d --no-bootstrap --seed 3 ";
  const fs::path one = folder.path() / "one";
  const fs::path four = folder.path() / "four";
  ASSERT_EQ(run(command + "--jobs 1 --out " + one.string()).exit_code, 0);
  ASSERT_EQ(run(command + "--jobs 4 --out " + four.string()).exit_code, 0);
  for (const char* file : {"reproduction.html", "fig3d.pdf", "fig3d.csv", "estimates.csv"}) {
    EXPECT_TRUE(readFile(one / file) == readFile(four / file)) << file;
  }
}

TEST(Reproduce, AveragesAnEnsemble) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  const Finished dut =
      run("lab reproduce --hours 0.01 --panels 2b --ensemble 3 --out " + out.string());
  ASSERT_EQ(dut.exit_code, 0) << dut.output;
  EXPECT_THAT(readFile(out / "reproduction.html"), HasSubstr("3 recordings each"));
  EXPECT_THAT(readFile(out / "estimates.csv"), HasSubstr("mean of 3 recordings"));
}

TEST(Reproduce, RefusesBeforeItStarts) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "mine.txt") << "kept";
  const std::string out = " --out " + folder.path().string();

  const Finished full = run("lab reproduce" + out);
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_THAT(full.output, HasSubstr("is no reproduction; choose another folder with --out"));
  EXPECT_EQ(run("lab reproduce --force" + out).exit_code, 2) << "files of others are not deleted";

  const Finished unknown = run("lab reproduce --panels 4a" + out + "/new");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.output, HasSubstr("4a is a drawing"));
  EXPECT_FALSE(fs::exists(folder.path() / "new"));
  EXPECT_EQ(readFile(folder.path() / "mine.txt"), "kept");
}

TEST(Reproduce, EndsCleanlyAtCtrlC) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  Background lab("exec lab reproduce --hours 20 --panels 2b --out " + out.string());
  ASSERT_TRUE(waitUntil([&] { return fs::exists(out / "films"); }, std::chrono::seconds(60)));
  lab.signal(SIGINT);
  const Finished dut = lab.wait(std::chrono::seconds(60));
  EXPECT_EQ(dut.exit_code, 1) << dut.output;
  EXPECT_THAT(dut.output, HasSubstr("ended by the user"));
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace lab::system_test
