/// The link between hosts that are connected only by a router (tests/two_hosts.sh --hosts 3).
#include <gmock/gmock.h>

#include <cstdint>
#include <lab/light_command_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/network_hosts.hpp"

namespace lab::gateway {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing::SizeIs;

std::vector<std::uint8_t> status(const std::string& sender, std::int64_t seq) {
  return message<robot_status_t>(sender, seq);
}

std::vector<std::int64_t> receivedUntil(std::int64_t count) {
  std::vector<std::int64_t> numbers;
  for (std::int64_t i = 1; i <= count; ++i) numbers.push_back(i);
  return numbers;
}

std::vector<std::int64_t> seqs(const std::vector<Message>& messages) {
  std::vector<std::int64_t> numbers;
  for (const Message& message : messages) numbers.push_back(message.seq);
  return numbers;
}

TEST(LinkHosts, PassesBothWaysUnchangedOnceAndInOrder) {
  Hosts hosts({"A", "B"});
  const auto a = hosts.gateway(0);
  const auto b = hosts.gateway(1);
  ASSERT_TRUE(hosts.untilState(link_peer_t::JOINED, 1, kLong));
  std::map<std::string, std::vector<std::vector<std::uint8_t>>> published;
  const int count = hosts.publishing(200, 2, [&](int i) {
    for (std::size_t host = 0; host < 2; ++host) {
      const std::string sender = "tracker" + std::to_string(host);
      tracked_frame_t frame{};
      frame.num_robots = 20;
      frame.robots.resize(20);
      published[sender].push_back(message(sender, i + 1, frame));
      hosts[host].bus->publish(channels::kTrackedFrame, published[sender].back());
      hosts[host].bus->publish(channels::kRobotStatus,
                               status("robots" + std::to_string(host), i + 1));
    }
  });
  for (std::size_t host = 0; host < 2; ++host) {
    hosts.untilHeard(host, "robots" + std::to_string(1 - host), channels::kRobotStatus, count,
                     kLong);
  }
  hosts.run(1);  // and nothing twice
  for (std::size_t host = 0; host < 2; ++host) {
    for (const std::string origin : {"0", "1"}) {
      const auto frames = hosts[host].of("tracker" + origin, channels::kTrackedFrame);
      ASSERT_THAT(frames, SizeIs(count)) << "host " << host << " of " << origin;
      for (std::size_t i = 0; i < frames.size(); ++i) {
        EXPECT_EQ(frames[i].data, published["tracker" + origin][i]);
      }
      EXPECT_EQ(seqs(hosts[host].of("robots" + origin, channels::kRobotStatus)),
                receivedUntil(count));
    }
    // The gateways publish a few messages per second themselves.
    const link_peer_t peer = hosts[host].status.peers.at(0);
    EXPECT_EQ(peer.lost, 0);
    EXPECT_EQ(peer.repeated, 0);
    EXPECT_EQ(peer.clashing, 0);
    EXPECT_LT(peer.received, 2 * count + 50);
    EXPECT_EQ(peer.trouble, "");
    EXPECT_LT(std::abs(peer.clock_offset), peer.clock_error);  // one computer, one clock
  }
}

TEST(LinkHosts, AMessageOf60KilobytesPasses) {
  Hosts hosts({"A", "B"});
  const auto a = hosts.gateway(0);
  const auto b = hosts.gateway(1);
  ASSERT_TRUE(hosts.untilState(link_peer_t::JOINED, 1, kLong));
  light_command_t command{};
  command.label.resize(60'000, 'x');
  const auto bytes = message("light", 1, command);
  hosts[0].bus->publish(channels::kLightCommand, bytes);
  ASSERT_TRUE(
      hosts.until([&] { return !hosts[1].of("light", channels::kLightCommand).empty(); }, kLong));
  EXPECT_EQ(hosts[1].of("light", channels::kLightCommand)[0].data, bytes);
}

TEST(LinkHosts, ALateJoinerGetsStatesAndStopsButNoOldCommandsOrMeasurements) {
  Hosts hosts({"A", "B"});
  const auto a = hosts.gateway(0);
  ASSERT_TRUE(hosts.untilReports(0, kLong));
  for (int i = 1; i <= 3; ++i) {
    hosts[0].bus->publish(channels::kRobotStatus, status("robots", i));
    hosts[0].bus->publish(channels::kRobotCommand, message<robot_command_t>("runner", i));
    hosts[0].bus->publish(channels::kTrackedFrame, message<tracked_frame_t>("tracker", i));
    hosts[0].bus->publish(channels::kRobotStop, message<robot_stop_t>("people", i));
  }
  robot_stop_t release{};
  release.clear = 1;
  hosts[0].bus->publish(channels::kRobotStop, message("others", 1, release));
  hosts.run(2);  // so that the commands are old
  const auto b = hosts.gateway(1);
  ASSERT_TRUE(hosts.untilState(link_peer_t::JOINED, 1, kLong));
  hosts.until([&] { return hosts[1].peer("hostA").stale >= 2; }, kLong);
  hosts.untilHeard(1, "robots", channels::kRobotStatus, 3, kLong);
  hosts.untilHeard(1, "people", channels::kRobotStop, 3, kLong);
  hosts.run(1);  // and nothing else
  EXPECT_THAT(seqs(hosts[1].of("robots", channels::kRobotStatus)), ElementsAre(3));
  EXPECT_THAT(seqs(hosts[1].of("people", channels::kRobotStop)), ElementsAre(3));
  EXPECT_THAT(hosts[1].of("runner", channels::kRobotCommand), IsEmpty());
  EXPECT_THAT(hosts[1].of("others", channels::kRobotStop), IsEmpty());
  EXPECT_THAT(hosts[1].of("tracker", channels::kTrackedFrame), IsEmpty());
  EXPECT_EQ(hosts[1].status.peers.at(0).stale, 2);
  hosts[0].bus->publish(channels::kTrackedFrame, message<tracked_frame_t>("tracker", 4));
  hosts.untilHeard(1, "tracker", channels::kTrackedFrame, 4, kLong);
  EXPECT_THAT(seqs(hosts[1].of("tracker", channels::kTrackedFrame)), ElementsAre(4));
}

/// Unplugs the cable of B for this time while both publish.
void pullCable(double seconds, bool within_patience) {
  Hosts hosts({"A", "B"});
  const auto a = hosts.gateway(0);
  const auto b = hosts.gateway(1);
  ASSERT_TRUE(hosts.untilState(link_peer_t::JOINED, 1, kLong));
  int sent = 0;
  const auto publish = [&](int) {
    ++sent;
    hosts[0].bus->publish(channels::kRobotStatus, status("robots", sent));
    hosts[0].bus->publish(channels::kRobotCommand, message<robot_command_t>("runner", sent));
    hosts[1].bus->publish(channels::kTrackedFrame, message<tracked_frame_t>("tracker", sent));
  };
  hosts.publishing(50, 1, publish);
  hosts.untilHeard(1, "runner", channels::kRobotCommand, sent, kLong);
  wire("cut B");
  const auto before = hosts[1].of("runner", channels::kRobotCommand).size();
  hosts.publishing(50, seconds, publish);
  EXPECT_EQ(hosts[0].peer("hostB").state, link_peer_t::SILENT);
  EXPECT_EQ(hosts[1].peer("hostA").state, link_peer_t::SILENT);
  EXPECT_THAT(hosts[0].peer("hostB").trouble, HasSubstr("hostB"));
  const int last_in_the_dark = sent;
  wire("restore B");
  ASSERT_TRUE(hosts.untilState(link_peer_t::JOINED, 1, 20));
  hosts.publishing(50, 3, publish);
  hosts.untilHeard(1, "robots", channels::kRobotStatus, sent, kLong);
  hosts.untilHeard(0, "tracker", channels::kTrackedFrame, sent, kLong);
  hosts.run(2);  // for a report of the counts
  EXPECT_THAT(hosts[0].states,
              ElementsAre(Pair("hostB", link_peer_t::SILENT), Pair("hostB", link_peer_t::JOINED),
                          Pair("hostB", link_peer_t::SILENT), Pair("hostB", link_peer_t::JOINED)));

  // No further peer appears or disappears meanwhile, on either side.
  EXPECT_THAT(hosts[1].states, SizeIs(4));

  // Nothing is delivered twice or out of order, and missing messages are counted.
  const auto honest = [&](Host& host, const std::string& other, const char* sender,
                          std::string_view channel) {
    const auto numbers = seqs(host.of(sender, channel));
    EXPECT_EQ(std::ranges::adjacent_find(numbers, std::ranges::greater_equal{}), numbers.end());
    EXPECT_EQ(numbers.back(), sent) << sender;
    const auto missing = sent - static_cast<int>(numbers.size());
    if (within_patience) {
      EXPECT_EQ(missing, 0) << sender;
    } else {
      EXPECT_GT(missing, 0) << sender;
    }
    EXPECT_LE(missing, host.peer(other).lost);
    return missing;
  };
  const auto robots = honest(hosts[1], "hostA", "robots", channels::kRobotStatus);
  const auto frames = honest(hosts[0], "hostB", "tracker", channels::kTrackedFrame);
  std::printf("%.0f s: missing %d states and %d frames of %d; counted lost %ld and %ld\n", seconds,
              robots, frames, sent, hosts[1].peer("hostA").lost, hosts[0].peer("hostB").lost);

  // Commands from the outage are dropped, except those of its last second.
  for (const Message& command : hosts[1].of("runner", channels::kRobotCommand)) {
    const bool old = command.seq > static_cast<int>(before) && command.seq < last_in_the_dark - 200;
    EXPECT_FALSE(old && seconds > 4.5) << command.seq;
  }
  if (within_patience) {
    EXPECT_GT(hosts[1].peer("hostA").stale, 0);
  }
}

TEST(LinkCable, AnOutageOfAFewSecondsLosesNothing) { pullCable(5, true); }

TEST(LinkHostsLong, TheLossesOfAnOutageOfHalfAMinuteAreCounted) { pullCable(30, false); }

TEST(LinkHosts, AClockTooFarOffIsRefusedButStopsPass) {
  Hosts hosts({"A", "B"});
  const auto a = hosts.gateway(0);
  const auto b = hosts.gateway(1, 20'000);
  ASSERT_TRUE(hosts.untilState(link_peer_t::REFUSED, 1, kLong));
  hosts.publishing(50, 1, [&](int i) {
    for (std::size_t host = 0; host < 2; ++host) {
      const std::string sender = std::to_string(host);
      hosts[host].bus->publish(channels::kRobotStatus, status(sender, i + 1));
      hosts[host].bus->publish(channels::kRobotStop, message<robot_stop_t>(sender, 1));
    }
  });
  for (std::size_t host = 0; host < 2; ++host) {
    const std::string other = std::to_string(1 - host);
    hosts.until([&] { return hosts[host].of(other, channels::kRobotStop).size() >= 50; }, kLong);
  }
  hosts.run(0.5);  // and nothing else
  for (std::size_t host = 0; host < 2; ++host) {
    const std::string other = std::to_string(1 - host);
    EXPECT_THAT(hosts[host].of(other, channels::kRobotStatus), IsEmpty());
    EXPECT_THAT(hosts[host].of(other, channels::kRobotStop), SizeIs(50));
    const link_peer_t peer = hosts[host].status.peers.at(0);
    EXPECT_NEAR(peer.clock_offset, host == 0 ? 0.02 : -0.02, peer.clock_error);
    EXPECT_THAT(peer.trouble, HasSubstr("sudo systemctl start chrony on "));
    const std::string named = host == 0 ? "hostB is " : "hostA is ";
    const std::size_t at = peer.trouble.find(named);
    ASSERT_NE(at, std::string::npos) << peer.trouble;
    EXPECT_NEAR(std::stod(peer.trouble.substr(at + named.size())), 20,
                1e3 * peer.clock_error + 0.1);
  }
}

TEST(LinkHosts, AClockOffsetWithinTheLimitIsMeasured) {
  Hosts hosts({"A", "B"});
  const auto a = hosts.gateway(0, -3'000);
  const auto b = hosts.gateway(1);
  ASSERT_TRUE(hosts.untilState(link_peer_t::JOINED, 1, kLong));
  const link_peer_t peer = hosts[0].status.peers.at(0);
  EXPECT_NEAR(peer.clock_offset, 0.003, peer.clock_error);
}

TEST(LinkHosts, AnotherContractIsRefusedAndBothAreNamed) {
  Hosts hosts({"A", "B"});
  const auto a = hosts.gateway(0);
  setenv("LINK_END_SPEAKS", "0123456789abcdef", 1);
  const auto b = hosts.gateway(1);
  unsetenv("LINK_END_SPEAKS");
  ASSERT_TRUE(hosts.untilState(link_peer_t::REFUSED, 1, kLong));
  hosts.publishing(20, 1, [&](int i) {
    hosts[0].bus->publish(channels::kRobotStatus, status("robots", i + 1));
  });
  for (std::size_t host = 0; host < 2; ++host) {
    EXPECT_THAT(hosts[host].status.peers.at(0).trouble,
                AllOf(HasSubstr("hostA speaks message contract "),
                      HasSubstr("hostB speaks message contract 3"), HasSubstr("0123456789abcdef"),
                      HasSubstr("install the same version")));
  }
  EXPECT_THAT(hosts[1].of("robots", channels::kRobotStatus), IsEmpty());
}

TEST(LinkHostsLong, EndedStreamsTakeNoMemory) {
  Hosts hosts({"A", "B"});
  const auto a = hosts.gateway(0);
  const auto b = hosts.gateway(1);
  ASSERT_TRUE(hosts.untilState(link_peer_t::JOINED, 1, kLong));
  std::int64_t instance = 0;
  const auto bursts = [&](int count) {
    for (int i = 0; i < count; ++i) {
      const std::size_t all = hosts[1].heard.size() + 3000;
      hosts.publishing(2000, 1.5, [&](int) {
        robot_status_t status{};
        status.sender = "tool";
        status.instance = ++instance;
        status.seq = 1;
        hosts[0].bus->publish(channels::kRobotStatus, encode(status));
      });
      hosts.until([&] { return hosts[1].heard.size() >= all; }, kLong);
      hosts.run(1);  // unacknowledged messages are kept too, so wait for their acknowledgement
    }
  };
  bursts(2);
  const double before_a = a->megabytes();
  const double before_b = b->megabytes();
  bursts(6);
  std::printf("%.1f and %.1f MB, after 18000 more streams %.1f and %.1f MB\n", before_a, before_b,
              a->megabytes(), b->megabytes());
  EXPECT_EQ(hosts[1].heard.size(), 24'000U);
  // If they were kept they would take more than 1 kB each.
  EXPECT_LT(a->megabytes() - before_a, 4);
  EXPECT_LT(b->megabytes() - before_b, 4);
}

TEST(LinkHosts, TwoRunsDoNotMix) {
  Hosts hosts({"A", "B"});
  const auto a = hosts.gateway(0, 0, 0.005, "one");
  const auto b = hosts.gateway(1, 0, 0.005, "two");
  ASSERT_TRUE(hosts.untilReports(0, kLong) && hosts.untilReports(1, kLong));
  hosts.publishing(20, 2, [&](int i) {
    hosts[0].bus->publish(channels::kRobotStatus, status("robots", i + 1));
  });
  EXPECT_THAT(hosts[0].status.peers, IsEmpty());
  EXPECT_THAT(hosts[1].of("robots", channels::kRobotStatus), IsEmpty());
}

TEST(LinkHosts, ThreeHostsReceiveEveryMessageOnce) {
  Hosts hosts({"A", "B", "C"});
  const auto a = hosts.gateway(0);
  const auto b = hosts.gateway(1);
  const auto c = hosts.gateway(2);
  ASSERT_TRUE(hosts.untilState(link_peer_t::JOINED, 2, kLong));
  const int count = hosts.publishing(100, 2, [&](int i) {
    for (std::size_t host = 0; host < 3; ++host) {
      hosts[host].bus->publish(channels::kRobotStatus, status(std::to_string(host), i + 1));
    }
  });
  for (std::size_t host = 0; host < 3; ++host) {
    for (const std::string sender : {"0", "1", "2"}) {
      hosts.untilHeard(host, sender, channels::kRobotStatus, count, kLong);
    }
  }
  hosts.run(1);  // and nothing twice
  for (std::size_t host = 0; host < 3; ++host) {
    for (const std::string sender : {"0", "1", "2"}) {
      EXPECT_EQ(seqs(hosts[host].of(sender, channels::kRobotStatus)), receivedUntil(count))
          << "of " << sender << " on " << host;
    }
    EXPECT_EQ(hosts[host].status.foreign, 0);
  }
}

TEST(LinkHosts, AFrozenPeerDoesNotDelayTheOthers) {
  Hosts hosts({"A", "B", "C"});
  const auto a = hosts.gateway(0);
  const auto b = hosts.gateway(1);
  const auto c = hosts.gateway(2);
  ASSERT_TRUE(hosts.untilState(link_peer_t::JOINED, 2, kLong));
  b->signal(SIGSTOP);
  std::vector<double> sent;
  const int count = hosts.publishing(50, 4, [&](int i) {
    light_command_t large{};
    large.label.resize(20'000, 'x');
    sent.push_back(steadySeconds());
    hosts[0].bus->publish(channels::kRobotStatus, status("robots", i + 1));
    hosts[0].bus->publish(channels::kLightCommand, message("light", i + 1, large));
  });
  hosts.untilHeard(2, "light", channels::kLightCommand, count, kLong);
  const auto heard = hosts[2].of("robots", channels::kRobotStatus);
  EXPECT_EQ(seqs(heard), receivedUntil(count));
  EXPECT_EQ(seqs(hosts[2].of("light", channels::kLightCommand)), receivedUntil(count));
  EXPECT_EQ(hosts[0].status.timeouts, 0);
  double most = 0;
  for (std::size_t i = 0; i < std::min(heard.size(), sent.size()); ++i) {
    most = std::max(most, heard[i].came - sent[i]);
  }
  std::printf("with a frozen peer the slowest message took %.1f ms\n", 1e3 * most);
  b->signal(SIGCONT);
  ASSERT_TRUE(hosts.untilState(link_peer_t::JOINED, 2, kLong));
  hosts.untilHeard(1, "robots", channels::kRobotStatus, count, kLong);
  EXPECT_EQ(seqs(hosts[1].of("robots", channels::kRobotStatus)), receivedUntil(count));
}

TEST(LinkHosts, ARestartedGatewayJoinsAgainAndCountsAnew) {
  Hosts hosts({"A", "B"});
  auto a = hosts.gateway(0);
  const auto b = hosts.gateway(1);
  ASSERT_TRUE(hosts.untilState(link_peer_t::JOINED, 1, kLong));
  int sent = 0;
  const auto publish = [&](int) {
    hosts[0].bus->publish(channels::kRobotStatus, status("robots", ++sent));
    hosts[1].bus->publish(channels::kTrackedFrame, message<tracked_frame_t>("tracker", sent));
  };
  hosts.publishing(50, 0.5, publish);
  const std::int64_t instance = hosts[1].peer("hostA").instance;
  a->signal(SIGKILL);
  a.reset();
  hosts.publishing(50, 1.5, publish);
  EXPECT_EQ(hosts[1].peer("hostA").state, link_peer_t::SILENT);
  a = hosts.gateway(0);
  ASSERT_TRUE(hosts.until(
      [&] {
        return hosts[1].peer("hostA").instance != instance &&
               hosts[1].peer("hostA").state == link_peer_t::JOINED;
      },
      kLong));
  const int joined = sent;
  hosts.publishing(50, 1, publish);
  hosts.untilHeard(1, "robots", channels::kRobotStatus, sent, kLong);
  hosts.untilHeard(0, "tracker", channels::kTrackedFrame, sent, kLong);
  const auto robots = seqs(hosts[1].of("robots", channels::kRobotStatus));
  EXPECT_EQ(std::ranges::adjacent_find(robots, std::ranges::greater_equal{}), robots.end());
  EXPECT_EQ(std::ranges::count_if(robots, [&](auto seq) { return seq > joined; }), sent - joined);
  const auto frames = seqs(hosts[0].of("tracker", channels::kTrackedFrame));
  EXPECT_EQ(std::ranges::count_if(frames, [&](auto seq) { return seq > joined; }), sent - joined);
  EXPECT_EQ(hosts[1].peer("hostA").clashing, 0);
  EXPECT_EQ(hosts[0].peer("hostB").clashing, 0);
}

}  // namespace
}  // namespace lab::gateway
