#include "runner/runs/lab_registry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "runner/command_line/exit_code.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

class LabRegistry : public testing::Test {
 protected:
  LabRegistry() { setenv("XDG_RUNTIME_DIR", folder.path().c_str(), 1); }

  TemporaryFolder folder;
};

TEST_F(LabRegistry, FindsTheOnlyLabUntilItsRegistrationEnds) {
  {
    const Registration dut({"abp-1", "udpm://x", getpid(), "/runs/abp-1", false});
    EXPECT_EQ(findLab("").name, "abp-1");
    EXPECT_EQ(findLab("abp-1").url, "udpm://x");
  }
  EXPECT_THROW(static_cast<void>(findLab("")), UserError);
}

TEST_F(LabRegistry, OfSeveralLabsOneMustBeNamed) {
  const Registration first({"one", "udpm://1", getpid(), "/runs/one", false});
  const Registration second({"two", "udpm://2", getppid(), "/runs/two", false});
  EXPECT_EQ(findLab("two").url, "udpm://2");
  EXPECT_THAT([] { static_cast<void>(findLab("")); }, ThrowsMessage<UserError>(HasSubstr("--lab")));
  EXPECT_THAT([] { static_cast<void>(findLab("three")); },
              ThrowsMessage<UserError>(HasSubstr("no lab named three")));
}

TEST_F(LabRegistry, RunningLabsGetUniqueNames) {
  const fs::path mine = folder / "mine" / "abp-1";
  const fs::path yours = folder / "yours" / "abp-1";
  fs::create_directories(mine);
  fs::create_directories(yours);

  const Registration first({"abp-1", "udpm://1", getppid(), mine.string(), false});
  const Registration second({"abp-1", "udpm://2", getpid(), yours.string(), false});
  const Registration third({"abp-1", "udpm://3", 1, "", false});

  EXPECT_EQ(first.name(), "abp-1");
  EXPECT_EQ(second.name(), "abp-1-2");
  EXPECT_EQ(third.name(), "abp-1-3");
  EXPECT_EQ(findLab("abp-1").url, "udpm://1");
  EXPECT_EQ(findLab("abp-1-2").url, "udpm://2");
  EXPECT_EQ(findLab(yours.string() + "/").url, "udpm://2") << "a folder identifies its lab";
}

TEST_F(LabRegistry, ANameIsFreeAfterItsLabHasEnded) {
  { const Registration earlier({"abp-1", "udpm://1", getppid(), "", false}); }
  // The file of a killed runner with the process id of this process.
  std::ofstream(registryDirectory() / (std::to_string(getpid()) + ".json"))
      << R"({"name": "abp-1", "url": "udpm://0", "pid": )" << getpid()
      << R"(, "directory": "", "replay": false})";

  const Registration dut({"abp-1", "udpm://2", getpid(), "", false});

  EXPECT_EQ(dut.name(), "abp-1");
}

TEST_F(LabRegistry, AnAmbiguousNameIsRefusedWithTheFolders) {
  const Registration first({"abp-1", "udpm://1", getppid(), "/a/abp-1", false});
  // As older versions without unique names registered.
  std::ofstream(registryDirectory() / "1.json")
      << R"({"name": "abp-1", "url": "udpm://2", "pid": 1, "directory": "/b/abp-1", "replay": false})";

  const auto find = [] { static_cast<void>(findLab("abp-1")); };

  EXPECT_THAT(find, ThrowsMessage<UserError>(HasSubstr("say which with --lab FOLDER: ")));
  EXPECT_THAT(find, ThrowsMessage<UserError>(HasSubstr("/a/abp-1")));
  EXPECT_THAT(find, ThrowsMessage<UserError>(HasSubstr("/b/abp-1")));
}

TEST_F(LabRegistry, ForgetsLabsWhoseRunnerDied) {
  constexpr int kUnusedPid = 999'999'999;
  const fs::path file = registryDirectory() / "999999999.json";
  fs::create_directories(registryDirectory());
  std::ofstream(file) << R"({"name": "dead", "url": "udpm://d", "pid": )" << kUnusedPid
                      << R"(, "directory": "/runs/dead", "replay": false})";
  EXPECT_THAT(runningLabs(), testing::IsEmpty());
  EXPECT_FALSE(fs::exists(file));
}

// The folder of a replayed run may come from a stranger.
TEST_F(LabRegistry, NamesAreShownWithoutControlCharacters) {
  const Registration dut({"replay-\x1b[2J\nlab", "udpm://x", getpid(), "/runs/\x1b[2J", true});

  EXPECT_EQ(dut.name(), "replay-\\x1b[2J\\x0alab");
  EXPECT_EQ(findLab("").name, dut.name());
  EXPECT_EQ(findLab(dut.name()).url, "udpm://x");
}

TEST_F(LabRegistry, TakesFoldersWhoseNamesAreNoText) {
  {
    const Registration dut({"run-\xff", "udpm://x", getpid(), "/runs/run-\xff", false});
    EXPECT_EQ(findLab("").name, "run-\xEF\xBF\xBD");
    EXPECT_EQ(findLab("").directory, "/runs/run-\xEF\xBF\xBD");
  }
  EXPECT_THAT(runningLabs(), testing::IsEmpty());
}

TEST_F(LabRegistry, RemovesFilesOfDeadRunnersThatCannotBeRead) {
  fs::create_directories(registryDirectory());
  const fs::path dead = registryDirectory() / "999999999.json";
  const fs::path mine = registryDirectory() / (std::to_string(getpid()) + ".json");
  const fs::path unknown = registryDirectory() / "notes.json";
  for (const fs::path& file : {dead, mine, unknown}) std::ofstream(file) << "";

  EXPECT_THAT(runningLabs(), testing::IsEmpty());

  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(mine)) << "it may be about to be written";
  EXPECT_TRUE(fs::exists(unknown));
}

TEST_F(LabRegistry, RemovesFilesOfDeadRunners) {
  fs::create_directories(registryDirectory());
  const fs::path mine = registryFile(".web.txt");
  std::ofstream(mine) << "";
  for (const char* ending : {".web", ".web.txt", ".web.part", ".web.html"}) {
    std::ofstream(registryDirectory() / (std::string("999999999") + ending)) << "";
  }
  EXPECT_THAT(runningLabs(), testing::IsEmpty());
  std::vector<fs::path> left;
  for (const auto& entry : fs::directory_iterator(registryDirectory())) left.push_back(entry);
  EXPECT_THAT(left, testing::ElementsAre(mine));
  {
    const RegistryFile dut(".web.txt");
    EXPECT_EQ(dut.path(), mine);
  }
  EXPECT_FALSE(fs::exists(mine));
}

TEST_F(LabRegistry, APortBelongsToOneLab) {
  constexpr int kPort = 23450;
  {
    const PortLock dut(kPort);
    EXPECT_THAT([] { const PortLock second(kPort); },
                ThrowsMessage<UserError>(HasSubstr("port 23450")));
  }
  EXPECT_NO_THROW(const PortLock again(kPort));
}

TEST_F(LabRegistry, SurvivesGarbage) {
  fs::create_directories(registryDirectory());
  std::ofstream(registryDirectory() / "1.json") << "not json";
  std::ofstream(registryDirectory() / "2.json") << R"({"name": "x", "pid": "x"})";
  EXPECT_THAT(runningLabs(), testing::IsEmpty());
}

}  // namespace
}  // namespace lab::runner
