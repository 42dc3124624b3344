#include "runner/command_line/experiment_lookup.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "runner/command_line/exit_code.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class ExperimentLookup : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(shipped_);
    std::ofstream(shipped_ / "abp.toml") << "name = \"abp\"\n";
    std::ofstream(shipped_ / "rtp.toml") << "name = \"rtp\"\n";
    previous_ = fs::current_path();
    fs::current_path(folder_ / ".");
  }
  void TearDown() override { fs::current_path(previous_); }

  TemporaryFolder folder_;
  fs::path shipped_ = folder_ / "shipped";
  fs::path previous_;
};

TEST_F(ExperimentLookup, FindsAShippedExperimentByName) {
  EXPECT_EQ(findExperiment("abp", shipped_), shipped_ / "abp.toml");
  EXPECT_EQ(findExperiment("abp.toml", shipped_), shipped_ / "abp.toml");
}

TEST_F(ExperimentLookup, PrefersAFileButNotAFolderOfThatName) {
  std::ofstream("rtp") << "mine\n";
  fs::create_directory("abp");

  EXPECT_EQ(findExperiment("rtp", shipped_), "rtp");
  EXPECT_EQ(findExperiment("abp", shipped_), shipped_ / "abp.toml");
}

TEST_F(ExperimentLookup, ReturnsPathsUnchanged) {
  EXPECT_EQ(findExperiment("experiments/abp.toml", shipped_), "experiments/abp.toml");
  EXPECT_EQ(findExperiment("./abp", shipped_), "./abp");
}

TEST_F(ExperimentLookup, ReportsWhereItLookedAndTheKnownNames) {
  try {
    static_cast<void>(findExperiment("apb", shipped_));
    FAIL() << "found an experiment that does not exist";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr(fs::absolute("apb").string()),
                                    HasSubstr((shipped_ / "apb.toml").string()),
                                    HasSubstr("there are abp, rtp")));
  }
  EXPECT_THROW(static_cast<void>(findExperiment("apb", folder_ / "absent")), UserError);
}

TEST_F(ExperimentLookup, SuggestsFilesOfThisFolderAndNamesFolders) {
  std::ofstream("small_circle.toml") << "name = \"small\"\n";
  const auto problemOf = [this](const std::string& name) -> std::string {
    try {
      return findExperiment(name, shipped_).string();
    } catch (const UserError& error) {
      return error.what();
    }
  };
  EXPECT_THAT(problemOf("smal_circle.toml"), HasSubstr("did you mean small_circle.toml?"));
  EXPECT_EQ(problemOf("."), ".: is a folder, expected an experiment file");
}

}  // namespace
}  // namespace lab::runner
