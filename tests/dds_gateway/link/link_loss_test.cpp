/// The link over a network that loses frames (tests/two_hosts.sh --loss 2).
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <lab/light_command_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <string_view>
#include <vector>

#include "common/math/percentiles.hpp"
#include "tests/support/network_hosts.hpp"

namespace lab::gateway {
namespace {

constexpr std::size_t kLargePacket = 20'000;  // 15 frames on the wire

struct Stream {
  std::size_t from;
  const char* sender;
  std::string_view channel;
  double rate;
  std::function<std::vector<std::uint8_t>(const Stream&, std::int64_t)> make;
  std::vector<double> sent = {};
};

std::vector<std::uint8_t> frame(const Stream& stream, std::int64_t seq) {
  tracked_frame_t frame{};
  frame.num_robots = 20;
  frame.robots.resize(20);
  return message(stream.sender, seq, frame);
}

std::vector<std::uint8_t> large(const Stream& stream, std::int64_t seq) {
  light_command_t command{};
  command.label.resize(kLargePacket, 'x');
  return message(stream.sender, seq, command);
}

std::vector<std::uint8_t> command(const Stream& stream, std::int64_t seq) {
  return message<robot_command_t>(stream.sender, seq);
}

/// Frames and large messages at 50 Hz and commands at 5 Hz, both ways: all must be delivered.
void deliverAll(double seconds) {
  Hosts hosts({"A", "B"});
  const auto a = hosts.gateway(0, 0, 0.1);
  const auto b = hosts.gateway(1, 0, 0.1);
  ASSERT_TRUE(hosts.untilState(link_peer_t::JOINED, 1, 20));
  std::vector<Stream> streams{{0, "tracker", channels::kTrackedFrame, 50, frame},
                              {0, "light", channels::kLightCommand, 50, large},
                              {1, "runner", channels::kRobotCommand, 5, command},
                              {1, "painter", channels::kLightCommand, 50, large}};
  hosts.publishing(50, seconds, [&](int i) {
    for (Stream& stream : streams) {
      if (i % static_cast<int>(50 / stream.rate) != 0) continue;
      const auto bytes = stream.make(stream, std::ssize(stream.sent) + 1);
      stream.sent.push_back(steadySeconds());
      hosts[stream.from].bus->publish(stream.channel, bytes);
    }
  });
  for (const Stream& stream : streams) {
    hosts.untilHeard(1 - stream.from, stream.sender, stream.channel, std::ssize(stream.sent),
                     kLong);
  }
  hosts.run(2);  // for a report of the counts
  for (const Stream& stream : streams) {
    const Host& there = hosts[1 - stream.from];
    const auto heard = there.of(stream.sender, stream.channel);
    ASSERT_EQ(heard.size(), stream.sent.size()) << stream.sender;
    std::vector<double> delays;
    for (std::size_t i = 0; i < heard.size(); ++i) {
      ASSERT_EQ(heard[i].seq, static_cast<std::int64_t>(i) + 1) << stream.sender;
      delays.push_back(1e3 * (heard[i].came - stream.sent[i]));
    }
    const Percentiles p = percentilesOf(delays);
    std::printf("%-8s %5zu of %5zu, p50 %.2f ms, p95 %.1f ms, p99 %.1f ms, max %.1f ms\n",
                stream.sender, heard.size(), stream.sent.size(), p.p50, p.p95, p.p99, p.max);
  }
  for (std::size_t host = 0; host < 2; ++host) {
    const link_peer_t peer = hosts[host].status.peers.at(0);
    EXPECT_EQ(peer.lost, 0);
    EXPECT_EQ(peer.repeated, 0);
    EXPECT_EQ(peer.stale, 0);
    EXPECT_EQ(hosts[host].status.timeouts, 0);
    std::printf("%s: clock %.3f ms +- %.3f ms, round trip %.2f ms\n", hosts[host].name.c_str(),
                1e3 * peer.clock_offset, 1e3 * peer.clock_error, 1e3 * peer.round_trip);
  }
}

TEST(LinkLoss, LosesNothing) { deliverAll(6); }

TEST(LinkLossLong, LosesNothingInAMinute) { deliverAll(60); }

}  // namespace
}  // namespace lab::gateway
