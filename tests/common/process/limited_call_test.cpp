#include "common/process/limited_call.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace lab::limited_call_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

std::string failureOf(const CallLimits& limits, const std::function<std::string()>& work) {
  try {
    return "returned " + callLimited(limits, work);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

TEST(LimitedCall, ReturnsWhatTheWorkReturns) {
  const std::string much(1'000'000, 'x');

  EXPECT_EQ(callLimited({}, [] { return std::string(); }), "");
  EXPECT_EQ(callLimited({}, [&] { return much; }), much);
}

TEST(LimitedCall, ThrowsWhatTheWorkThrows) {
  EXPECT_EQ(failureOf({}, []() -> std::string { throw std::runtime_error("no such table"); }),
            "no such table");
}

TEST(LimitedCall, SaysTheSignalThatEndedTheWork) {
  EXPECT_THAT(failureOf({},
                        []() -> std::string {
                          raise(SIGSEGV);
                          return "";
                        }),
              HasSubstr("killed by signal 11"));
}

TEST(LimitedCall, EndsWorkThatComputesTooLong) {
  EXPECT_EQ(failureOf({.processor = 1s},
                      []() -> std::string {
                        for (std::atomic<int> count = 0;; ++count) {
                        }
                      }),
            "found no end after 1 s of computing");
}

TEST(LimitedCall, EndsWorkThatWritesTooMuch) {
  const TemporaryFolder folder;
  const auto write = [&]() -> std::string {
    std::ofstream file(folder / "large");
    const std::string block(1'000'000, 'x');
    for (int i = 0; i < 5; ++i) file << block << std::flush;
    return "";
  };

  EXPECT_EQ(failureOf({.file_bytes = 3'000'000}, write), "holds more than 3 MB");
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(LimitedCall, EndsWorkThatTakesTooMuchMemory) {
  const auto take = []() -> std::string {
    const std::vector<char> much(300'000'000, 'x');
    return std::to_string(much.size());
  };

  EXPECT_EQ(failureOf({.memory_bytes = 200'000'000}, take), "needs more than 200 MB of memory");
}
#endif

TEST(LimitedCall, OpensNoFileAfterItWasRefused) {
#ifdef __SANITIZE_ADDRESS__
  constexpr int kSpare = 2;  // descriptors for the sanitizers' check of types
#else
  constexpr int kSpare = 0;
#endif
  const TemporaryFolder folder;
  const auto open = []() -> std::string {
    refuseFurtherFiles();
    int opened = 0;
    while (opened < 10 && ::open("/dev/null", O_RDONLY) >= 0) ++opened;
    return std::to_string(opened);
  };

  EXPECT_EQ(callLimited({}, open), std::to_string(kSpare));
  EXPECT_TRUE(std::ofstream(folder / "afterwards"));
}

TEST(LimitedCall, IsOverWhenThisProcessIsAskedToEnd) {
  const pid_t self = getpid();
  const auto ask = [&]() -> std::string {
    kill(self, SIGTERM);
    while (true) pause();
  };

  EXPECT_THAT(failureOf({}, ask), HasSubstr("interrupted (Terminated)"));
}

}  // namespace
}  // namespace lab::limited_call_test
