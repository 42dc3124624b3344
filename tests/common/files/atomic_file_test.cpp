#include "common/files/atomic_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>

#include "tests/support/file_size_limit.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab {
namespace {

namespace fs = std::filesystem;
using support::readFile;
using support::writeFile;
using testing::HasSubstr;

/// What was thrown, or nothing.
std::string problemOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

std::ptrdiff_t entriesOf(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), {});
}

TEST(ReplaceFile, WritesTheWholeFile) {
  const TemporaryFolder folder;
  replaceFile(folder / "file", "first");
  replaceFile(folder / "file", "second", Sync::kYes);

  EXPECT_EQ(readFile(folder / "file"), "second");
  EXPECT_EQ(entriesOf(folder.path()), 1);
}

TEST(ReplaceFile, ReplacesLinksAndDoesNotFollowThem) {
  const TemporaryFolder folder;
  writeFile(folder / "kept", "kept");
  fs::create_symlink(folder / "kept", folder / "a.json");

  replaceFile(folder / "a.json", "{}");

  EXPECT_EQ(readFile(folder / "kept"), "kept");
  EXPECT_EQ(readFile(folder / "a.json"), "{}");
  EXPECT_FALSE(fs::is_symlink(folder / "a.json"));
}

TEST(ReplaceFile, ReplacesNeitherFoldersNorPipes) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "folder");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);

  for (const char* name : {"folder", "pipe"}) {
    EXPECT_THAT(problemOf([&] { replaceFile(folder / name, "{}"); }),
                HasSubstr(std::string(name) + ": found a folder, a device or a pipe"));
  }

  EXPECT_TRUE(fs::is_directory(folder / "folder"));
  EXPECT_TRUE(fs::is_fifo(folder / "pipe"));
}

TEST(ReplaceFile, SaysWhyItCannotWrite) {
  EXPECT_EQ(problemOf([] { replaceFile("/nowhere/file", "text"); }),
            "cannot write /nowhere/file: No such file or directory");
  EXPECT_EQ(problemOf([] { replaceFile("/dev/full/file", "text"); }),
            "cannot write /dev/full/file: Not a directory");
}

TEST(ReplaceFile, KeepsTheFormerContentIfThereIsNoSpace) {
  const TemporaryFolder folder;
  writeFile(folder / "a.json", "former");
  std::string problem;
  {
    const FileSizeLimit limit(1000);
    problem = problemOf([&] { replaceFile(folder / "a.json", std::string(100'000, 'x')); });
  }

  EXPECT_THAT(problem, HasSubstr("a.json: File too large"));
  EXPECT_EQ(readFile(folder / "a.json"), "former");
  EXPECT_EQ(entriesOf(folder.path()), 1);
}

TEST(FullDisk, IsFoundInTexts) {
  EXPECT_TRUE(tellsOfFullDisk("cannot write x: No space left on device"));
  EXPECT_TRUE(tellsOfFullDisk("cannot write x: the disk is full"));
  EXPECT_FALSE(tellsOfFullDisk("cannot write x: Permission denied"));
}

TEST(AbandonedFiles, OfKilledProcessesAreRemoved) {
  const TemporaryFolder folder;
  char host[64] = {};
  gethostname(host, sizeof host - 1);
  const std::string ours = fmt::format("{}-{}-1.part", host, getpid());
  const std::string dead = fmt::format("{}-999999999-1.part", host);
  for (const std::string& name : {".a.json." + ours, ".a.json." + dead, ".b.json.other" + dead,
                                  "a.json." + dead, std::string("a.json")}) {
    writeFile(folder / name, "x");
  }
  removeAbandonedFiles(folder / "");
  EXPECT_TRUE(fs::exists(folder / (".a.json." + ours)));
  EXPECT_FALSE(fs::exists(folder / (".a.json." + dead)));
  EXPECT_TRUE(fs::exists(folder / (".b.json.other" + dead))) << "of another host";
  EXPECT_TRUE(fs::exists(folder / ("a.json." + dead)));
  EXPECT_TRUE(fs::exists(folder / "a.json"));
  removeAbandonedFiles(folder / "nothing");
}

TEST(AbandonedFiles, AKilledProcessThatNobodyWaitedForIsDead) {
  const TemporaryFolder folder;
  char host[64] = {};
  gethostname(host, sizeof host - 1);
  const pid_t child = fork();
  if (child == 0) _exit(0);
  siginfo_t ended = {};
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT), 0);
  const fs::path left = folder / fmt::format(".a.json.{}-{}-1.part", host, child);
  writeFile(left, "x");
  ASSERT_EQ(kill(child, 0), 0) << "kill() finds it until somebody waits";
  removeAbandonedFiles(folder / "");
  EXPECT_FALSE(fs::exists(left));
  waitpid(child, nullptr, 0);
}

TEST(AtomicFile, AppearsWhenItIsFinished) {
  const TemporaryFolder folder;
  writeFile(folder / "a.csv", "former");
  AtomicFile dut(folder / "a.csv");
  writeFile(dut.part(), "new");
  EXPECT_EQ(readFile(folder / "a.csv"), "former");

  dut.finish();

  EXPECT_EQ(readFile(folder / "a.csv"), "new");
  EXPECT_EQ(entriesOf(folder.path()), 1);
}

TEST(AtomicFile, LeavesTheFormerContentAndNoPartIfItIsNotFinished) {
  const TemporaryFolder folder;
  writeFile(folder / "a.csv", "former");
  {
    AtomicFile dut(folder / "a.csv");
    writeFile(dut.part(), "new");
  }

  EXPECT_EQ(readFile(folder / "a.csv"), "former");
  EXPECT_EQ(entriesOf(folder.path()), 1);
}

TEST(AtomicFile, RemovesALinkAtTheNameOfItsPart) {
  const TemporaryFolder folder;
  writeFile(folder / "kept", "kept");
  fs::create_symlink(folder / "kept", folder / "a.csv.part");

  const AtomicFile dut(folder / "a.csv");
  writeFile(dut.part(), "new");

  EXPECT_EQ(readFile(folder / "kept"), "kept");
}

}  // namespace
}  // namespace lab
