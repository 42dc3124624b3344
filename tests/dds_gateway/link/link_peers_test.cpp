#include "dds_gateway/link/link_peers.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace lab::gateway::link_peers_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::int64_t kStart = 1'700'000'000'000'000;
constexpr std::int64_t kWay = 200;  // [us] each way

/// Two gateways that ping each other; the clock of the second is ahead by `offset` [us].
struct Pair {
  explicit Pair(std::int64_t clock_offset = 0, ProtocolVersion of_b = ProtocolVersion::own(),
                const std::string& name_b = "bench")
      : offset(clock_offset),
        a("desk", 1, ProtocolVersion::own(), 0.005),
        b(name_b, 2, std::move(of_b), 0.005) {}

  void exchange(LinkPeers& from, LinkPeers& to, std::int64_t from_ahead, std::int64_t to_ahead) {
    LinkHeartbeat answer;
    LinkHeartbeat none;
    const std::int64_t sent = now + from_ahead;
    if (!to.hear(now + kWay + to_ahead, from.ping(sent), answer)) return;
    static_cast<void>(from.hear(now + 2 * kWay + from_ahead, answer, none));
  }

  void run(int rounds, bool b_lives = true) {
    for (int i = 0; i < rounds; ++i) {
      if (b_lives) {
        exchange(a, b, 0, offset);
        exchange(b, a, offset, 0);
      }
      now += 100'000;
      changes += a.tick(now) ? 1 : 0;
      static_cast<void>(b.tick(now + offset));
    }
  }

  [[nodiscard]] const LinkPeer& seen() const { return a.all().begin()->second; }

  std::int64_t offset;
  std::int64_t now = kStart;
  LinkPeers a;
  LinkPeers b;
  int changes = 0;
};

TEST(LinkPeers, TwoGatewaysJoinWhenTheClockIsKnown) {
  Pair pair;
  pair.run(1);
  EXPECT_EQ(pair.seen().state, PeerState::kNew);
  pair.run(10);
  EXPECT_EQ(pair.seen().state, PeerState::kJoined);
  EXPECT_EQ(pair.seen().host, "bench");
  EXPECT_EQ(pair.seen().trouble, "");
  EXPECT_EQ(pair.seen().clock.offset, 0);
  EXPECT_EQ(pair.changes, 2);
}

TEST(LinkPeers, ASilentPeerIsReportedAndJoinsAgain) {
  Pair pair;
  pair.run(10);
  pair.run(9, false);
  EXPECT_EQ(pair.seen().state, PeerState::kJoined);
  pair.run(2, false);
  EXPECT_EQ(pair.seen().state, PeerState::kSilent);
  EXPECT_THAT(pair.seen().trouble, HasSubstr("nothing heard of bench"));
  pair.run(1);
  EXPECT_EQ(pair.seen().state, PeerState::kJoined);
  EXPECT_EQ(pair.changes, 4);
}

TEST(LinkPeers, APauseOfThisProcessDoesNotMakePeersSilent) {
  Pair pair;
  pair.run(10);
  pair.now += 30'000'000;
  EXPECT_FALSE(pair.a.tick(pair.now));
  EXPECT_EQ(pair.seen().state, PeerState::kJoined);
  pair.run(11, false);
  EXPECT_EQ(pair.seen().state, PeerState::kSilent);
  pair.now += 30'000'000;  // nor does it wake a silent peer
  EXPECT_FALSE(pair.a.tick(pair.now));
  EXPECT_EQ(pair.seen().state, PeerState::kSilent);
}

TEST(LinkPeers, AClockTooFarOffIsRefusedOnBothSidesWithAFix) {
  for (const std::int64_t offset : {-8000L, 6000L, 3'600'000'000L}) {
    Pair pair(offset);
    pair.run(10);
    for (const LinkPeers* side : {&pair.a, &pair.b}) {
      const LinkPeer& peer = side->all().begin()->second;
      EXPECT_EQ(peer.state, PeerState::kRefused) << offset;
      EXPECT_THAT(peer.trouble,
                  AllOf(HasSubstr("systemctl start chrony on "), HasSubstr("on bench"),
                        HasSubstr("on desk"), HasSubstr("at most 5 ms")));
    }
    EXPECT_THAT(pair.seen().trouble, HasSubstr(offset > 0 ? "ahead of" : "behind"));
  }
}

TEST(LinkPeers, AnOffsetWithinTheLimitPasses) {
  for (const std::int64_t offset : {-4900L, 4900L}) {
    Pair pair(offset);
    pair.run(10);
    EXPECT_EQ(pair.seen().state, PeerState::kJoined) << offset;
    EXPECT_DOUBLE_EQ(pair.seen().clock.offset, 1e-6 * static_cast<double>(offset));
  }
}

TEST(LinkPeers, AnotherContractIsRefusedAndBothAreNamed) {
  Pair pair(0, {3, "0123456789abcdef", "0.0.9"});
  pair.run(10);
  EXPECT_EQ(pair.seen().state, PeerState::kRefused);
  EXPECT_THAT(pair.seen().trouble,
              AllOf(HasSubstr("bench speaks message contract 3"), HasSubstr("0123456789abcdef"),
                    HasSubstr("0.0.9"), HasSubstr("desk speaks message contract"),
                    HasSubstr(ProtocolVersion::own().fingerprints)));
}

TEST(LinkPeers, ARefusedPeerKnowsWhy) {
  Pair pair;
  pair.run(10);
  LinkHeartbeat answer;
  LinkHeartbeat pong = pair.b.ping(pair.now);
  pong.to = 1;
  pong.there = pong.answered = pair.now;
  pong.refusal = "desk smells";
  EXPECT_FALSE(pair.a.hear(pair.now, pong, answer));
  EXPECT_EQ(pair.seen().state, PeerState::kRefused);
  EXPECT_EQ(pair.seen().trouble, "bench refuses us: desk smells");
  pair.run(1);  // its own answers contradict it
  EXPECT_EQ(pair.seen().state, PeerState::kJoined);
}

TEST(LinkPeers, TwoHostsOfOneNameAreRefused) {
  Pair pair(0, ProtocolVersion::own(), "desk");
  pair.run(10);
  EXPECT_EQ(pair.seen().state, PeerState::kRefused);
  EXPECT_THAT(pair.seen().trouble, HasSubstr("two hosts call themselves desk"));
}

TEST(LinkPeers, TwoGatewaysOfOneNameAreReportedAndTheLaterCounts) {
  Pair pair;
  pair.run(10);
  LinkPeers second("bench", 3, ProtocolVersion::own(), 0.005);
  LinkHeartbeat answer;
  EXPECT_TRUE(pair.a.hear(pair.now, second.ping(pair.now), answer));
  EXPECT_EQ(pair.seen().gateway, 3);
  EXPECT_EQ(pair.seen().state, PeerState::kNew);
  EXPECT_FALSE(pair.a.hear(pair.now, pair.b.ping(pair.now), answer));
  static_cast<void>(pair.a.tick(pair.now));
  EXPECT_THAT(pair.seen().trouble, HasSubstr("two gateways call themselves bench"));
  // When the later one is silent, the other one is accepted, whichever started first.
  pair.now += 2'000'000;
  EXPECT_TRUE(pair.a.hear(pair.now, pair.b.ping(pair.now), answer));
  EXPECT_EQ(pair.seen().gateway, 2);
}

TEST(LinkPeers, APeerThatDoesNotAnswerIsReported) {
  Pair pair;
  LinkHeartbeat answer;
  for (int i = 0; i < 40; ++i) {
    static_cast<void>(pair.a.hear(pair.now, pair.b.ping(pair.now), answer));
    static_cast<void>(pair.a.tick(pair.now));
    pair.now += 100'000;
  }
  EXPECT_EQ(pair.seen().state, PeerState::kNew);
  EXPECT_THAT(pair.seen().trouble, HasSubstr("is heard but does not answer"));
}

TEST(LinkPeers, OurOwnHeartbeatsAndThousandsOfNamesAreIgnored) {
  LinkPeers peers("desk", 1, ProtocolVersion::own(), 0.005);
  LinkHeartbeat answer;
  EXPECT_FALSE(peers.hear(kStart, peers.ping(kStart), answer));
  EXPECT_TRUE(peers.all().empty());
  for (int i = 0; i < 5000; ++i) {
    const LinkPeers other("host" + std::to_string(i), 2, ProtocolVersion::own(), 0.005);
    static_cast<void>(peers.hear(kStart, other.ping(kStart), answer));
  }
  EXPECT_EQ(peers.all().size(), LinkPeers::kMostPeers);
}

/// A version of 300 kB was part of LINK_STATUS, once a second.
TEST(LinkPeers, AHeartbeatWithALongTextIsIgnored) {
  LinkPeers peers("desk", 1, ProtocolVersion::own(), 0.005);
  const LinkPeers bench("bench", 2, ProtocolVersion::own(), 0.005);
  LinkHeartbeat answer;
  const std::string name(LinkHeartbeat::kLongestName + 1, 'x');
  std::vector<LinkHeartbeat> wrong(4, bench.ping(kStart));
  wrong[0].host = name;
  wrong[1].protocol.fingerprints = name;
  wrong[2].protocol.version = name;
  wrong[3].refusal.assign(LinkHeartbeat::kLongestRefusal + 1, 'x');
  for (const LinkHeartbeat& heartbeat : wrong) {
    EXPECT_FALSE(peers.hear(kStart, heartbeat, answer));
    EXPECT_TRUE(peers.all().empty());
  }
  LinkHeartbeat longest = bench.ping(kStart);
  longest.protocol.version.assign(LinkHeartbeat::kLongestName, 'x');
  EXPECT_TRUE(peers.hear(kStart, longest, answer));
  EXPECT_TRUE(answer.hasShortTexts()) << "also what we answer: " << answer.refusal;
}

// A gateway writes the states of its peers into a log that people look at on a terminal.
TEST(LinkPeers, ThatSendControlCharactersAreLoggedInOneLine) {
  LinkPeer peer;
  peer.host = "bench\n\x1b[2J";
  EXPECT_EQ(stateText(peer), "bench\\x0a\\x1b[2J is there");
  peer.state = PeerState::kJoined;
  peer.clock.offset = 1e-3;
  peer.clock.error = 2e-4;
  EXPECT_EQ(stateText(peer),
            "joined with bench\\x0a\\x1b[2J, whose clock is +1.000 ms off ours (+-0.200 ms)");
  peer.trouble = peer.host + " refuses us: \xff\r";
  for (const PeerState state : {PeerState::kSilent, PeerState::kRefused}) {
    peer.state = state;
    EXPECT_EQ(stateText(peer), "bench\\x0a\\x1b[2J refuses us: \xEF\xBF\xBD\\x0d");
  }
}

}  // namespace
}  // namespace lab::gateway::link_peers_test
