#include "runner/campaign/row_pool.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>

#include "common/files/atomic_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::runner::campaign::row_pool_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::map<std::size_t, RowEnd> runAll(RowPool& pool) {
  std::map<std::size_t, RowEnd> ends;
  while (!pool.empty()) {
    for (RowEnd& end : pool.wait(std::chrono::milliseconds(100))) ends[end.row] = std::move(end);
  }
  return ends;
}

TEST(RowPool, RunsEachRowOnceInAProcessOfItsOwn) {
  const TemporaryFolder folder;
  RowPool pool(3, folder.path(), [&](std::size_t row) {
    std::ofstream(folder / std::to_string(row), std::ios::app) << getpid() << "\n";
  });
  for (std::size_t row = 0; row < 20; ++row) pool.add(row);
  const auto ends = runAll(pool);

  ASSERT_EQ(ends.size(), 20U);
  std::map<std::string, int> pids;
  for (std::size_t row = 0; row < 20; ++row) {
    EXPECT_EQ(ends.at(row).kind, RowEnd::Kind::kDone);
    std::ifstream file(folder / std::to_string(row));
    std::string pid;
    std::string second;
    file >> pid >> second;
    EXPECT_EQ(second, "");
    ++pids[pid];
  }
  EXPECT_EQ(pids.size(), 20U);
}

TEST(RowPool, GivesTheReasonOfEachFailure) {
  const TemporaryFolder folder;
  RowPool pool(2, folder.path(), [](std::size_t row) {
    if (row == 0) throw std::runtime_error("the log\nhas no frames");
    if (row == 1) throw DiskFull("cannot write x: No space left on device");
    if (row == 2) std::abort();
    if (row == 3) std::raise(SIGKILL);
  });
  for (std::size_t row = 0; row < 5; ++row) pool.add(row);
  const auto ends = runAll(pool);

  EXPECT_EQ(ends.at(0).kind, RowEnd::Kind::kFailed);
  EXPECT_THAT(ends.at(0).reason, HasSubstr("has no frames"));
  EXPECT_EQ(ends.at(1).kind, RowEnd::Kind::kDiskFull);
  EXPECT_EQ(ends.at(2).kind, RowEnd::Kind::kFailed);
  EXPECT_THAT(ends.at(2).reason, HasSubstr("signal 6"));
  EXPECT_EQ(ends.at(3).kind, RowEnd::Kind::kKilled);
  EXPECT_EQ(ends.at(4).kind, RowEnd::Kind::kDone);
}

TEST(RowPool, RunsAsManyAtATimeAsThereAreJobs) {
  const TemporaryFolder folder;
  // A row ends when all files of the three that run at a time exist: with fewer jobs, never.
  RowPool pool(3, folder.path(), [&](std::size_t row) {
    std::ofstream(folder / ("begun" + std::to_string(row))) << "x";
    for (std::size_t other = 0; other < 3; ++other) {
      while (!fs::exists(folder / ("begun" + std::to_string(other)))) usleep(1000);
    }
  });
  for (std::size_t row = 0; row < 3; ++row) pool.add(row);

  EXPECT_EQ(runAll(pool).size(), 3U);
}

TEST(RowPool, KillsWhatRunsAtItsEnd) {
  const TemporaryFolder folder;
  {
    RowPool pool(1, folder.path(), [&](std::size_t) {
      std::ofstream(folder / "pid") << getpid() << std::endl;
      while (true) pause();
    });
    pool.add(0);
    while (!fs::exists(folder / "pid") || fs::file_size(folder / "pid") < 2) {
      static_cast<void>(pool.wait(std::chrono::milliseconds(1)));
    }
  }
  pid_t pid = 0;
  std::ifstream(folder / "pid") >> pid;

  EXPECT_NE(kill(pid, 0), 0);
}

}  // namespace
}  // namespace lab::runner::campaign::row_pool_test
