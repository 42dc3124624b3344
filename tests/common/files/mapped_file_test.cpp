#include "common/files/mapped_file.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <stdexcept>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace lab {
namespace {

constexpr std::size_t kSize_bytes = 1U << 20U;
constexpr std::size_t kLeft_bytes = 100'000;

class MappedFileTest : public testing::Test {
 protected:
  MappedFileTest() { std::ofstream(path_) << std::string(kSize_bytes, 'x'); }

  auto says(const std::string& found) const {
    return testing::ThrowsMessage<std::runtime_error>(
        "cannot go on reading the log " + path_.string() + ": " + found + "; was it made shorter?");
  }

  static std::size_t sum(const MappedFile& file) {
    return std::accumulate(file.bytes().begin(), file.bytes().end(), std::size_t{0});
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "file";
};

TEST_F(MappedFileTest, ReadsAFileThatNothingShortens) {
  const MappedFile dut(path_, "log");
  EXPECT_EQ(sum(dut), kSize_bytes * 'x');
  EXPECT_EQ(dut.part(kSize_bytes - 2, 2).size(), 2U);
  dut.requireWhole();
}

TEST_F(MappedFileTest, SaysAtItsEndThatItHasBecomeShorter) {
  const MappedFile dut(path_, "log");
  std::filesystem::resize_file(path_, kLeft_bytes);
  EXPECT_EQ(sum(dut), kLeft_bytes * 'x') << "the rest reads as zeros";
  EXPECT_THAT([&] { dut.requireWhole(); }, says("found 100000 bytes at byte 0, expected 1048576"));
}

TEST_F(MappedFileTest, SaysThatItLostAFewBytes) {
  const MappedFile dut(path_, "log");
  std::filesystem::resize_file(path_, kSize_bytes - 1);
  EXPECT_EQ(sum(dut), (kSize_bytes - 1) * 'x');
  EXPECT_THAT([&] { dut.requireWhole(); }, says("found 1048575 bytes at byte 0, expected 1048576"));
  EXPECT_THAT([&] { static_cast<void>(dut.part(kSize_bytes - 2, 2)); },
              says("found 1 bytes at byte 1048574, expected 2"));
}

TEST_F(MappedFileTest, SaysThatAPartIsGone) {
  const MappedFile dut(path_, "log");
  std::filesystem::resize_file(path_, kLeft_bytes);
  EXPECT_EQ(dut.part(0, kLeft_bytes).size(), kLeft_bytes);
  EXPECT_THAT([&] { static_cast<void>(dut.part(kLeft_bytes - 10, 10'000)); },
              says("found 10 bytes at byte 99990, expected 10000"));
  EXPECT_THAT([&] { static_cast<void>(dut.part(kSize_bytes - 1, 2)); },
              says("found 0 bytes at byte 1048575, expected 2"));
}

TEST_F(MappedFileTest, GuardsEveryFileOfSeveral) {
  const MappedFile before(path_, "log");
  const MappedFile dut(path_, "log");
  { const MappedFile closed(path_, "log"); }
  std::filesystem::resize_file(path_, 0);
  EXPECT_EQ(sum(dut), 0U);
  EXPECT_EQ(sum(before), 0U);
}

TEST_F(MappedFileTest, LeavesOtherBusErrorsToTheHandlerBefore) {
  const auto read_elsewhere = [this] {
    signal(SIGBUS, [](int) { _exit(7); });
    const MappedFile dut(path_, "log");
    std::filesystem::resize_file(path_, 0);
    const int file = ::open(path_.c_str(), O_RDONLY);
    const void* const other = ::mmap(nullptr, 4096, PROT_READ, MAP_PRIVATE, file, 0);
    _exit(*static_cast<const volatile char*>(other) + static_cast<int>(sum(dut)));
  };
  EXPECT_EXIT(read_elsewhere(), testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace lab
