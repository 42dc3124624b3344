#include "runner/lab_registry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "runner/exit_code.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

class LabRegistry : public testing::Test {
 protected:
  LabRegistry() {
    fs::create_directories(folder);
    setenv("XDG_RUNTIME_DIR", folder.c_str(), 1);
  }
  ~LabRegistry() override { fs::remove_all(folder); }

  fs::path folder = fs::path(testing::TempDir()) / ("registry_test_" + std::to_string(getpid()));
};

TEST_F(LabRegistry, ASingleLabIsImpliedAndGoneWithItsRegistration) {
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

TEST_F(LabRegistry, ForgetsLabsWhoseRunnerDied) {
  constexpr int kNobody = 999'999'999;
  const fs::path file = registryDirectory() / "999999999.json";
  fs::create_directories(registryDirectory());
  std::ofstream(file) << R"({"name": "dead", "url": "udpm://d", "pid": )" << kNobody
                      << R"(, "directory": "/runs/dead", "replay": false})";
  EXPECT_THAT(runningLabs(), testing::IsEmpty());
  EXPECT_FALSE(fs::exists(file));
}

TEST_F(LabRegistry, ClearsAwayWhatDeadRunnersKept) {
  fs::create_directories(registryDirectory());
  const fs::path mine = ownFile(".web.txt");
  std::ofstream(mine) << "";
  for (const char* ending : {".web", ".web.txt", ".web.part", ".web.html"}) {
    std::ofstream(registryDirectory() / (std::string("999999999") + ending)) << "";
  }
  EXPECT_THAT(runningLabs(), testing::IsEmpty());
  std::vector<fs::path> left;
  for (const auto& entry : fs::directory_iterator(registryDirectory())) left.push_back(entry);
  EXPECT_THAT(left, testing::ElementsAre(mine));
  {
    const OwnFile dut(".web.txt");
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
