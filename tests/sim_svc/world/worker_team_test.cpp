#include "sim_svc/world/worker_team.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lab::sim::worker_team_test {
namespace {

TEST(WorkerTeam, WorksOnEachPartOnce) {
  for (const std::size_t threads : {1U, 2U, 5U}) {
    WorkerTeam dut(threads);
    EXPECT_EQ(dut.size(), threads);
    for (const std::size_t parts : {0U, 1U, 2U, 3U, 100U}) {
      std::vector<int> done(parts);
      dut.run(parts, [&](std::size_t part, std::size_t worker) {
        EXPECT_LT(worker, threads);
        ++done[part];
      });
      EXPECT_EQ(done, std::vector<int>(parts, 1));
    }
  }
}

TEST(WorkerTeam, ReturnsWhenAllPartsAreDone) {
  WorkerTeam dut(4);
  std::int64_t sum = 0;
  for (int round = 0; round < 20000; ++round) {
    std::atomic<int> done = 0;
    dut.run(7, [&](std::size_t, std::size_t) { ++done; });
    sum += done;
  }
  EXPECT_EQ(sum, 7 * 20000);
}

TEST(WorkerTeam, HasScratchMemoryOfItsOwnForEachWorker) {
  WorkerTeam dut(3);
  std::vector<std::size_t> parts(dut.size());
  for (int round = 0; round < 1000; ++round) {
    dut.run(50, [&](std::size_t, std::size_t worker) { ++parts[worker]; });
  }
  EXPECT_EQ(parts[0] + parts[1] + parts[2], 50000U);
}

TEST(WorkerTeam, EndsWithoutWork) {
  const WorkerTeam dut(8);
  EXPECT_GE(availableProcessors(), 1U);
}

}  // namespace
}  // namespace lab::sim::worker_team_test
