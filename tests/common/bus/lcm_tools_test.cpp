// Compatibility with Debian's lcm-logger and lcm-logplayer.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm.h>
#include <spawn.h>
#include <sys/wait.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/bus/log_file.hpp"
#include "common/files/file_text.hpp"
#include "common/loop/asio_loop.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::stock_tools_test {
namespace {

namespace fs = std::filesystem;

constexpr int kPort = 7811;
constexpr int kPatience_ms = 60'000;
constexpr std::int64_t kMillisecond = 1'000;

/// A program that runs during the test.
class Process {
 public:
  explicit Process(std::vector<std::string> words) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (posix_spawnp(&pid_, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0) {
      throw std::runtime_error("cannot start " + words[0]);
    }
  }
  ~Process() {
    if (pid_ > 0) terminate();
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  int terminate() {
    kill(pid_, SIGTERM);
    return wait();
  }
  int wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  /// Whether all threads wait for work. On a loaded machine this takes longer than a fixed time.
  [[nodiscard]] bool sleeps() const {
    for (const auto& task : fs::directory_iterator(fmt::format("/proc/{}/task", pid_))) {
      std::ifstream stat(task.path() / "stat");
      const std::string text{std::istreambuf_iterator<char>(stat), {}};
      // "PID (name) state ...": the name may contain anything.
      if (text.compare(text.rfind(')') + 1, 2, " S") != 0) return false;
    }
    return true;
  }

 private:
  pid_t pid_ = 0;
};

std::vector<std::uint8_t> number(int value) {
  return {static_cast<std::uint8_t>(value / 256), static_cast<std::uint8_t>(value % 256)};
}

/// The numbers on `channel` of a log, which may still be written.
std::vector<int> numbersIn(const fs::path& path, std::string_view channel) {
  std::vector<int> numbers;
  if (!fs::exists(path)) return numbers;
  readLog({path}, [&](const Packet& packet) {
    if (packet.channel == channel) numbers.push_back(packet.data[0] * 256 + packet.data[1]);
  });
  return numbers;
}

class StockTools : public testing::Test {
 protected:
  /// Records with lcm-logger what `publish(i)` sends at each of `ticks` ticks.
  void record(int ticks, std::int64_t period_us, const std::function<void(int)>& publish) {
    // LCM's own probe shows when a program has joined the bus.
    const std::unique_ptr<lcm_t, decltype(&lcm_destroy)> probe(lcm_create(lcmUrl(kPort).c_str()),
                                                               &lcm_destroy);
    bool joined = false;
    lcm_subscribe(
        probe.get(), channels::kLcmSelfTest.data(),
        [](const lcm_recv_buf_t*, const char*, void* flag) { *static_cast<bool*>(flag) = true; },
        &joined);
    Process logger({"lcm-logger", "-q", "--lcm-url=" + lcmUrl(kPort), log_.string()});
    while (!joined && lcm_handle_timeout(probe.get(), kPatience_ms) > 0) {
    }
    ASSERT_TRUE(joined);

    AsioLoop loop;
    int tick = 0;
    const int run_in = static_cast<int>(100 * kMillisecond / period_us);
    const std::int64_t give_up = loop.now() + kPatience_ms * kMillisecond;
    loop.every(period_us, loop.now(), [&] {
      if (!logger.sleeps()) return;
      ++tick;
      if (tick > run_in && tick <= run_in + ticks) return publish(tick - run_in - 1);
      // Sent before, because the logger may still be starting; and after, because the logger writes
      // only when more messages arrive.
      bus_.publish("TICK", number(0));
      if (tick < run_in + ticks || tick % 10 != 0) return;
      const std::vector<int> numbers = numbersIn(log_, "LAST");
      if (!numbers.empty() || loop.now() > give_up) loop.stop();
      bus_.publish("LAST", number(0));
    });
    loop.run();
    EXPECT_EQ(logger.terminate(), 0);
  }

  TemporaryFolder folder_;
  fs::path log_ = folder_ / "log.lcmlog";
  LcmBus bus_{lcmUrl(kPort)};
};

TEST_F(StockTools, LoggerRecordsOurBusWithOurOptions) {
  record(100, 2 * kMillisecond, [this](int i) { bus_.publish("A", number(i)); });
  const std::vector<int> recorded = numbersIn(log_, "A");
  ASSERT_EQ(recorded.size(), 100U);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(recorded[static_cast<std::size_t>(i)], i);
}

TEST_F(StockTools, LoggerKeepsBurstsBelowItsLimit) {  // it queues 31 messages
  constexpr int kBurst = 28;                          // largest burst in lcmtypes/README.md
  record(20, 10 * kMillisecond, [this](int i) {
    for (int k = 0; k < kBurst; ++k) bus_.publish("A", number(kBurst * i + k));
  });
  EXPECT_EQ(numbersIn(log_, "A").size(), 20U * kBurst);
}

TEST_F(StockTools, OurWriterWritesTheSameFileAsTheLogger) {
  record(50, 2 * kMillisecond, [this](int i) { bus_.publish(i % 2 != 0 ? "A" : "BB", number(i)); });
  const fs::path ours = folder_ / "ours.lcmlog";
  {
    LogWriter writer(ours);
    readLog({log_}, [&writer](const Packet& packet) { writer.write(packet); });
  }
  EXPECT_GT(fs::file_size(log_), 50U * 28U);
  EXPECT_EQ(readWholeFile(ours).value_or(""), readWholeFile(log_).value_or(""));
}

TEST_F(StockTools, PlayerPlaysALogOfOurWriter) {
  {
    LogWriter writer(log_);
    for (int i = 0; i < 200; ++i) writer.write({"A", number(i), 946'684'800'000'000 + i * 500});
  }
  std::vector<int> heard;
  bus_.subscribe(
      "A", [&](const Packet& packet) { heard.push_back(packet.data[0] * 256 + packet.data[1]); });
  Process player({"lcm-logplayer", "-l", lcmUrl(kPort), log_.string()});
  while (heard.size() < 200 && bus_.drainFor(kPatience_ms)) {
  }
  EXPECT_EQ(player.wait(), 0);
  ASSERT_EQ(heard.size(), 200U);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(heard[static_cast<std::size_t>(i)], i);
}

}  // namespace
}  // namespace lab::stock_tools_test
