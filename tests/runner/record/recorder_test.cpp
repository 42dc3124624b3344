// The program `recorder` on a bus.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <lab/service_status_t.hpp>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/lcm_bus.hpp"
#include "common/bus/log_file.hpp"
#include "common/process/file_descriptor.hpp"
#include "tests/common/bus/udpm_datagrams.hpp"
#include "tests/support/lab_process.hpp"

namespace lab::system_test::recorder_test {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::ContainsRegex;
using testing::HasSubstr;

constexpr int kPort = 24691;

struct Recorded {
  std::vector<int> numbers;      ///< on the channel A
  std::int64_t counted_out = 0;  ///< lost before the recorder, by its own last count
  bool has_end = false;          ///< its own last heartbeat
};

Recorded readRecorded(const fs::path& log) {
  Recorded recorded;
  static_cast<void>(readLog({log}, [&recorded](const Packet& packet) {
    if (packet.channel == "A") recorded.numbers.push_back(packet.data[0] * 256 + packet.data[1]);
    service_status_t status{};
    if (packet.channel != channels::kServiceStatus || !decode(packet.data, status)) return;
    if (status.sender != "recorder") return;
    recorded.has_end = status.state == service_status_t::ENDED;
    recorded.counted_out = 0;
    for (const stream_count_t& row : status.received) recorded.counted_out += row.lost;
  }));
  return recorded;
}

class Recorder : public testing::Test {
 protected:
  [[nodiscard]] std::string command(const std::string& more = "") const {
    return "recorder --log " + log().string() + " --lcm-url '" + lcmUrl(kPort) + "' " + more;
  }
  [[nodiscard]] fs::path log() const { return folder_.path() / "log.lcmlog"; }

  static bool waitUntilWritten(const fs::path& file) {
    return waitUntil([&] { return fs::exists(file) && fs::file_size(file) > 0; }, seconds(10));
  }

  void publish(int number) {
    std::vector<std::uint8_t> data(100);
    data[0] = static_cast<std::uint8_t>(number / 256);
    data[1] = static_cast<std::uint8_t>(number % 256);
    bus_.publish("A", data);
  }

  TemporaryFolder folder_;
  LcmBus bus_{lcmUrl(kPort)};
};

TEST_F(Recorder, RecordsWhatLcmLoggerRecordsAtTwentyThousandMessagesPerSecond) {
  constexpr int kMessages = 20'000;
  constexpr int kInOneTick = 200;
  const fs::path stock_log = folder_.path() / "stock.lcmlog";
  Background recorder("exec " + command());
  Background stock("exec lcm-logger -q '--lcm-url=" + lcmUrl(kPort) + "' " + stock_log.string());
  ASSERT_TRUE(waitUntilWritten(log())) << recorder.output();
  ASSERT_TRUE(waitUntilWritten(stock_log)) << "the heartbeat of the recorder is on the bus";

  auto tick = std::chrono::steady_clock::now();
  for (int i = 0; i < kMessages; ++i) {
    publish(i);
    if (i % kInOneTick == kInOneTick - 1) std::this_thread::sleep_until(tick += milliseconds(10));
  }
  recorder.signal(SIGTERM);
  const Finished ended = recorder.wait(seconds(20));
  stock.signal(SIGTERM);
  stock.wait(seconds(20));

  EXPECT_EQ(ended.exit_code, 0) << ended.output;
  EXPECT_THAT(ended.output, ContainsRegex("recorded [0-9]+ messages, [0-9.]+ MB\n$"));
  const Recorded ours = readRecorded(log());
  EXPECT_TRUE(ours.has_end);
  EXPECT_EQ(static_cast<std::int64_t>(ours.numbers.size()) + ours.counted_out, kMessages);
  EXPECT_TRUE(std::ranges::is_sorted(ours.numbers));
  const std::size_t of_stock = readRecorded(stock_log).numbers.size();
  EXPECT_GE(ours.numbers.size(), of_stock);
  std::printf("of %d messages: %zu recorded, %zu by lcm-logger\n", kMessages, ours.numbers.size(),
              of_stock);
}

TEST_F(Recorder, StockPlayerPlaysItsLog) {
  {
    Background recorder("exec " + command());
    ASSERT_TRUE(waitUntilWritten(log())) << recorder.output();
    for (int i = 0; i < 50; ++i) publish(i);
    recorder.signal(SIGTERM);
    ASSERT_EQ(recorder.wait(seconds(20)).exit_code, 0);
  }
  std::vector<int> heard;
  bus_.subscribe(
      "A", [&](const Packet& packet) { heard.push_back(packet.data[0] * 256 + packet.data[1]); });
  // drainFor() also handles what was sent above.
  while (bus_.drainFor(0)) {
  }
  heard.clear();
  Background player("exec lcm-logplayer -s 10 -l '" + lcmUrl(kPort) + "' " + log().string());
  while (heard.size() < 50 && bus_.drainFor(5000)) {
  }
  EXPECT_EQ(heard.size(), 50U);
}

TEST_F(Recorder, HasInTheFileWhatCameASecondBeforeItWasKilled) {
  Background recorder("exec " + command());
  ASSERT_TRUE(waitUntilWritten(log())) << recorder.output();
  publish(7);
  const auto sent = std::chrono::steady_clock::now();
  ASSERT_TRUE(waitUntil([&] { return !readRecorded(log()).numbers.empty(); }, seconds(10)));
  EXPECT_LT(std::chrono::steady_clock::now() - sent, seconds(5));  // 0.1 s on an idle machine
  recorder.signal(SIGKILL);
  recorder.wait(seconds(10));
  EXPECT_EQ(readRecorded(log()).numbers, std::vector<int>{7});
}

/// Two fragments whose offset and size add up to 2^32 make liblcm write out of bounds.
TEST_F(Recorder, OutlivesForgedFragmentsAndCountsThem) {
  Background recorder("exec " + command());
  ASSERT_TRUE(waitUntilWritten(log())) << recorder.output();
  const FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(kPort);
  inet_pton(AF_INET, "239.255.76.67", &group.sin_addr);
  const std::string data(1000, 'x');
  const std::string more(60'000, 'y');
  for (const udpm_test::Datagram& datagram :
       {udpm_test::fragment({.message_size = 2000, .fragments = 3},
                            std::string("LIGHT_COMMAND\0", 14) + data),
        udpm_test::fragment(
            {.message_size = 2000, .offset = 0xFFFFFFFF - 59'999, .number = 1, .fragments = 3},
            more)}) {
    ASSERT_EQ(sendto(socket.get(), datagram.data(), datagram.size(), 0,
                     reinterpret_cast<const sockaddr*>(&group), sizeof group),
              static_cast<ssize_t>(datagram.size()));
  }
  publish(3);
  ASSERT_TRUE(waitUntil([&] { return !readRecorded(log()).numbers.empty(); }, seconds(10)));
  recorder.signal(SIGTERM);
  const Finished ended = recorder.wait(seconds(20));
  EXPECT_EQ(ended.exit_code, 0) << ended.output;
  EXPECT_THAT(ended.output, HasSubstr("the bus refused 1: "));
}

TEST_F(Recorder, SaysThatTheDiskIsFull) {
  Background recorder("trap '' XFSZ; ulimit -f 64; exec " + command());
  ASSERT_TRUE(waitUntilWritten(log())) << recorder.output();
  for (int i = 0; i < 2000; ++i) publish(i);
  const Finished ended = recorder.wait(seconds(20));
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.output,
              HasSubstr("cannot go on writing " + log().string() + ": the disk is full or gone"));
}

TEST_F(Recorder, RefusesToOverwriteALog) {
  ASSERT_EQ(run("echo old >" + log().string()).exit_code, 0);
  const Finished refused = run(command());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, HasSubstr("--log"));
  EXPECT_EQ(readFile(log()), "old\n");
}

}  // namespace
}  // namespace lab::system_test::recorder_test
