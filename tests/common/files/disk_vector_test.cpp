#include "common/files/disk_vector.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include "tests/support/file_size_limit.hpp"

namespace lab {
namespace {

/// Large, so that few of them do not fit into the memory that a vector takes.
struct Record {
  std::uint32_t key = 0;
  std::uint32_t number = 0;
  std::array<std::byte, (std::size_t{256} << 10U) - 8> filling{};
};

using Records = DiskVector<Record>;

Record recordOf(std::uint32_t key, std::uint32_t number) {
  Record record;
  record.key = key;
  record.number = number;
  record.filling.back() = static_cast<std::byte>(number);
  return record;
}

/// What the sanitizers keep of the memory counts, too: nothing to compare.
double residentMegabytes() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return 0;
#else
  std::ifstream file("/proc/self/statm");
  double all = 0;
  double resident = 0;
  file >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
#endif
}

TEST(DiskVector, KeepsFewValuesInMemory) {
  DiskVector<int> dut;
  EXPECT_TRUE(dut.empty());
  for (int i = 0; i < 100'000; ++i) dut.push_back(i);
  ASSERT_EQ(dut.size(), 100'000U);
  EXPECT_EQ(dut.front(), 0);
  EXPECT_EQ(dut.back(), 99'999);
  EXPECT_EQ(dut[77'777], 77'777);
  const DiskVector<int> copy = dut;
  dut[5] = -1;
  EXPECT_EQ(copy[5], 5);
  dut.shrink(6);
  EXPECT_EQ(dut.back(), -1);
  DiskVector<int> moved = std::move(dut);
  moved.push_back(moved.front());
  EXPECT_THAT(moved.part(4, 7), testing::ElementsAre(4, -1, 0));
}

TEST(DiskVector, KeepsManyValuesInAFile) {
  constexpr std::uint32_t kMany = 5 * Records::kBlock / 2;
  const double before = residentMegabytes();
  Records dut;
  for (std::uint32_t i = 0; i < kMany; ++i) dut.push_back(recordOf(i, 7 * i));
  dut.releaseMemory();
  EXPECT_LT(residentMegabytes() - before, 20) << "of 160 MB";
  std::uint32_t next = 0;
  double most = 0;
  dut.each([&](const Record& record) {
    if (record.number == 7 * record.key && record.key == next &&
        record.filling.back() == static_cast<std::byte>(record.number)) {
      ++next;
    }
    if (next % 16 == 0) most = std::max(most, residentMegabytes() - before);
  });
  EXPECT_EQ(next, kMany);
  EXPECT_LT(most, 90) << "of 160 MB";
}

TEST(DiskVector, SortsAndKeepsTheOrderOfEqualValues) {
  constexpr std::uint32_t kMany = 5 * Records::kBlock / 2;
  constexpr std::uint32_t kKeys = 50;
  std::mt19937 random(1);
  Records dut;
  for (std::uint32_t i = 0; i < kMany; ++i)
    dut.push_back(recordOf(static_cast<std::uint32_t>(random() % kKeys), i));
  dut.stableSort([](const Record& a, const Record& b) { return a.key < b.key; });
  ASSERT_EQ(dut.size(), kMany);
  std::uint64_t sum = 0;
  for (std::uint32_t i = 0; i < kMany; ++i) {
    sum += dut[i].number;
    EXPECT_EQ(dut[i].filling.back(), static_cast<std::byte>(dut[i].number));
    if (i == 0) continue;
    EXPECT_LE(dut[i - 1].key, dut[i].key);
    if (dut[i - 1].key == dut[i].key) {
      EXPECT_LT(dut[i - 1].number, dut[i].number);
    }
  }
  EXPECT_EQ(sum, std::uint64_t{kMany} * (kMany - 1) / 2);
}

TEST(DiskVector, NamesTheFolderWithoutRoom) {
  const auto fill = [](Records& dut) -> std::string {
    try {
      for (std::uint32_t i = 0; i < 2 * Records::kBlock; ++i) dut.push_back(recordOf(i, i));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "none";
  };
  const char* set = std::getenv("TMPDIR");
  const std::string former = set == nullptr ? "" : set;
  ASSERT_EQ(setenv("TMPDIR", "/nowhere", 1), 0);
  Records dut;
  const std::string missing = fill(dut);
  if (set == nullptr) {
    unsetenv("TMPDIR");
  } else {
    setenv("TMPDIR", former.c_str(), 1);
  }
  EXPECT_THAT(missing, testing::HasSubstr("/nowhere: cannot keep"));
  EXPECT_THAT(missing, testing::HasSubstr("set TMPDIR to a folder with room"));
  EXPECT_EQ(dut[3].key, 3U) << "what was there stays";

  Records full;
  std::string refused;
  {
    const FileSizeLimit limit(std::size_t{100} << 20U);
    refused = fill(full);
  }
  EXPECT_THAT(refused, testing::HasSubstr("cannot keep"));
  EXPECT_GE(full.size(), Records::kBlock);
  EXPECT_EQ(full.back().key, full.size() - 1) << "what was there stays";
}

}  // namespace
}  // namespace lab
