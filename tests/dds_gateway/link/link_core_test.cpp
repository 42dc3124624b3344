#include "dds_gateway/link/link_core.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <lab/clock_t.hpp>
#include <lab/light_command_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <lab/tracked_frame_t.hpp>
#include <limits>
#include <random>
#include <set>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/count_limits.hpp"

namespace lab::gateway {
namespace {

using Data = std::vector<std::uint8_t>;

template <class Type>
Data of(const std::string& sender, std::int64_t instance = 1, Type type = {}) {
  type.utime = 1;
  type.sender = sender;
  type.instance = instance;
  type.seq = 1;
  return encode(type);
}

Data status(const std::string& sender, std::int64_t instance = 1) {
  return of<robot_status_t>(sender, instance);
}

/// Receives states of "robots" on host "bench", in its stream 1.
Verdict receive(LinkCore& core, std::int64_t number, std::int64_t gateway = 5) {
  return core.receive(0, "bench", gateway, 1, number, 0, channels::kRobotStatus, status("robots"));
}

TEST(LinkCore, EachStreamIsNumberedFromOne) {
  LinkCore core(0);
  for (std::int64_t i = 1; i <= 3; ++i) {
    EXPECT_EQ(core.hear(0, channels::kRobotStatus, status("a"))->number, i);
    EXPECT_EQ(core.hear(0, channels::kServiceStatus, status("a"))->number, i);
    EXPECT_EQ(core.hear(0, channels::kRobotStatus, status("a", 2))->number, i);
    EXPECT_EQ(core.hear(0, channels::kRobotStatus, status("b"))->stream, 4);
  }
}

TEST(LinkCore, ForeignMessagesAreCountedAndNotForwarded) {
  LinkCore core(0);
  EXPECT_FALSE(core.hear(0, channels::kClock, of<clock_t>("a")));
  EXPECT_FALSE(core.hear(0, channels::kLcmSelfTest, Data{1, 2, 3}));
  EXPECT_EQ(core.foreign(), 0);
  EXPECT_FALSE(core.hear(0, "ROBOT_STATUS", Data(200, 0)));
  Data foreign = status("a");
  foreign[3] ^= 1;  // a foreign type
  EXPECT_FALSE(core.hear(0, "ROBOT_STATUS", foreign));
  EXPECT_FALSE(core.hear(0, "ROBOT_STATUS", Data{}));
  EXPECT_EQ(core.foreign(), 3);
  EXPECT_EQ(core.receive(0, "bench", 1, 1, 1, 0, "ROBOT_STATUS", foreign), Verdict::kForeign);
  EXPECT_EQ(core.receive(0, "bench", 1, 1, 1, 0, "CLOCK", of<clock_t>("a")), Verdict::kForeign);
  EXPECT_EQ(core.receive(0, "bench", 1, 1, 1, 0, std::string(64, 'X'), status("a")),
            Verdict::kForeign);
  EXPECT_EQ(core.foreign(), 6);
}

TEST(LinkCore, AnEchoIsNotForwarded) {
  LinkCore core(0);
  EXPECT_EQ(receive(core, 1), Verdict::kDeliver);
  EXPECT_FALSE(core.hear(0, channels::kRobotStatus, status("robots")));
  // The home applies to all channels of that sender; another start of it may have another home.
  EXPECT_FALSE(core.hear(0, channels::kServiceStatus, status("robots")));
  EXPECT_TRUE(core.hear(0, channels::kRobotStatus, status("robots", 2)));
}

TEST(LinkCore, RepetitionsAreDroppedAndGapsAreCounted) {
  LinkCore core(0);
  EXPECT_EQ(receive(core, 4), Verdict::kDeliver);  // earlier packets do not count as lost
  EXPECT_EQ(receive(core, 4), Verdict::kRepeated);
  EXPECT_EQ(receive(core, 5), Verdict::kDeliver);
  EXPECT_EQ(receive(core, 9), Verdict::kDeliver);
  EXPECT_EQ(receive(core, 7), Verdict::kRepeated);  // too late: a later number was delivered
  const LinkCounts counts = core.counts("bench");
  EXPECT_EQ(counts.received, 3);
  EXPECT_EQ(counts.lost, 3);
  EXPECT_EQ(counts.repeated, 2);
}

TEST(LinkCore, CountsNoMoreThanAMessageMaySay) {
  LinkCore core(0);
  using Limits = std::numeric_limits<std::int64_t>;
  EXPECT_EQ(receive(core, Limits::min()), Verdict::kDeliver);
  EXPECT_EQ(receive(core, Limits::max() - 1), Verdict::kDeliver);
  EXPECT_EQ(core.counts("bench").lost, kMostOnLink);
  EXPECT_EQ(receive(core, Limits::max()), Verdict::kDeliver);
  EXPECT_EQ(core.counts("bench").lost, kMostOnLink);
}

TEST(LinkCore, PacketsInAnyOrderAreDeliveredOnceAndInOrder) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    LinkCore core(0);
    std::vector<std::int64_t> numbers;
    for (int i = 0; i < 100; ++i) numbers.push_back(1 + static_cast<std::int64_t>(random() % 60));
    std::int64_t last = 0;
    std::int64_t delivered = 0;
    for (const std::int64_t number : numbers) {
      const bool newer = number > last;
      EXPECT_EQ(receive(core, number) == Verdict::kDeliver, newer);
      delivered += newer ? 1 : 0;
      last = std::max(last, number);
    }
    const LinkCounts counts = core.counts("bench");
    EXPECT_EQ(counts.received, delivered);
    EXPECT_EQ(counts.repeated, 100 - delivered);
    // Every number after the first received one was delivered or is counted as lost.
    EXPECT_EQ(counts.received + counts.lost, last - numbers[0] + 1);
  }
}

TEST(LinkCore, ARestartedGatewayCountsFromOne) {
  LinkCore core(0);
  for (std::int64_t i = 1; i <= 10; ++i) static_cast<void>(receive(core, i));
  EXPECT_EQ(receive(core, 1, 6), Verdict::kDeliver);
  EXPECT_EQ(receive(core, 2, 6), Verdict::kDeliver);
  EXPECT_EQ(core.counts("bench").received, 2);
  EXPECT_EQ(core.counts("bench").lost, 0);
}

TEST(LinkCore, OldCommandsAreDroppedButStopsAreNot) {
  constexpr std::int64_t kOld = LinkCore::kFreshCommand + 1;
  LinkCore core(0);
  std::int32_t stream = 0;
  const auto first = [&](std::int64_t age, std::string_view channel, const Data& data) {
    return core.receive(0, "bench", 5, ++stream, 1, age, channel, data);
  };
  EXPECT_EQ(first(kOld - 1, channels::kRobotCommand, of<robot_command_t>("a")), Verdict::kDeliver);
  EXPECT_EQ(first(kOld, channels::kRobotCommand, of<robot_command_t>("a")), Verdict::kStale);
  EXPECT_EQ(first(kOld, channels::kLightCommand, of<light_command_t>("a")), Verdict::kStale);
  EXPECT_EQ(first(1000 * kOld, channels::kRobotStop, of<robot_stop_t>("a")), Verdict::kDeliver);
  robot_stop_t release{};
  release.clear = 1;
  EXPECT_EQ(first(kOld, channels::kRobotStop, of("a", 1, release)), Verdict::kStale);
  EXPECT_EQ(core.counts("bench").stale, 3);
  EXPECT_EQ(core.counts("bench").lost, 0);
}

TEST(LinkCore, ALateJoinerGetsStatesButNoOldMeasurements) {
  constexpr std::int64_t kOld = 60'000'000;
  LinkCore core(0);
  EXPECT_EQ(core.receive(0, "bench", 5, 1, 90, kOld, channels::kRobotStatus, status("a")),
            Verdict::kDeliver);
  EXPECT_EQ(
      core.receive(0, "bench", 5, 2, 90, kOld, channels::kTrackedFrame, of<tracked_frame_t>("a")),
      Verdict::kHistory);
  // Packets that an outage has delayed are delivered at any age.
  EXPECT_EQ(
      core.receive(0, "bench", 5, 2, 91, kOld, channels::kTrackedFrame, of<tracked_frame_t>("a")),
      Verdict::kDeliver);
}

TEST(LinkCore, ASenderOfAnotherHomeClashes) {
  LinkCore core(0);
  ASSERT_TRUE(core.hear(0, channels::kRobotStatus, status("robots")));
  EXPECT_EQ(receive(core, 1), Verdict::kClash);
  EXPECT_EQ(core.receive(0, "bench", 5, 2, 1, 0, channels::kRobotStatus, status("x")),
            Verdict::kDeliver);
  EXPECT_EQ(core.receive(0, "third", 5, 1, 1, 0, channels::kRobotStatus, status("x")),
            Verdict::kClash);
  EXPECT_EQ(core.counts("bench").clashing, 1);
  EXPECT_EQ(core.counts("third").clashing, 1);
  // A home on another host is not given up; a home here is, if the sender is silent here.
  EXPECT_EQ(core.receive(LinkCore::kHomeTimeout + 1, "third", 5, 1, 2, 0, channels::kRobotStatus,
                         status("x")),
            Verdict::kClash);
  EXPECT_EQ(core.receive(LinkCore::kHomeTimeout + 1, "bench", 5, 1, 2, 0, channels::kRobotStatus,
                         status("robots")),
            Verdict::kDeliver);
  EXPECT_FALSE(core.hear(LinkCore::kHomeTimeout + 1, channels::kRobotStatus, status("robots")));
}

TEST(LinkCore, ASenderReceivedMoreOftenThanForwardedIsAtHomeHere) {
  LinkCore core(0);
  for (std::int64_t number = 1; number <= 3; ++number) {
    EXPECT_EQ(receive(core, number), Verdict::kDeliver);
  }
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(core.hear(0, channels::kRobotStatus, status("robots")));
  EXPECT_EQ(receive(core, 4), Verdict::kDeliver);
  EXPECT_FALSE(core.hear(0, channels::kRobotStatus, status("robots")));
  EXPECT_FALSE(core.hear(0, channels::kRobotStatus, status("robots")));  // one too many
  EXPECT_EQ(receive(core, 5), Verdict::kClash);
  EXPECT_TRUE(core.hear(0, channels::kRobotStatus, status("robots")));
}

/// Buses with gateways; every gateway is connected with every other. Packets are delivered in
/// random order, except that each stream keeps its order.
class Mesh {
 public:
  Mesh(std::vector<std::size_t> bus_of_gateway, unsigned seed)
      : bus_of_(std::move(bus_of_gateway)), random_(seed) {
    for (std::size_t i = 0; i < bus_of_.size(); ++i) {
      cores_.emplace_back(static_cast<std::int64_t>(700'000 * i));
    }
    for (const std::size_t bus : bus_of_) buses_ = std::max(buses_, bus + 1);
    heard.resize(buses_);
  }

  void publish(std::size_t bus, const std::string& channel, const Data& data) {
    ++heard[bus][data];
    for (std::size_t i = 0; i < cores_.size(); ++i) {
      if (bus_of_[i] == bus) push({i, i, {}, channel, data});
    }
  }

  /// @return how many packets moved
  std::size_t settle(std::size_t most) {
    std::size_t moved = 0;
    while (!waiting_.empty() && moved < most) {
      auto entry = waiting_.begin();
      std::advance(entry, static_cast<std::ptrdiff_t>(random_() % waiting_.size()));
      const Move move = entry->second.front();
      entry->second.pop_front();
      if (entry->second.empty()) waiting_.erase(entry);
      ++moved;
      carry(move);
    }
    return moved;
  }

  LinkCounts counts(std::size_t at, std::size_t of) const { return cores_[at].counts(name(of)); }

  std::int64_t now = 0;
  std::vector<std::map<Data, int>> heard;  ///< by bus: how often each message was on it

 private:
  struct Move {
    std::size_t to;
    std::size_t from;  ///< itself: from the bus
    Outgoing numbered;
    std::string channel;
    Data data;
  };

  static std::string name(std::size_t gateway) { return "host" + std::to_string(gateway); }

  void push(Move move) {
    const auto lane = std::pair(move.to, move.from);
    waiting_[lane].push_back(std::move(move));
  }

  void carry(const Move& move) {
    LinkCore& core = cores_[move.to];
    if (move.to != move.from) {
      if (core.receive(now, name(move.from), 1, move.numbered.stream, move.numbered.number, 0,
                       move.channel, move.data) == Verdict::kDeliver) {
        publish(bus_of_[move.to], move.channel, move.data);
      }
      return;
    }
    const auto outgoing = core.hear(now, move.channel, move.data);
    if (!outgoing) return;
    for (std::size_t i = 0; i < cores_.size(); ++i) {
      if (i != move.to) push({i, move.to, *outgoing, move.channel, move.data});
    }
  }

  std::vector<std::size_t> bus_of_;
  std::size_t buses_ = 0;
  std::vector<LinkCore> cores_;
  std::mt19937 random_;
  std::map<std::pair<std::size_t, std::size_t>, std::deque<Move>> waiting_;
};

Data numbered(const std::string& sender, std::int64_t seq) {
  robot_status_t status{};
  status.sender = sender;
  status.instance = 1;
  status.seq = seq;
  return encode(status);
}

TEST(LinkCore, OnThreeHostsEveryMessageIsOnEveryBusOnce) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    Mesh mesh({0, 1, 2}, seed);
    for (std::int64_t seq = 1; seq <= 20; ++seq) {
      for (std::size_t bus = 0; bus < 3; ++bus) {
        mesh.publish(bus, "ROBOT_STATUS", numbered("sender" + std::to_string(bus), seq));
      }
      mesh.settle(seed % 10);
    }
    mesh.settle(100'000);
    for (std::size_t bus = 0; bus < 3; ++bus) {
      EXPECT_EQ(mesh.heard[bus].size(), 60U);
      for (const auto& [data, count] : mesh.heard[bus]) EXPECT_EQ(count, 1);
    }
  }
}

TEST(LinkCore, TwoGatewaysOnOneBusAreDetectedAndCauseNoStorm) {
  constexpr std::int64_t kMessages = 100;
  for (unsigned seed = 0; seed < 100; ++seed) {
    Mesh mesh({0, 0, 1}, seed);
    std::size_t moved = 0;
    for (std::int64_t seq = 1; seq <= kMessages; ++seq) {
      mesh.publish(0, "ROBOT_STATUS", numbered("here", seq));
      mesh.publish(1, "ROBOT_STATUS", numbered("there", seq));
      moved += mesh.settle(100'000);
      mesh.now += 100'000;
    }
    // Each message is received by at most three gateways, and each sends it to two. A gateway that
    // publishes it on a bus is heard by at most two more, which may send it again. A few packets
    // circulate before this is detected.
    EXPECT_LE(moved, 2 * kMessages * (3 + 6 + 2 * (2 + 4)));
    int extra = 0;
    for (const auto& bus : mesh.heard) {
      for (const auto& [data, count] : bus) extra += count - 1;
    }
    EXPECT_LE(extra, 50) << seed;
    // One of the two gateways now brings all messages from outside, and all of ours are sent out.
    for (std::int64_t seq = kMessages - 20; seq <= kMessages; ++seq) {
      EXPECT_EQ(mesh.heard[0][numbered("there", seq)], 1) << seed << " " << seq;
      EXPECT_EQ(mesh.heard[1][numbered("here", seq)], 1) << seed << " " << seq;
      EXPECT_EQ(mesh.heard[0][numbered("here", seq)], 1) << seed << " " << seq;
    }
    std::int64_t clashes = 0;
    for (std::size_t at = 0; at < 3; ++at) {
      for (std::size_t of = 0; of < 3; ++of) clashes += mesh.counts(at, of).clashing;
    }
    EXPECT_GE(clashes, kMessages);
  }
}

TEST(LinkCore, MemoryIsBounded) {
  LinkCore core(0);
  std::set<std::int32_t> slots;
  for (std::int64_t instance = 0; instance < 20'000; ++instance) {
    slots.insert(core.hear(0, channels::kRobotStatus, status("local", instance))->slot);
    static_cast<void>(core.receive(0, "host" + std::to_string(instance % 3), 1,
                                   static_cast<std::int32_t>(instance), 1, 0,
                                   channels::kRobotStatus, status("far", instance)));
  }
  EXPECT_EQ(slots.size(), LinkCore::kMostStreams);
  EXPECT_LE(core.size(), 11 * LinkCore::kMostStreams);
  // A flood of host names is ignored.
  for (int i = 0; i < 5000; ++i) {
    static_cast<void>(
        core.receive(0, "x" + std::to_string(i), 1, 1, 1, 0, channels::kRobotStatus, status("y")));
  }
  EXPECT_LE(core.size(), 12 * LinkCore::kMostStreams);
}

TEST(LinkCore, NoTwoStreamsShareASlot) {
  LinkCore core(0);
  std::map<std::int32_t, std::int64_t> owner;
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {
    const auto instance = static_cast<std::int64_t>(random() % 1500);
    const auto outgoing = core.hear(0, channels::kRobotStatus, status("a", instance));
    if (outgoing->number > 1) {
      EXPECT_EQ(owner[outgoing->slot], instance);
    }
    owner[outgoing->slot] = instance;
  }
}

TEST(LinkCore, AForgottenStreamBeginsAnew) {
  LinkCore core(0);
  const std::int32_t before = core.hear(0, channels::kRobotStatus, status("a"))->stream;
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(LinkCore::kMostStreams); ++i) {
    static_cast<void>(core.hear(0, channels::kRobotStatus, status("b", i)));
  }
  const auto again = core.hear(0, channels::kRobotStatus, status("a"));
  EXPECT_GT(again->stream, before);
  EXPECT_EQ(again->number, 1);
}

}  // namespace
}  // namespace lab::gateway
