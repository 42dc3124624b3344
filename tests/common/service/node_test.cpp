// Node in virtual time: headers, counts and heartbeats.
#include "common/service/node.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <lab/experiment_command_t.hpp>
#include <lab/robot_command_t.hpp>
#include <lab/robot_status_t.hpp>
#include <lab/robot_stop_t.hpp>
#include <lab/sim_truth_t.hpp>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/loop/asio_loop.hpp"
#include "common/loop/virtual_loop.hpp"
#include "common/process/version.hpp"

namespace lab {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t kSecond = 1'000'000;
constexpr std::int64_t kStart = VirtualLoop::kEpoch;

class NodeTest : public testing::Test {
 protected:
  NodeTest() {
    loop_.drainWith([this] { bus_.deliver(); });
    bus_.subscribeAll([this](const Packet& packet) {
      ++on_bus_[std::string(packet.channel)];
      service_status_t status{};
      if (packet.channel != channels::kServiceStatus) return;
      ASSERT_TRUE(decode(packet.data, status));
      if (status.sender == "sim_svc") beats_.push_back(status);
    });
  }

  /// A status message from another sender, as bytes.
  void sendStatus(std::int64_t seq, const std::string& sender = "robot_bridge",
                  std::int64_t instance = 5) {
    robot_status_t status{};
    status.sender = sender;
    status.instance = instance;
    status.seq = seq;
    bus_.publish(channels::kRobotStatus, encode(status));
    bus_.deliver();
  }

  template <class Message>
  void publish(std::string_view channel) {
    Message message{};
    dut_.publish(channel, message);
  }

  const service_status_t& nextBeat() {
    loop_.runUntil(loop_.now() + kSecond);
    return beats_.back();
  }

  static std::map<std::string, std::int64_t> sentOf(const service_status_t& status) {
    std::map<std::string, std::int64_t> sent;
    for (const channel_count_t& count : status.sent) sent[count.channel] = count.messages;
    return sent;
  }

  VirtualLoop loop_;
  MemoryBus bus_{[this] { return loop_.now(); }};
  Node dut_{bus_, loop_, {"sim_svc", 2, 77}};
  std::vector<service_status_t> beats_;
  std::map<std::string, std::int64_t> on_bus_;
};

TEST_F(NodeTest, StampsSenderInstanceSeqAndTime) {
  std::vector<robot_status_t> heard;
  dut_.subscribe<robot_status_t>(channels::kRobotStatus,
                                 [&](const robot_status_t& status) { heard.push_back(status); });
  loop_.runUntil(kStart + 3);
  robot_status_t status{};
  dut_.publish(channels::kRobotStatus, status);
  status.utime = kStart + 12345;
  dut_.publish(channels::kRobotStatus, status);
  bus_.deliver();
  ASSERT_EQ(heard.size(), 2U);
  EXPECT_EQ(heard[0].sender, "sim_svc");
  EXPECT_EQ(heard[0].instance, 77);
  EXPECT_EQ(heard[0].seq, 1);
  EXPECT_EQ(heard[0].utime, kStart + 3);
  EXPECT_EQ(heard[1].seq, 2);
  EXPECT_EQ(heard[1].utime, kStart + 12345);
}

TEST_F(NodeTest, UsesTheOtherRobotsOfAMessageWithAnImpossibleNumber) {
  std::vector<robot_status_t> heard;
  dut_.subscribe<robot_status_t>(channels::kRobotStatus,
                                 [&](const robot_status_t& status) { heard.push_back(status); });
  robot_status_t status{};
  status.sender = "robot_bridge";
  status.robots.resize(3);
  status.num_robots = 3;
  status.robots[0].robot_id = 1;
  status.robots[1].wheel_left = 1e300;
  status.robots[2].robot_id = 3;
  bus_.publish(channels::kRobotStatus, encode(status));
  bus_.deliver();
  ASSERT_EQ(heard.size(), 1U);
  ASSERT_EQ(heard[0].robots.size(), 2U);
  EXPECT_EQ(heard[0].robots[1].robot_id, 3);
  EXPECT_EQ(dut_.streams().decodeErrors().at("ROBOT_STATUS"), 1);
  dut_.start();
  EXPECT_EQ(nextBeat().last_error,
            "ROBOT_STATUS from robot_bridge refused: robots[1].wheel_left: found 1e+300, expected "
            "-100 to 100");
}

TEST_F(NodeTest, CountsAStopWhateverItsHeaderIs) {
  int heard = 0;
  dut_.subscribe<robot_stop_t>(channels::kRobotStop, [&](const robot_stop_t&) { ++heard; });
  constexpr std::int64_t kLowest = std::numeric_limits<std::int64_t>::min();
  for (const std::int64_t seq : {std::int64_t{-1}, -(kLowest + 1), kLowest, std::int64_t{3}}) {
    robot_stop_t stop{};
    stop.sender = "panic";
    stop.utime = kLowest;
    stop.seq = seq;
    bus_.publish(channels::kRobotStop, encode(stop));
  }
  bus_.deliver();
  EXPECT_EQ(heard, 4);
  EXPECT_EQ(dut_.streams().streams().begin()->second.received, 4);
  EXPECT_EQ(dut_.streams().lost(), 0);
}

/// Each heartbeat has the names of all senders.
TEST_F(NodeTest, TakesNoMessageWhoseSenderHasALongName) {
  int heard = 0;
  dut_.subscribe<robot_status_t>(channels::kRobotStatus, [&](const auto&) { ++heard; });
  dut_.start();
  const std::string longest(63, 'x');
  sendStatus(1, longest);
  sendStatus(1, longest + "x");
  sendStatus(1, std::string(1'000'000, 'x'));

  const service_status_t& beat = nextBeat();

  EXPECT_EQ(heard, 1);
  ASSERT_EQ(beat.received.size(), 2U);
  EXPECT_EQ(beat.received[0].sender, longest);
  EXPECT_EQ(beat.received[1].decode_errors, 2);
  EXPECT_EQ(beat.last_error, "ROBOT_STATUS from " + longest +
                                 " refused: sender: found a name of 64 bytes, expected at most 63");
  EXPECT_LT(encode(beat).size(), 1000U);
}

TEST_F(NodeTest, NamesARefusedSenderWithoutControlCharacters) {
  dut_.subscribe<robot_status_t>(channels::kRobotStatus, [](const auto&) {});
  dut_.start();
  const std::string begin(61, '\x1b');
  sendStatus(1, begin + "\u20AC" + std::string(1'000'000, 'y'));

  std::string shown;
  for (std::size_t i = 0; i < begin.size(); ++i) shown += "\\x1b";
  EXPECT_EQ(nextBeat().last_error,
            "ROBOT_STATUS from " + shown +
                " refused: sender: found a name of 1000064 bytes, expected at most 63");
}

TEST_F(NodeTest, CountsAStopUnderTheBeginningOfALongName) {
  int heard = 0;
  dut_.subscribe<robot_stop_t>(channels::kRobotStop, [&](const robot_stop_t&) { ++heard; });
  dut_.start();
  const std::string begin(62, 'x');
  robot_stop_t stop{};
  stop.sender = begin + "\u00B0" + std::string(1'000'000, 'y');
  bus_.publish(channels::kRobotStop, encode(stop));

  const service_status_t& beat = nextBeat();

  EXPECT_EQ(heard, 1);
  ASSERT_EQ(beat.received.size(), 1U);
  EXPECT_EQ(beat.received[0].sender, begin) << "the next character has two bytes";
  EXPECT_EQ(beat.received[0].received, 1);
  EXPECT_LT(encode(beat).size(), 1000U);
}

TEST_F(NodeTest, DecodesNoMessageThatIsTooLarge) {
  int heard = 0;
  dut_.subscribe<experiment_command_t>(channels::kExperimentCommand, [&](const auto&) { ++heard; });
  dut_.start();
  experiment_command_t command{};
  command.sender = "forger";
  command.text.assign(300'000, 'x');
  const std::vector<std::uint8_t> data = encode(command);
  bus_.publish(channels::kExperimentCommand, data);

  const service_status_t& beat = nextBeat();

  EXPECT_EQ(heard, 0);
  EXPECT_EQ(beat.last_error, "EXPERIMENT_COMMAND from forger refused: size: found " +
                                 std::to_string(data.size()) + " bytes, expected at most 256000");
  ASSERT_EQ(beat.received.size(), 1U);
  EXPECT_EQ(beat.received[0].decode_errors, 1);
}

TEST_F(NodeTest, NumbersEveryChannelFromOne) {
  std::map<std::string, std::vector<std::int64_t>> seqs;
  dut_.subscribe<robot_status_t>(channels::kRobotStatus,
                                 [&](const auto& m) { seqs["status"].push_back(m.seq); });
  dut_.subscribe<sim_truth_t>(channels::kSimTruth,
                              [&](const auto& m) { seqs["truth"].push_back(m.seq); });
  publish<robot_status_t>(channels::kRobotStatus);
  publish<sim_truth_t>(channels::kSimTruth);
  publish<robot_status_t>(channels::kRobotStatus);
  bus_.deliver();
  EXPECT_THAT(seqs["status"], ElementsAre(1, 2));
  EXPECT_THAT(seqs["truth"], ElementsAre(1));
}

TEST_F(NodeTest, KeepsTheNumberOfARepeatedCommand) {
  std::vector<std::int64_t> seqs;
  dut_.subscribe<robot_command_t>(channels::kRobotCommand,
                                  [&](const auto& m) { seqs.push_back(m.seq); });
  robot_command_t command{};
  command.seq = 41;
  dut_.publishCommand(channels::kRobotCommand, command);
  dut_.publishCommand(channels::kRobotCommand, command);
  bus_.deliver();
  EXPECT_THAT(seqs, ElementsAre(41, 41));
  dut_.start();
  EXPECT_EQ(sentOf(nextBeat()).at("ROBOT_COMMAND"), 2);
}

TEST_F(NodeTest, SendsAHeartbeatEverySecond) {
  dut_.start();
  bus_.deliver();
  ASSERT_EQ(beats_.size(), 1U);
  EXPECT_EQ(beats_[0].state, service_status_t::STARTING);
  EXPECT_EQ(beats_[0].origin, 2);
  EXPECT_EQ(beats_[0].version, kVersion);
  EXPECT_EQ(beats_[0].contract_version, kContractVersion);
  EXPECT_EQ(beats_[0].start_utime, kStart);
  loop_.runUntil(kStart + 10 * kSecond);
  ASSERT_EQ(beats_.size(), 11U);
  for (std::size_t i = 0; i < beats_.size(); ++i) {
    EXPECT_EQ(beats_[i].utime, kStart + static_cast<std::int64_t>(i) * kSecond);
    EXPECT_EQ(beats_[i].seq, static_cast<std::int64_t>(i) + 1);
  }
}

TEST_F(NodeTest, ReportsReadinessAndFaultsAtOnce) {
  dut_.start();
  dut_.ready();
  bus_.deliver();
  ASSERT_EQ(beats_.size(), 2U);
  EXPECT_EQ(beats_[1].state, service_status_t::READY);
  for (int tick = 0; tick < 50; ++tick)
    dut_.fault("camera unplugged, tick " + std::to_string(tick));
  bus_.deliver();
  ASSERT_EQ(beats_.size(), 3U);  // not fifty messages
  EXPECT_EQ(beats_[2].state, service_status_t::FAULT);
  EXPECT_EQ(beats_[2].last_error, "camera unplugged, tick 0");
  EXPECT_EQ(nextBeat().last_error, "camera unplugged, tick 49");
  dut_.ready();
  bus_.deliver();
  EXPECT_EQ(beats_.back().state, service_status_t::READY);
}

TEST_F(NodeTest, KeepsANotedErrorWithoutAFault) {
  dut_.start();
  dut_.ready();
  dut_.noteError("order refused");
  EXPECT_EQ(nextBeat().last_error, "order refused");
  EXPECT_EQ(beats_.back().state, service_status_t::READY);
  EXPECT_EQ(nextBeat().last_error, "order refused") << "repeated until there is a new one";
}

TEST_F(NodeTest, LosesNoErrorOfASecondWithSeveral) {
  dut_.start();
  dut_.ready();
  dut_.noteError("camera left is lost");
  dut_.noteError("camera right is lost");
  dut_.noteError("camera left is lost");
  EXPECT_EQ(nextBeat().last_error, "camera left is lost; camera right is lost");
  dut_.noteError("order refused");
  dut_.fault("projector unplugged");
  bus_.deliver();
  EXPECT_EQ(beats_.back().last_error, "projector unplugged; order refused");
}

TEST_F(NodeTest, ReportsOnlyTheNewestErrorOfASubject) {
  dut_.start();
  dut_.ready();
  dut_.noteError("overloaded: 10 frames left out", "overload");
  dut_.noteError("camera left is lost");
  dut_.noteError("overloaded: 20 frames left out", "overload");
  EXPECT_EQ(nextBeat().last_error, "overloaded: 20 frames left out; camera left is lost");
  dut_.noteError("overloaded: 40 frames left out", "overload");
  EXPECT_EQ(nextBeat().last_error, "overloaded: 40 frames left out");
}

TEST_F(NodeTest, SpreadsManyErrorsOverHeartbeats) {
  dut_.start();
  std::string expected;
  for (int robot = 0; robot < 200; ++robot) {
    const std::string error = "robot " + std::to_string(robot) + " is silent";
    dut_.noteError(error);
    expected += (robot == 0 ? "" : "; ") + error;
  }
  std::string got;
  while (got.size() < expected.size()) {
    const std::string errors = nextBeat().last_error;
    ASSERT_FALSE(errors.empty());
    ASSERT_LE(errors.size(), 1000U);
    got += (got.empty() ? "" : "; ") + errors;
  }
  EXPECT_EQ(got, expected);
}

/// They may contain texts of other hosts.
TEST_F(NodeTest, CutsALongErrorBetweenCharacters) {
  dut_.start();
  std::string text = "link: x";
  while (text.size() < 300'000) text += "\u00B0";
  dut_.noteError(text);
  EXPECT_EQ(nextBeat().last_error, text.substr(0, 999)) << "the next character has two bytes";
  dut_.fault(text);
  EXPECT_EQ(nextBeat().last_error, text.substr(0, 999));
}

TEST_F(NodeTest, AFloodOfErrorsIsBounded) {
  dut_.start();
  for (int i = 0; i < 100'000; ++i) dut_.noteError("error " + std::to_string(i));
  std::string last;
  for (int beat = 0; beat < 20; ++beat) last = nextBeat().last_error;
  EXPECT_THAT(last, testing::EndsWith("error 99999")) << "the latest is among them";
}

TEST_F(NodeTest, CountsGapsAndLateMessagesOfEveryStream) {
  int handled = 0;
  dut_.subscribe<robot_status_t>(channels::kRobotStatus, [&](const auto&) { ++handled; });
  dut_.start();
  for (const std::int64_t seq : {1, 2, 6, 4}) sendStatus(seq);  // 3 and 5 are lost, 4 is late
  for (const std::int64_t seq : {10, 11}) sendStatus(seq, "sim_svc", 6);
  const service_status_t& status = nextBeat();
  EXPECT_EQ(handled, 6);
  ASSERT_EQ(status.received.size(), 2U);
  EXPECT_EQ(status.received[0].channel, "ROBOT_STATUS");
  EXPECT_EQ(status.received[0].sender, "robot_bridge");
  EXPECT_EQ(status.received[0].instance, 5);
  EXPECT_EQ(status.received[0].received, 4);
  EXPECT_EQ(status.received[0].lost, 2);
  EXPECT_EQ(status.received[1].sender, "sim_svc");
  EXPECT_EQ(status.received[1].lost, 0);
}

TEST_F(NodeTest, CountsUndecodableMessagesAndDoesNotHandleThem) {
  int handled = 0;
  dut_.subscribe<robot_status_t>(channels::kRobotStatus, [&](const auto&) { ++handled; });
  dut_.start();
  sendStatus(1);
  bus_.publish(channels::kRobotStatus, std::vector<std::uint8_t>{1, 2, 3});  // no message
  std::vector<std::uint8_t> tail = encode(robot_status_t{});
  tail.push_back(0);
  bus_.publish(channels::kRobotStatus, tail);
  std::vector<std::uint8_t> negative = encode(robot_status_t{});
  std::fill(negative.end() - 4, negative.end(), std::uint8_t{0xff});  // -1 robots
  bus_.publish(channels::kRobotStatus, negative);
  bus_.publish(channels::kRobotStatus, encode(sim_truth_t{}));  // another type
  EXPECT_NO_THROW(bus_.deliver());
  const service_status_t& status = nextBeat();
  EXPECT_EQ(handled, 1);
  ASSERT_EQ(status.received.size(), 2U);
  EXPECT_EQ(status.received[1].channel, "ROBOT_STATUS");
  EXPECT_EQ(status.received[1].decode_errors, 4);
}

TEST_F(NodeTest, ReportsTheLossesOfItsBusAsTheyAreAtEachHeartbeat) {
  stream_count_t row{};
  row.channel = "bus";
  dut_.reportBus([&row] { return std::vector{row}; });
  dut_.start();
  for (row.lost = 1; row.lost < 3; ++row.lost) {
    const service_status_t& status = nextBeat();
    ASSERT_EQ(status.received.size(), 1U);
    EXPECT_EQ(status.received[0].channel, "bus");
    EXPECT_EQ(status.received[0].lost, row.lost);
  }
}

TEST_F(NodeTest, HasTheFinalCountsInEachClosingMessage) {
  dut_.start();
  loop_.every(kSecond / 50, kStart, [this] { publish<robot_status_t>(channels::kRobotStatus); });
  loop_.every(kSecond / 20, kStart, [this] { publish<sim_truth_t>(channels::kSimTruth); });
  loop_.runUntil(kStart + 3 * kSecond);
  const std::size_t before = beats_.size();
  dut_.close();
  bus_.deliver();
  ASSERT_EQ(beats_.size(), before + 5);
  EXPECT_EQ(on_bus_.at("ROBOT_STATUS"), 151);
  for (std::size_t i = before; i < beats_.size(); ++i) {  // each of them is complete
    EXPECT_EQ(beats_[i].state, service_status_t::ENDED);
    EXPECT_EQ(sentOf(beats_[i]), on_bus_);
  }
}

TEST_F(NodeTest, CountsItsOwnHeartbeatInEveryHeartbeat) {
  dut_.start();
  dut_.ready();
  for (int i = 0; i < 3; ++i) {
    const service_status_t& status = nextBeat();
    EXPECT_EQ(sentOf(status).at("SERVICE_STATUS"), status.seq);
  }
}

TEST_F(NodeTest, IsSilentOnceClosed) {
  dut_.start();
  dut_.close();
  bus_.deliver();
  const std::size_t closed = beats_.size();
  dut_.close();
  dut_.ready();
  dut_.fault("too late");
  loop_.runUntil(kStart + 5 * kSecond);
  EXPECT_EQ(beats_.size(), closed);
}

TEST_F(NodeTest, HidesHostAndProcessInVirtualTime) {
  dut_.start();
  EXPECT_THAT(nextBeat().host, IsEmpty());
  EXPECT_EQ(beats_.back().pid, 0);
}

TEST(NodeLive, ShowsHostAndProcess) {
  AsioLoop loop;
  MemoryBus bus([&loop] { return loop.now(); });
  service_status_t heard{};
  bus.subscribeAll([&](const Packet& packet) { ASSERT_TRUE(decode(packet.data, heard)); });
  Node dut(bus, loop, {"sim_svc", 2, 1});
  dut.start();
  bus.deliver();
  EXPECT_FALSE(heard.host.empty());
  EXPECT_EQ(heard.pid, getpid());
}

/// A bus that refuses every second message.
class MoodyBus final : public Bus {
 public:
  void publish(std::string_view /*channel*/, Bytes /*data*/) override {
    if (++tried_ % 2 == 0) throw std::runtime_error("no buffer space");
  }
  void subscribe(std::string_view /*channel*/, PacketHandler /*handler*/) override {}
  void subscribeAll(PacketHandler /*handler*/) override {}

 private:
  int tried_ = 0;
};

TEST(NodeOnAFailingBus, CountsOnlyMessagesThatWereSent) {
  VirtualLoop loop;
  MoodyBus bus;
  Node dut(bus, loop, {"sim_svc"});
  robot_status_t status{};
  dut.publish(channels::kRobotStatus, status);
  EXPECT_THROW(dut.publish(channels::kRobotStatus, status), std::runtime_error);
  dut.publish(channels::kRobotStatus, status);
  EXPECT_EQ(status.seq, 2);
}

TEST_F(NodeTest, RefusesImpossibleNumbersAndNamesThemOnce) {
  int heard = 0;
  dut_.subscribe<robot_status_t>(channels::kRobotStatus,
                                 [&heard](const robot_status_t&) { ++heard; });
  dut_.start();
  robot_status_t status{};
  status.sender = "forger";
  status.robots.resize(1);
  status.num_robots = 1;
  status.robots[0].wheel_left = 1e300;
  for (int i = 0; i < 3; ++i) bus_.publish(channels::kRobotStatus, encode(status));

  const service_status_t& beat = nextBeat();

  EXPECT_EQ(heard, 0);
  EXPECT_EQ(beat.last_error,
            "ROBOT_STATUS from forger refused: robots[0].wheel_left: found 1e+300, expected -100 "
            "to 100");
  ASSERT_EQ(beat.received.size(), 1U);
  EXPECT_EQ(beat.received[0].decode_errors, 3);
}

TEST_F(NodeTest, RefusesASingleMessageOfAnotherYear) {
  std::vector<std::int64_t> heard;
  dut_.subscribe<robot_status_t>(channels::kRobotStatus, [&heard](const robot_status_t& status) {
    heard.push_back(status.utime);
  });
  robot_status_t status{};
  for (const std::int64_t utime : {kStart, 2 * kStart, kStart + 1}) {
    status.utime = utime;
    bus_.publish(channels::kRobotStatus, encode(status));
  }
  bus_.deliver();
  EXPECT_THAT(heard, ElementsAre(kStart, kStart + 1));
}

TEST_F(NodeTest, AHeartbeatStaysSmallWhateverTheNumberOfSenders) {
  dut_.subscribe<robot_status_t>(channels::kRobotStatus, [](const robot_status_t&) {});
  dut_.start();
  for (std::int64_t i = 0; i < 3000; ++i) sendStatus(1, std::string(63, 'x'), i);

  const service_status_t& beat = nextBeat();

  EXPECT_EQ(beat.received.size(), StreamCounter::kMostStreams);
  EXPECT_LT(encode(beat).size(), 60'000U);
  EXPECT_THAT(beat.last_error, testing::HasSubstr("more than 256 streams"));
}

}  // namespace
}  // namespace lab
