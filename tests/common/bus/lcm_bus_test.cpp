// The live bus and the limitations of LCM 1.3.1 that it works around, in a private network.
#include "common/bus/lcm_bus.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/process/file_descriptor.hpp"
#include "tests/common/bus/udpm_datagrams.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/wait_until.hpp"

namespace lab {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kPort = 7811;
constexpr int kPatience_ms = 60'000;

std::vector<std::uint8_t> number(int value) {
  return {static_cast<std::uint8_t>(value / 256), static_cast<std::uint8_t>(value % 256)};
}

PacketHandler into(std::vector<int>& heard) {
  return [&heard](const Packet& packet) { heard.push_back(packet.data[0] * 256 + packet.data[1]); };
}

/// Drains `bus` until `count` messages were received, or no more arrive.
void drainUntil(LcmBus& bus, const std::vector<int>& heard, std::size_t count) {
  while (heard.size() < count && bus.drainFor(kPatience_ms)) {
  }
}

TEST(LcmBus, DeliversABurstOfAThousandToABusySubscriber) {  // LCM alone queues 31
  LcmBus sender(lcmUrl(kPort));
  LcmBus dut(lcmUrl(kPort));
  std::vector<int> heard;
  dut.subscribe("BURST", into(heard));
  for (int i = 0; i < 1000; ++i) sender.publish("BURST", number(i));
  drainUntil(dut, heard, 1000);
  std::vector<int> sent(1000);
  std::iota(sent.begin(), sent.end(), 0);
  EXPECT_EQ(heard, sent);
}

TEST(LcmBus, DoesNotStarveTimersInAFlood) {
  constexpr std::size_t kMostInOneDrain = 10'000;
  constexpr std::size_t kFlood = 3 * kMostInOneDrain;
  LcmBus dut(lcmUrl(kPort));
  std::size_t published = 1;
  std::size_t heard = 0;
  dut.subscribe("ECHO", [&](const Packet& packet) {  // each message causes two more
    ++heard;
    for (int i = 0; i < 2 && published < kFlood; ++i, ++published) {
      dut.publish("ECHO", packet.data);
    }
  });
  dut.publish("ECHO", number(1));
  bool any = true;
  for (std::size_t before = 0; any; before = heard) {
    any = dut.drainFor(100);
    ASSERT_LE(heard - before, kMostInOneDrain);
  }
  EXPECT_GT(heard, kMostInOneDrain);
}

/// A service that is slower than its messages: its heartbeat comes between two drains.
TEST(LcmBus, ReturnsToTheLoopWhenHandlersAreSlow) {
  LcmBus sender(lcmUrl(kPort));
  LcmBus dut(lcmUrl(kPort));
  std::size_t heard = 0;
  dut.subscribe("SLOW", [&heard](const Packet&) {
    ++heard;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  });
  constexpr std::size_t kMessages = 500;  // one second of work
  for (std::size_t i = 0; i < kMessages; ++i) sender.publish("SLOW", number(1));
  int drains = 0;
  for (bool any = true; any && heard < kMessages; ++drains) any = dut.drainFor(kPatience_ms);
  EXPECT_EQ(heard, kMessages);
  EXPECT_GE(drains, 5);
}

TEST(LcmBus, TakesChannelNamesLiterally) {  // LCM takes them for regular expressions
  LcmBus dut(lcmUrl(kPort));
  std::vector<int> heard;
  dut.subscribe("ROBOT.1+", into(heard));
  dut.publish("ROBOTX1", number(1));
  dut.publish("ROBOT.11", number(2));
  dut.publish("ROBOT.1", number(3));
  dut.publish("ROBOT.1+", number(4));
  drainUntil(dut, heard, 1);
  EXPECT_THAT(heard, ElementsAre(4));
}

TEST(LcmBus, ThrowsHandlersExceptionsFromDrainAndContinues) {  // LCM alone aborts
  LcmBus dut(lcmUrl(kPort));
  std::vector<int> heard;
  dut.subscribe("A", [](const Packet& packet) {
    if (packet.data[1] < 3) throw std::runtime_error("message " + std::to_string(packet.data[1]));
  });
  dut.subscribe("A", into(heard));
  std::vector<std::string> errors;
  const auto drain = [&](std::size_t until) {
    while (heard.size() < until) {
      try {
        ASSERT_TRUE(dut.drainFor(kPatience_ms));
      } catch (const std::runtime_error& error) {
        errors.emplace_back(error.what());
      }
    }
  };
  dut.publish("A", number(1));
  drain(1);
  dut.publish("A", number(2));
  drain(2);
  dut.publish("A", number(3));
  drain(3);
  EXPECT_THAT(errors, ElementsAre("message 1", "message 2"));
  EXPECT_THAT(heard, ElementsAre(1, 2, 3));
}

TEST(LcmBus, RefusesToDrainInsideAHandler) {  // LCM alone aborts
  LcmBus dut(lcmUrl(kPort));
  dut.subscribe("A", [&](const Packet&) { dut.drain(); });
  dut.publish("A", number(1));
  EXPECT_THROW(dut.drainFor(kPatience_ms), std::logic_error);
}

TEST(LcmBus, ReturnsFromItsWaitOnASignal) {
  LcmBus dut(lcmUrl(kPort));
  std::vector<int> heard;
  dut.subscribe("A", into(heard));
  struct sigaction ignore {};
  ignore.sa_handler = [](int) {};
  sigaction(SIGALRM, &ignore, nullptr);
  // Repeatedly: on a busy machine the first one may come before the wait.
  constexpr timeval kSoon{.tv_sec = 0, .tv_usec = 20'000};
  const itimerval soon{.it_interval = kSoon, .it_value = kSoon};
  AsioLoop clock;
  const std::int64_t start = clock.now();
  ASSERT_EQ(setitimer(ITIMER_REAL, &soon, nullptr), 0);
  EXPECT_FALSE(dut.drainFor(kPatience_ms));
  EXPECT_LT(clock.now() - start, kPatience_ms * 1000);
  const itimerval never{};
  ASSERT_EQ(setitimer(ITIMER_REAL, &never, nullptr), 0);
}

TEST(LcmBus, KnowsForHowLongTheOldestMessageHasWaited) {
  LcmBus dut(lcmUrl(kPort));
  std::vector<int> heard;
  dut.subscribe("A", into(heard));
  EXPECT_EQ(dut.backlog(), 0);
  dut.publish("A", number(1));
  EXPECT_TRUE(waitUntil([&dut] { return dut.backlog() > 50'000; },
                        std::chrono::milliseconds(kPatience_ms)));
  dut.drain();
  EXPECT_THAT(heard, ElementsAre(1));
  EXPECT_EQ(dut.backlog(), 0);
}

TEST(LcmBus, SeparatesLabsByTheirPort) {  // the multicast group does not
  LcmBus ours(lcmUrl(kPort));
  LcmBus theirs(lcmUrl(kPort + 1));
  std::vector<int> heard;
  theirs.subscribeAll(into(heard));
  for (int i = 0; i < 100; ++i) ours.publish("A", number(i));
  theirs.publish("A", number(500));
  drainUntil(theirs, heard, 1);
  EXPECT_THAT(heard, ElementsAre(500));
}

TEST(LcmBus, IgnoresLcmsOwnProbe) {
  LcmBus dut(lcmUrl(kPort));
  std::vector<std::string> heard;
  dut.subscribeAll([&](const Packet& packet) { heard.emplace_back(packet.channel); });
  LcmBus late(lcmUrl(kPort));  // probes
  late.publish("A", number(1));
  while (heard.empty() && dut.drainFor(kPatience_ms)) {
  }
  EXPECT_THAT(heard, ElementsAre("A"));
}

TEST(LcmBus, RefusesAChannelNameThatLcmRefuses) {
  LcmBus dut(lcmUrl(kPort));
  EXPECT_NO_THROW(dut.publish(std::string(63, 'X'), number(1)));
  EXPECT_THROW(dut.publish(std::string(64, 'X'), number(1)), BusError);
}

TEST(LcmBus, ReportsHowToRepairANetworkWithoutMulticast) {  // LCM alone reports nothing
  const auto open_without_route = [] {
    if (unshare(CLONE_NEWNET) != 0) std::exit(99);
    try {
      const LcmBus dut(lcmUrl(kPort));
    } catch (const BusError& error) {
      std::fputs(error.what(), stderr);
      std::exit(2);
    }
    std::exit(0);
  };
  EXPECT_EXIT(open_without_route(), testing::ExitedWithCode(2),
              "sudo ip link set lo up && sudo ip route add 224.0.0.0/4 dev lo");
}

TEST(LcmBus, RefusesAnInvalidUrl) { EXPECT_THROW(LcmBus("carrier-pigeon://"), BusError); }

TEST(LcmUrl, StaysOnThisMachineAndRequestsALargeSocketBuffer) {
  EXPECT_EQ(lcmUrl(7700), "udpm://239.255.76.67:7700?ttl=0&recv_buf_size=4194304");
  EXPECT_EQ(lcmUrl(7700, 1), "udpm://239.255.76.67:7700?ttl=1&recv_buf_size=4194304");
}

TEST(LcmUrl, IsTakenFromTheEnvironmentIfSet) {
  setenv("LCM_DEFAULT_URL", "memq://", 1);
  EXPECT_EQ(defaultLcmUrl(), "memq://");
  unsetenv("LCM_DEFAULT_URL");
  EXPECT_EQ(defaultLcmUrl(), lcmUrl(7667));
}

/// The largest receive buffer of this process's datagram sockets.
int largestReceiveBuffer() {
  int largest = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    const int descriptor = std::stoi(entry.path().filename());
    int type = 0;
    int size = 0;
    socklen_t length = sizeof(int);
    if (getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &length) != 0) continue;
    if (type != SOCK_DGRAM) continue;
    getsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &size, &length);
    largest = std::max(largest, size);
  }
  return largest;
}

TEST(LcmBus, GetsTheLargeSocketBuffer) {
  const LcmBus dut(lcmUrl(kPort));
  const int socket_of_default = socket(AF_INET, SOCK_DGRAM, 0);
  int size = 0;
  socklen_t length = sizeof(int);
  ASSERT_EQ(getsockopt(socket_of_default, SOL_SOCKET, SO_RCVBUF, &size, &length), 0);
  close(socket_of_default);
  EXPECT_GE(largestReceiveBuffer(), 4 * size);
}

TEST(LcmBus, LosesNoMessagesOf60KilobytesAt30Hertz) {
  constexpr int kMessages = 30;
  constexpr std::size_t kSize = 60'000;
  LcmBus sender(lcmUrl(kPort));
  LcmBus dut(lcmUrl(kPort));
  std::vector<int> heard;
  dut.subscribe("BIG", into(heard));
  AsioLoop loop;
  int sent = 0;
  loop.every(1'000'000 / 30, loop.now(), [&] {
    std::vector<std::uint8_t> data = number(sent);
    data.resize(kSize);
    sender.publish("BIG", data);
    if (++sent == kMessages) loop.stop();
  });
  loop.run();
  drainUntil(dut, heard, kMessages);
  EXPECT_EQ(heard.size(), static_cast<std::size_t>(kMessages));
}

TEST(LcmBus, WakesTheLiveLoop) {
  LcmBus dut(lcmUrl(kPort));
  AsioLoop loop;
  std::vector<int> heard;
  dut.subscribe("A", [&](const Packet& packet) {
    into(heard)(packet);
    if (heard.size() < 3) return dut.publish("A", number(static_cast<int>(heard.size())));
    loop.stop();
  });
  loop.onReadable(dut.fileDescriptor(), [&dut] { dut.drain(); });
  loop.soon([&dut] { dut.publish("A", number(0)); });
  loop.run();
  EXPECT_THAT(heard, ElementsAre(0, 1, 2));
}

/// Sends datagrams of any bytes to the bus.
class RawSender {
 public:
  void send(const udpm_test::Datagram& datagram) const {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(kPort);
    to.sin_addr.s_addr = inet_addr("239.255.76.67");
    EXPECT_EQ(sendto(socket_.get(), datagram.data(), datagram.size(), 0,
                     reinterpret_cast<const sockaddr*>(&to), sizeof to),
              static_cast<ssize_t>(datagram.size()));
  }

 private:
  FileDescriptor socket_{socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
};

TEST(LcmBus, SurvivesTheFragmentsThatMakeLiblcmWriteOutOfBounds) {
  LcmBus dut(lcmUrl(kPort));
  std::vector<int> heard;
  dut.subscribeAll(into(heard));
  const RawSender sender;
  std::string content("A\0", 2);
  content += std::string(1000, 'x');
  sender.send(udpm_test::fragment({.message_size = 2000, .fragments = 3}, content));
  // Offset and size add up to 2^32.
  sender.send(udpm_test::fragment(
      {.message_size = 2000, .offset = 0U - 60'000U, .number = 1, .fragments = 3},
      std::string(60'000, 'x')));
  dut.publish("A", number(7));
  drainUntil(dut, heard, 1);
  EXPECT_THAT(heard, ElementsAre(7));
  EXPECT_EQ(dut.refused().of(Refusal::kBadFragment).datagrams, 1);
}

TEST(LcmBus, JoinsMessagesOfSeveralDatagrams) {
  constexpr std::size_t kSize = 1'000'000;
  LcmBus dut(lcmUrl(kPort));
  std::vector<std::uint8_t> data(kSize);
  for (std::size_t i = 0; i < kSize; ++i) data[i] = static_cast<std::uint8_t>(i * i >> 7);
  std::vector<std::uint8_t> heard;
  dut.subscribe("BIG", [&heard](const Packet& packet) {
    heard.assign(packet.data.begin(), packet.data.end());
  });
  dut.publish("BIG", data);
  dut.drainFor(kPatience_ms);
  EXPECT_TRUE(heard == data);
}

TEST(LcmBus, BoundsAndCountsWhatWaits) {
  constexpr std::size_t kSize = 60'000;
  constexpr std::size_t kMost = (64U << 20) / kSize;
  LcmBus sender(lcmUrl(kPort));
  LcmBus dut(lcmUrl(kPort));
  std::size_t heard = 0;
  dut.subscribe("BIG", [&heard](const Packet&) { ++heard; });
  const std::vector<std::uint8_t> data(kSize);
  const auto left_out = [&dut] { return dut.refused().of(Refusal::kQueueFull).datagrams; };
  for (std::size_t i = 0; i < 100 * kMost && left_out() == 0; ++i) sender.publish("BIG", data);
  EXPECT_GT(left_out(), 0);

  while (dut.drainFor(100)) {
  }
  EXPECT_GT(heard, 0U);
  EXPECT_LE(heard, kMost + 200);  // more come while the first are handled
  const std::size_t before = heard;
  sender.publish("BIG", data);
  EXPECT_TRUE(dut.drainFor(kPatience_ms));
  EXPECT_EQ(heard, before + 1);
}

TEST(LcmBus, TakesNoProviderThatReceivesFromEverybody) {
  EXPECT_THROW(LcmBus("mpudpm://239.255.76.67:7811"), BusError);
}

TEST(LcmBus, TakesNoProviderThatWritesFiles) {
  const TemporaryFolder folder;
  const std::string file = folder / "thesis.tex";
  std::ofstream(file) << "kept";
  EXPECT_THAT([&file] { const LcmBus dut("file://" + file + "?mode=w"); },
              testing::ThrowsMessage<BusError>(
                  HasSubstr("found the provider \"file\", expected udpm://GROUP:PORT")));
  EXPECT_EQ(std::filesystem::file_size(file), 4U);
}

TEST(LcmBus, ReceivesInMemoryWithLcm) {
  LcmBus dut("memq://");
  std::vector<int> heard;
  dut.subscribe("A", into(heard));
  dut.publish("A", number(1));
  dut.publish("B", number(2));
  drainUntil(dut, heard, 1);
  EXPECT_THAT(heard, ElementsAre(1));
}

}  // namespace
}  // namespace lab
