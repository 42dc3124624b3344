// What other users, or damaged files, put into the registry. Registrations of runners are tested in
// tests/runner/runs/lab_registry_test.cpp.
#include "common/process/running_labs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace lab {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;
using testing::SizeIs;

class RunningLabs : public testing::Test {
 protected:
  RunningLabs() {
    if (const char* runtime = std::getenv("XDG_RUNTIME_DIR")) earlier_ = runtime;
    setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1);
    fs::create_directory(registryDirectory());
    std::ofstream(registryDirectory() / "a.json")
        << R"({"name": "a", "url": "udpm://x", "pid": )" << getpid()
        << R"(, "directory": "/runs/a", "replay": false})";
    std::ofstream(page()) << "http://127.0.0.1:8080/?token=1\n";
  }
  ~RunningLabs() override {
    if (earlier_.empty()) {
      unsetenv("XDG_RUNTIME_DIR");
    } else {
      setenv("XDG_RUNTIME_DIR", earlier_.c_str(), 1);
    }
  }

  [[nodiscard]] static fs::path page() {
    return registryDirectory() / (std::to_string(getpid()) + kPageFile);
  }
  [[nodiscard]] static std::string address() {
    return pageOf({.name = "a", .url = "", .pid = getpid(), .directory = "", .replay = false});
  }

  TemporaryFolder folder_;

 private:
  std::string earlier_;
};

TEST_F(RunningLabs, AreThoseOfTheUsersFolder) {
  ASSERT_THAT(runningLabs(), SizeIs(1));
  EXPECT_EQ(runningLabs()[0].url, "udpm://x");
  EXPECT_EQ(address(), "http://127.0.0.1:8080/?token=1");
}

TEST_F(RunningLabs, AreNoneBehindALink) {
  fs::rename(registryDirectory(), folder_ / "theirs");
  fs::create_directory_symlink(folder_ / "theirs", registryDirectory());
  EXPECT_THAT(runningLabs(), IsEmpty());
  EXPECT_EQ(address(), "");
}

TEST_F(RunningLabs, AreNoneInAFolderOfAnotherUser) {
  constexpr uid_t kNobody = 65534;
  std::ofstream(registryDirectory() / "999999999.web") << "";
  if (chown(registryDirectory().c_str(), kNobody, static_cast<gid_t>(-1)) != 0) {
    GTEST_SKIP() << "only root may give a folder away";
  }
  EXPECT_THAT(runningLabs(), IsEmpty());
  EXPECT_EQ(address(), "");
  EXPECT_TRUE(fs::exists(registryDirectory() / "999999999.web")) << "it is not ours to remove";
}

TEST_F(RunningLabs, AreNotReadFromPipes) {  // that would wait for ever
  fs::remove(page());
  ASSERT_EQ(mkfifo(page().c_str(), 0600), 0);
  ASSERT_EQ(mkfifo((registryDirectory() / "pipe.json").c_str(), 0600), 0);
  EXPECT_THAT(runningLabs(), SizeIs(1));
  EXPECT_EQ(address(), "");
}

TEST_F(RunningLabs, AreNotReadFromLargeFiles) {
  std::ofstream(registryDirectory() / "a.json", std::ios::app) << std::string(100'000, ' ');
  EXPECT_THAT(runningLabs(), IsEmpty());
}

}  // namespace
}  // namespace lab
