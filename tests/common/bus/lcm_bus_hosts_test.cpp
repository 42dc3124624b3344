// The live bus and another computer on its network: host A of two_hosts.sh has the bus, and the
// router, on which the test runs, is its neighbour.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/unicast_sink.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/process/file_descriptor.hpp"
#include "tests/common/bus/udpm_datagrams.hpp"
#include "tests/support/network_hosts.hpp"

namespace lab::udpm_test {
namespace {

using gateway::NetworkNamespaceScope;
using gateway::required;
using testing::AllOf;
using testing::Each;
using testing::Ge;
using testing::SizeIs;

constexpr int kPort = 7811;
constexpr int kAttacks = 40;
constexpr double kPatience = 20;  // [s]
constexpr const char* kGroup = "239.255.76.67";
constexpr const char* kNeighbour = "10.77.1.254";
constexpr const char* kBroadcast = "10.77.1.255";
constexpr std::string_view kOfThisHost = "own";
constexpr std::string_view kForeign = "foreign";

/// Sends from the router to host A.
class Neighbour {
 public:
  Neighbour()
      : udp_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)),
        raw_(socket(AF_INET, SOCK_RAW | SOCK_CLOEXEC, IPPROTO_RAW)) {
    const in_addr interface { inet_addr(kNeighbour) };
    const int on = 1;
    EXPECT_EQ(setsockopt(udp_.get(), SOL_SOCKET, SO_BROADCAST, &on, sizeof on), 0);
    for (const int socket : {udp_.get(), raw_.get()}) {
      EXPECT_EQ(setsockopt(socket, IPPROTO_IP, IP_MULTICAST_IF, &interface, sizeof interface), 0);
    }
  }

  void send(const Datagram& datagram, const char* address) const {
    const sockaddr_in to = addressOf(address);
    EXPECT_EQ(sendto(udp_.get(), datagram.data(), datagram.size(), 0,
                     reinterpret_cast<const sockaddr*>(&to), sizeof to),
              static_cast<ssize_t>(datagram.size()));
  }

  /// Multicast with a source address of its choice.
  void sendAs(const char* source, const Datagram& datagram) const {
    iphdr ip{};
    ip.version = 4;
    ip.ihl = 5;
    ip.ttl = 1;
    ip.protocol = IPPROTO_UDP;
    ip.saddr = inet_addr(source);
    ip.daddr = inet_addr(kGroup);
    udphdr udp{};
    udp.uh_sport = htons(kPort);
    udp.uh_dport = htons(kPort);
    udp.uh_ulen = htons(static_cast<std::uint16_t>(sizeof udp + datagram.size()));
    Datagram packet(sizeof ip + sizeof udp);
    std::memcpy(packet.data(), &ip, sizeof ip);
    std::memcpy(packet.data() + sizeof ip, &udp, sizeof udp);
    packet.insert(packet.end(), datagram.begin(), datagram.end());
    const sockaddr_in to = addressOf(kGroup);
    EXPECT_EQ(sendto(raw_.get(), packet.data(), packet.size(), 0,
                     reinterpret_cast<const sockaddr*>(&to), sizeof to),
              static_cast<ssize_t>(packet.size()));
  }

 private:
  static sockaddr_in addressOf(const char* address) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(kPort);
    to.sin_addr.s_addr = inet_addr(address);
    return to;
  }

  FileDescriptor udp_;
  FileDescriptor raw_;
};

class BusBesideANeighbour : public testing::Test {
 protected:
  void SetUp() override {
    if (!gateway::hostsAreThere()) GTEST_SKIP() << "runs in tests/two_hosts.sh";
    routeMulticast("eth0");  // as on a computer without the route over lo
  }
  void TearDown() override {
    if (gateway::hostsAreThere()) routeMulticast("lo");
  }

  static void routeMulticast(const std::string& device) {
    gateway::wire("on A ip route replace 224.0.0.0/4 dev " + device);
  }

  /// Opens the bus on host A.
  void open(int ttl) {
    const NetworkNamespaceScope there(required("HOST_A"));
    bus_ = std::make_unique<LcmBus>(lcmUrl(kPort, ttl));
    bus_->subscribeAll([this](const Packet& packet) {
      heard_.emplace_back(packet.data.begin(), packet.data.end());
    });
  }

  void publish(std::string_view text) {
    bus_->publish("A", {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }

  /// Publishes a message on host A and waits for it, so that all sent before has come, too.
  void hearOwn() {
    const std::size_t before = heardOf(kOfThisHost);
    publish(kOfThisHost);
    EXPECT_TRUE(until([&] { return heardOf(kOfThisHost) > before; }));
  }

  bool until(const std::function<bool()>& condition) {
    const double end = gateway::steadySeconds() + kPatience;
    while (!condition() && gateway::steadySeconds() < end) bus_->drainFor(10);
    return condition();
  }

  [[nodiscard]] std::size_t heardOf(std::string_view text) const {
    return static_cast<std::size_t>(std::count(heard_.begin(), heard_.end(), text));
  }
  [[nodiscard]] RefusedDatagrams::Count strangers() const {
    return bus_->refused().of(Refusal::kStranger);
  }

  static RefusedDatagrams::Count unicast(const UnicastSink& sink) {
    return sink.refused().of(Refusal::kUnicast);
  }

  Neighbour neighbour_;
  std::unique_ptr<LcmBus> bus_;
  std::vector<std::string> heard_;
};

TEST_F(BusBesideANeighbour, HearsNoUnicastWhetherOpenOrNot) {
  for (const int ttl : {0, 1}) {
    open(ttl);
    for (int i = 0; i < kAttacks; ++i) {
      neighbour_.send(whole("A", kForeign), required("ADDRESS_A").c_str());
    }
    hearOwn();
    EXPECT_THAT(heard_, Each(kOfThisHost)) << "ttl " << ttl;
  }
}

TEST_F(BusBesideANeighbour, HearsNoBroadcastWhetherOpenOrNot) {
  FileDescriptor any;  // takes what is sent to any address of host A
  {
    const NetworkNamespaceScope there(required("HOST_A"));
    any = FileDescriptor(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    const int share = 1;
    setsockopt(any.get(), SOL_SOCKET, SO_REUSEADDR, &share, sizeof share);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(kPort);
    ASSERT_EQ(bind(any.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  for (const int ttl : {0, 1}) {
    open(ttl);
    for (int i = 0; i < kAttacks; ++i) neighbour_.send(whole("A", kForeign), kBroadcast);
    char byte = 0;
    EXPECT_TRUE(until([&] { return recv(any.get(), &byte, 1, MSG_TRUNC) > 0; })) << "it arrives";
    hearOwn();
    EXPECT_THAT(heard_, Each(kOfThisHost)) << "ttl " << ttl;
  }
}

TEST_F(BusBesideANeighbour, RefusesMulticastOfOthersAndNamesThem) {
  open(0);
  for (int i = 0; i < kAttacks; ++i) neighbour_.send(whole("A", kForeign), kGroup);

  EXPECT_TRUE(until([this] { return strangers().datagrams == kAttacks; }));
  EXPECT_TRUE(sourceText(strangers().last).starts_with("10.77.1.254:"));
  hearOwn();
  EXPECT_THAT(heard_, AllOf(SizeIs(Ge(1U)), Each(kOfThisHost)));
}

TEST_F(BusBesideANeighbour, HearsMulticastOfOthersIfTheUrlOpensIt) {
  open(1);
  for (int i = 0; i < kAttacks; ++i) neighbour_.send(whole("A", kForeign), kGroup);

  EXPECT_TRUE(until([this] { return heardOf(kForeign) == kAttacks; }));
  EXPECT_EQ(strangers().datagrams, 0);
  hearOwn();
}

TEST_F(BusBesideANeighbour, IsOpenOnlyToTheNetworkOfItsRoute) {
  routeMulticast("lo");
  // Another program on host A has joined the group on the network card.
  std::unique_ptr<FileDescriptor> other;
  {
    const NetworkNamespaceScope there(required("HOST_A"));
    other = std::make_unique<FileDescriptor>(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    const ip_mreq membership{{inet_addr(kGroup)}, {inet_addr(required("ADDRESS_A").c_str())}};
    ASSERT_EQ(
        setsockopt(other->get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership), 0);
  }
  for (const int ttl : {0, 1}) {
    open(ttl);
    for (int i = 0; i < kAttacks; ++i) neighbour_.send(whole("A", kForeign), kGroup);
    const int counted = ttl == 0 ? kAttacks : 0;
    EXPECT_TRUE(until([&] { return strangers().datagrams == counted; })) << "ttl " << ttl;
    hearOwn();
    EXPECT_THAT(heard_, Each(kOfThisHost)) << "ttl " << ttl;
  }
}

/// The kernel drops datagrams from outside with a source of this machine.
TEST_F(BusBesideANeighbour, HearsNobodyWhoUsesAnAddressOfThisMachine) {
  const std::string own = required("ADDRESS_A");
  for (const int ttl : {0, 1}) {
    open(ttl);
    for (const char* source : {own.c_str(), "127.0.0.1"}) {
      for (int i = 0; i < kAttacks; ++i) neighbour_.sendAs(source, whole("A", kForeign));
    }
    neighbour_.sendAs("10.77.1.77", whole("A", kForeign));

    if (ttl == 0) {
      EXPECT_TRUE(until([this] { return strangers().datagrams > 0; }));
      EXPECT_EQ(strangers().datagrams, 1);
      EXPECT_EQ(sourceText(strangers().last), "10.77.1.77:7811");
    } else {
      EXPECT_TRUE(until([this] { return heardOf(kForeign) > 0; }));
    }
    hearOwn();
    EXPECT_EQ(heardOf(kForeign), static_cast<std::size_t>(ttl));
  }
}

TEST_F(BusBesideANeighbour, HasASinkThatKeepsUnicastAwayFromStockPrograms) {
  const std::string address = required("ADDRESS_A");
  std::unique_ptr<FileDescriptor> stock;  // as liblcm 1.3.1 opens it
  std::unique_ptr<UnicastSink> dut;
  {
    const NetworkNamespaceScope there(required("HOST_A"));
    stock = std::make_unique<FileDescriptor>(
        socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    const int share = 1;
    setsockopt(stock->get(), SOL_SOCKET, SO_REUSEADDR, &share, sizeof share);
    sockaddr_in any{};
    any.sin_family = AF_INET;
    any.sin_port = htons(kPort);
    ASSERT_EQ(bind(stock->get(), reinterpret_cast<const sockaddr*>(&any), sizeof any), 0);
    dut = std::make_unique<UnicastSink>(kPort);
  }
  const auto attack = [&] { neighbour_.send(whole("A", kForeign), address.c_str()); };
  const auto waits = [](int descriptor) {
    pollfd readable{descriptor, POLLIN, 0};
    return poll(&readable, 1, static_cast<int>(kPatience * 1e3)) == 1;
  };

  for (int i = 0; i < kAttacks; ++i) attack();
  const double end = gateway::steadySeconds() + kPatience;
  while (unicast(*dut).datagrams < kAttacks && gateway::steadySeconds() < end) {
    const NetworkNamespaceScope there(required("HOST_A"));
    dut->update();
  }
  EXPECT_EQ(unicast(*dut).datagrams, kAttacks);
  EXPECT_TRUE(sourceText(unicast(*dut).last).starts_with("10.77.1.254:"));
  char byte = 0;
  EXPECT_LT(recv(stock->get(), &byte, 1, 0), 0);
  dut.reset();
  attack();
  EXPECT_TRUE(waits(stock->get()));
}

TEST_F(BusBesideANeighbour, KeepsTimersAndMessagesInAFloodOfOthers) {
  constexpr int kTicks = 100;
  constexpr int kPerTick = 200;  // each 10 ms: 20 000 datagrams/s
  open(0);
  AsioLoop loop;
  loop.onReadable(bus_->fileDescriptor(), [this] { bus_->drain(); });
  int ticks = 0;
  loop.every(10'000, loop.now(), [&] {
    if (++ticks > kTicks) return;
    for (int i = 0; i < kPerTick; ++i) neighbour_.send(whole("A", kForeign), kGroup);
    publish(kOfThisHost);
  });
  const std::int64_t give_up = loop.now() + static_cast<std::int64_t>(kPatience * 1e6);
  loop.every(5'000, loop.now(), [&] {
    const std::int64_t counted =
        strangers().datagrams + bus_->refused().of(Refusal::kReceiveBuffer).datagrams;
    const bool all = counted >= kTicks * kPerTick && heardOf(kOfThisHost) == kTicks;
    if (all || loop.now() > give_up) loop.stop();
  });
  loop.run();
  EXPECT_EQ(heardOf(kOfThisHost), static_cast<std::size_t>(kTicks));
  EXPECT_EQ(heard_.size(), static_cast<std::size_t>(kTicks));
  EXPECT_EQ(strangers().datagrams, kTicks * kPerTick);
}

}  // namespace
}  // namespace lab::udpm_test
