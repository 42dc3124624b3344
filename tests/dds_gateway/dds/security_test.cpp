// DDS Security with the certificates of docs/examples/dds_security/make_certificates.sh.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "dds_gateway/dds/configuration.hpp"
#include "dds_gateway/dds/error.hpp"
#include "dds_gateway/ros/ros_type.hpp"
#include "tests/dds_gateway/peers/cdr.hpp"
#include "tests/dds_gateway/peers/peer.hpp"
#include "tests/dds_gateway/peers/peer_loop.hpp"

namespace lab::dds {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::Not;
using testing::StartsWith;

const ros::RosType& kType = ros::rosType<ros::Float64>();

/// Certificates for all tests of this file, made in two calls; the second adds to the first.
const fs::path& certificates() {
  static const fs::path kFolder = [] {
    std::string folder = (fs::path(testing::TempDir()) / "lab_dds_XXXXXX").string();
    if (mkdtemp(folder.data()) == nullptr) throw std::runtime_error(folder);
    const std::string script = LAB_ROOT "/docs/examples/dds_security/make_certificates.sh ";
    const std::string made = script + folder + "/ours lab >/dev/null && " + script + folder +
                             "/ours bench --watch viewer >/dev/null && " + script + folder +
                             "/foreign bench >/dev/null";
    if (std::system(made.c_str()) != 0) throw std::runtime_error(made);
    return fs::path(folder);
  }();
  return kFolder;
}

struct Cleanup : testing::Environment {
  void TearDown() override { fs::remove_all(certificates()); }
};
const testing::Environment* const kCleanup = testing::AddGlobalTestEnvironment(new Cleanup);

/// @param who "ours/lab", empty: without security
std::string configuration(const std::string& who) {
  return networkConfiguration({.address = "127.0.0.1",
                               .peers = {"127.0.0.1"},
                               .multicast = false,
                               .security = who.empty() ? "" : (certificates() / who).string()});
}

std::vector<std::string> peerAs(const std::string& who) {
  return {LAB_CYCLONE_PEER, "0", configuration(who)};
}

std::string endpoint(const std::string& what, const std::string& topic) {
  return what + " " + topic + " " + kType.descriptor->m_typename;
}

/// All hosts of a run have the same certificate; other programs have their own.
class Secured : public testing::TestWithParam<std::string> {};

TEST_P(Secured, TalkBothWays) {
  const Domain dut(0, configuration("ours/lab"), "test");
  const EventDescriptor waker;
  Writer writer(dut, *kType.descriptor, "rt/out", ros::latchedQos(kType));
  Reader reader(dut, *kType.descriptor, "rt/in", ros::defaultQos(kType), waker);
  Peer bench(peerAs(GetParam()));
  bench.say(endpoint("reader", "rt/out") + " latched");
  bench.say(endpoint("writer", "rt/in") + " latched");
  const ros::Float64 sample{0.5};
  ASSERT_TRUE(writer.write(&sample));
  const std::string payload = hexOf(ros::Cdr().f64(0.5).payload());
  EXPECT_TRUE(eventually([&] { return bench.got("rt/out") == std::vector{payload}; }));
  EXPECT_TRUE(eventually([&] { return reader.matching().peers == 1; }));
  ASSERT_TRUE(bench.says("matched rt/in 1"));
  bench.say("write rt/in " + payload);
  EXPECT_TRUE(eventually([&] { return reader.take(1, [](const void*, WriterId) {}) == 1; }));
}

INSTANTIATE_TEST_SUITE_P(Certificates, Secured, testing::Values("ours/bench", "ours/lab"),
                         [](const auto& who) { return who.param.substr(5); });

TEST(Security, ParticipantsWithoutCertificateNeitherReceiveNorAreReceived) {
  const Domain dut(0, configuration("ours/lab"), "test");
  const EventDescriptor waker;
  Writer writer(dut, *kType.descriptor, "rt/out", ros::latchedQos(kType));
  Reader reader(dut, *kType.descriptor, "rt/in", ros::defaultQos(kType), waker);
  const ros::Float64 sample{0.5};
  ASSERT_TRUE(writer.write(&sample));
  Peer unsecured(peerAs(""));
  Peer second(peerAs(""));
  Peer foreign(peerAs("foreign/bench"));
  for (Peer* one : {&unsecured, &foreign}) {
    one->say(endpoint("reader", "rt/out") + " latched");
    one->say(endpoint("writer", "rt/in"));
    one->say(endpoint("writer", "rt/alone"));
    one->say("write rt/in " + hexOf(ros::Cdr().f64(1).payload()));
  }
  // When the other participants have found each other, they have found us too, or never will.
  second.say(endpoint("reader", "rt/alone"));
  ASSERT_TRUE(second.says("matched rt/alone 1"));
  Peer bench(peerAs("ours/bench"));
  bench.say(endpoint("reader", "rt/out") + " latched");
  ASSERT_TRUE(eventually([&] { return !bench.got("rt/out").empty(); }));
  EXPECT_EQ(writer.matching().peers, 1);
  EXPECT_EQ(reader.matching().joined, 0);
  EXPECT_EQ(reader.take(1, [](const void*, WriterId) {}), 0);
  for (Peer* one : {&unsecured, &foreign}) {
    EXPECT_THAT(one->got("rt/out"), testing::IsEmpty());
    EXPECT_THAT(one->heard(), Not(Contains("matched rt/out 1")));
    EXPECT_THAT(one->heard(), Not(Contains("matched rt/in 1")));
  }
}

/// Captures all packets on lo during its life, as one text.
class Wire {
 public:
  Wire() : socket_(socket(AF_PACKET, SOCK_RAW, htons(ETH_P_IP))) {
    const timeval patience{0, 20'000};
    if (socket_ < 0 ||
        setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience)) != 0) {
      throw std::runtime_error("no packet socket");
    }
    thread_ = std::jthread([this](const std::stop_token& stop) {
      std::array<char, 65536> packet{};
      while (!stop.stop_requested()) {
        const ssize_t size = recv(socket_, packet.data(), packet.size(), 0);
        if (size > 0) seen_.append(packet.data(), static_cast<std::size_t>(size));
      }
    });
  }
  ~Wire() {
    thread_ = {};
    close(socket_);
  }
  Wire(const Wire&) = delete;
  Wire& operator=(const Wire&) = delete;

  /// Ends the capture; no packet may have been missed.
  std::string seen() {
    thread_.request_stop();
    thread_.join();
    tpacket_stats missed{};
    socklen_t size = sizeof(missed);
    EXPECT_EQ(getsockopt(socket_, SOL_PACKET, PACKET_STATISTICS, &missed, &size), 0);
    EXPECT_EQ(missed.tp_drops, 0U);
    return seen_;
  }

 private:
  int socket_;
  std::string seen_;
  std::jthread thread_;
};

/// Two participants that exchange a secret text.
std::string wireOf(const std::string& us, const std::string& them) {
  Wire wire;
  const ros::RosType& type = ros::rosType<ros::String>();
  const Domain dut(0, configuration(us), "test");
  Writer writer(dut, *type.descriptor, "rt/hidden_topic", ros::latchedQos(type));
  std::string secret = "where the robots are";
  const ros::String sample{secret.data()};
  EXPECT_TRUE(writer.write(&sample));
  Peer peer(peerAs(them));
  peer.say("reader rt/hidden_topic " + std::string(type.descriptor->m_typename) + " latched");
  EXPECT_TRUE(eventually([&] { return !peer.got("rt/hidden_topic").empty(); }));
  return wire.seen();
}

TEST(Security, DataAndTopicNamesAreEncryptedOnTheWire) {
  const std::string open = wireOf("", "");
  EXPECT_NE(open.find("where the robots are"), std::string::npos);
  EXPECT_NE(open.find("hidden_topic"), std::string::npos);
  const std::string secured = wireOf("ours/lab", "ours/bench");
  EXPECT_GT(secured.size(), open.size());
  EXPECT_EQ(secured.find("where the robots are"), std::string::npos);
  EXPECT_EQ(secured.find("hidden_topic"), std::string::npos);
}

TEST(Security, AReadOnlyParticipantCannotWrite) {
  const Domain dut(0, configuration("ours/lab"), "test");
  Writer writer(dut, *kType.descriptor, "rt/out", ros::latchedQos(kType));
  const ros::Float64 sample{0.5};
  ASSERT_TRUE(writer.write(&sample));
  Peer viewer(peerAs("ours/viewer"));
  viewer.say(endpoint("reader", "rt/out") + " latched");
  EXPECT_TRUE(eventually([&] { return !viewer.got("rt/out").empty(); }));
  viewer.say(endpoint("writer", "rt/in"));
  EXPECT_TRUE(eventually([&] {
    return std::ranges::any_of(viewer.heard(), [](const std::string& line) {
      return line.starts_with("error writer rt/in") && line.ends_with("Not Allowed By Security");
    });
  }));
}

TEST(Security, WrongCertificatesAreAnErrorAtOnce) {
  const fs::path mixed = certificates() / "mixed";
  fs::remove_all(mixed);
  fs::copy(certificates() / "ours/lab", mixed);
  fs::copy_file(certificates() / "foreign/bench/cert.pem", mixed / "cert.pem",
                fs::copy_options::overwrite_existing);
  try {
    const Domain dut(0, configuration("mixed"), "link.security");
    FAIL() << "no error";
  } catch (const DdsError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("link.security"),
                                             testing::HasSubstr("Certificate not valid")));
  }
}

}  // namespace
}  // namespace lab::dds
