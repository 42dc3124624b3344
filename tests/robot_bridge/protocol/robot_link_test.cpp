#include "robot_bridge/protocol/robot_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <vector>

#include "common/experiment/program_messages.hpp"
#include "common/programs/shipped_programs.hpp"
#include "robot/wire/config.hpp"

namespace lab::bridge {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kStartTime = 1'000'000'000;  // [us]

/// A RobotLink whose line ends in this test: it decodes the frames and can answer them.
class RobotLinkTest : public testing::Test {
 protected:
  void plug(std::uint16_t boot_id = 1) {
    wire::Hello hello;
    hello.schema = wire::kSchema;
    hello.boot_id = boot_id;
    dut.plug(hello, now);
  }

  /// The frames sent since the last call, without PING.
  std::vector<wire::Frame> takeSent() {
    std::vector<wire::Frame> frames;
    wire::Decoder decoder;
    for (const std::uint8_t byte : dut.outgoing()) {
      if (decoder.push(byte) && decoder.frame().type != wire::Ping::kType) {
        frames.push_back(decoder.frame());
      }
    }
    dut.outgoing().clear();
    return frames;
  }

  template <class Message>
  void receive(const Message& message, std::uint8_t seq) {
    wire::Frame frame;
    wire::pack(message, seq, frame);
    dut.receive(frame, now);
  }

  void acknowledge(const wire::Frame& command, wire::AckStatus status = wire::kOk) {
    wire::Ack ack;
    ack.type = command.type;
    ack.status = status;
    receive(ack, command.seq);
  }

  /// Answers everything that is sent as a robot would, and returns the types of the messages.
  std::vector<int> answerAll() {
    std::vector<int> types;
    for (std::vector<wire::Frame> sent = takeSent(); !sent.empty(); sent = takeSent()) {
      for (const wire::Frame& frame : sent) {
        types.push_back(frame.type);
        wire::GetParam get;
        if (wire::unpack(frame, get)) {
          wire::ParamValue value;
          value.id = get.id;
          value.value = 80'000;  // [um] the wheel base
          receive(value, frame.seq);
        } else if (frame.type == wire::GetPrograms::kType) {
          receive(stored, frame.seq);
        } else if (frame.type == wire::LoadBegin::kType && places == 0) {
          acknowledge(frame, wire::kNoPlace);
        } else {
          wire::Apply apply;
          if (wire::unpack(frame, apply)) places = 5;  // the settings in force are others now
          wire::LoadEnd end;
          if (wire::unpack(frame, end)) stored.hash[--places] = end.hash;
          acknowledge(frame);
        }
      }
    }
    return types;
  }

  void command(std::int64_t seq, const robot_order_t& order, std::int32_t lease_ms = 1000) {
    dut.command(seq, 1, lease_ms, order, now);
  }

  /// Gives the robot the value as sense(0).
  void senseAndTick(dynamics::Fixed value) {
    std::array<dynamics::Fixed, dynamics::kSenses> values{};
    values[0] = value;
    dut.sense(values, value, now);
    dut.tick(now);
  }

  static std::vector<int> typesOf(const std::vector<wire::Frame>& frames) {
    std::vector<int> types;
    for (const wire::Frame& frame : frames) types.push_back(frame.type);
    return types;
  }

  static robot_order_t drive(double speed) {
    robot_order_t order{};
    order.mode = robot_order_t::DRIVE;
    order.wheel_left = speed;
    order.wheel_right = speed;
    return order;
  }

  static robot_order_t stand() {
    robot_order_t order{};
    order.mode = robot_order_t::STAND;
    return order;
  }

  /// The last ORDER in `frames`.
  static std::optional<wire::Order> orderIn(const std::vector<wire::Frame>& frames) {
    std::optional<wire::Order> found;
    wire::Order order;
    for (const wire::Frame& frame : frames) {
      if (wire::unpack(frame, order)) found = order;
    }
    return found;
  }

  wire::Programs stored;  ///< what the robot has
  int places = 5;         ///< without a program in use
  std::int64_t now = kStartTime;
  RobotLink dut{LinkSettings{}};
};

/// The answer to the last PING that was sent, if any. To be called before takeSent().
std::optional<wire::Pong> pongFor(const std::vector<std::uint8_t>& sent) {
  std::optional<wire::Pong> pong;
  wire::Decoder decoder;
  wire::Ping ping;
  for (const std::uint8_t byte : sent) {
    if (!decoder.push(byte) || !wire::unpack(decoder.frame(), ping)) continue;
    pong.emplace();
    pong->token_high = ping.token_high;
    pong->token_low = ping.token_low;
  }
  return pong;
}

TEST_F(RobotLinkTest, AnAnswerBeforeTheFirstPingIsIgnored) {
  receive(wire::Pong(), 0);
  EXPECT_EQ(dut.counters().round_trip_us, 0);
  EXPECT_FALSE(dut.clock().known());
}

/// A robot that repeated its PONG added a sample of its clock each time, until the bridge stood.
TEST_F(RobotLinkTest, APingIsAnsweredOnce) {
  plug();
  std::optional<wire::Pong> pong = pongFor(dut.outgoing());
  ASSERT_TRUE(pong);
  answerAll();
  now += 10'000;
  receive(*pong, 0);
  EXPECT_EQ(dut.counters().round_trip_us, 10'000);
  now += 5'000;
  receive(*pong, 0);
  EXPECT_EQ(dut.counters().round_trip_us, 10'000) << "the repetition counts for nothing";
  now += 200'000;
  dut.tick(now);
  pong = pongFor(dut.outgoing());
  ASSERT_TRUE(pong);
  now += 7'000;
  receive(*pong, 0);
  EXPECT_EQ(dut.counters().round_trip_us, 7'000) << "the next PING is answered as before";
}

TEST_F(RobotLinkTest, SetsSeedAndParametersAndReadsTheWheelBaseFirst) {
  plug();

  EXPECT_THAT(answerAll(), ElementsAre(wire::SetSeed::kType, wire::SetParam::kType,
                                       wire::SetParam::kType, wire::GetParam::kType));
}

TEST_F(RobotLinkTest, SendsOnlyOneCommandUntilItIsAnswered) {
  plug();
  takeSent();

  dut.tick(now + 20'000);

  EXPECT_THAT(takeSent(), testing::IsEmpty());
}

TEST_F(RobotLinkTest, SendsSettingsThenAppliesThemThenOrders) {
  plug();
  answerAll();

  command(7, drive(0.1));

  EXPECT_THAT(answerAll(),
              ElementsAre(wire::SetProgram::kType, wire::SetProgram::kType, wire::SetProgram::kType,
                          wire::SetProgram::kType, wire::SetLight::kType, wire::SetMotion::kType,
                          wire::Apply::kType, wire::Order::kType));
  EXPECT_EQ(dut.commandSeq(), 7) << "the acknowledged ORDER confirms the command";
}

/// One band with a program of more than 32 bytes.
robot_order_t tableOf(const std::string& name) {
  robot_order_t order{};
  order.mode = robot_order_t::TABLE;
  light_band_t band{};
  band.high = 1;
  band.program = toMessage(shippedProgram(name));
  order.bands = {band};
  order.num_bands = 1;
  return order;
}

TEST_F(RobotLinkTest, LoadsAMissingProgramAfterStagingItAndBeforeItApplies) {
  plug();
  answerAll();
  const robot_order_t order = tableOf("rtp");
  const std::size_t size = order.bands[0].program.code.size();
  ASSERT_GT(size, 32U);
  ASSERT_LE(size, 64U);
  command(1, order);
  EXPECT_THAT(answerAll(),
              ElementsAre(wire::SetProgram::kType, wire::SetProgram::kType, wire::SetProgram::kType,
                          wire::SetProgram::kType, wire::GetPrograms::kType, wire::LoadBegin::kType,
                          wire::LoadData::kType, wire::LoadData::kType, wire::LoadEnd::kType,
                          wire::SetLight::kType, wire::SetMotion::kType, wire::Apply::kType,
                          wire::Order::kType));
  EXPECT_EQ(stored.hash[4], order.bands[0].program.id.hash);
  EXPECT_EQ(dut.counters().programs_loaded, 1);
  // The robot keeps it: another table with the same program loads nothing.
  robot_order_t other = order;
  other.hysteresis = 0.1;
  command(2, other);
  EXPECT_THAT(answerAll(),
              ElementsAre(wire::SetLight::kType, wire::Apply::kType, wire::Order::kType));
}

TEST_F(RobotLinkTest, AProgramThatTheRobotHasIsNotLoaded) {
  plug();
  answerAll();
  const robot_order_t order = tableOf("rtp");
  stored.hash[2] = static_cast<std::uint32_t>(order.bands[0].program.id.hash);
  command(1, order);
  EXPECT_THAT(answerAll(), Not(Contains(wire::LoadBegin::kType)));
  EXPECT_EQ(dut.commandSeq(), 1);
}

TEST_F(RobotLinkTest, GivesUpTheProgramsInForceIfTheRobotHasNoPlaceForAnother) {
  plug();
  answerAll();
  places = 0;
  command(1, tableOf("abp"));
  const std::vector<int> types = answerAll();
  // Without programs, then with the new one.
  EXPECT_EQ(std::count(types.begin(), types.end(), wire::Apply::kType), 2);
  EXPECT_EQ(dut.counters().programs_loaded, 1);
  EXPECT_EQ(dut.commandSeq(), 1);
  EXPECT_FALSE(dut.isRejected());
}

TEST_F(RobotLinkTest, AProgramThatTheRobotRefusesIsReported) {
  plug();
  answerAll();
  command(1, tableOf("abp"));
  for (int i = 0; i < 100 && !dut.isRejected(); ++i) {
    for (const wire::Frame& frame : takeSent()) {
      if (frame.type == wire::GetPrograms::kType) {
        receive(stored, frame.seq);
      } else {
        acknowledge(frame, frame.type == wire::LoadEnd::kType ? wire::kBadProgram : wire::kOk);
      }
    }
  }
  EXPECT_TRUE(dut.isRejected());
  EXPECT_THAT(dut.takeNotes(), Contains(HasSubstr("refuses its settings")));
}

TEST_F(RobotLinkTest, SensesAreSentAtOnceAndReportedWhenTheRobotHasThem) {
  plug();
  answerAll();
  command(1, drive(0.1));
  takeSent();
  std::array<dynamics::Fixed, dynamics::kSenses> values{};
  values[3] = 12345;
  dut.sense(values, 777, now);
  wire::SetSenses senses;
  std::vector<wire::Frame> sent = takeSent();
  ASSERT_EQ(sent.size(), 1U) << "although an answer is awaited";
  ASSERT_TRUE(wire::unpack(sent[0], senses));
  EXPECT_EQ(senses.sense[3], 12345);
  EXPECT_EQ(dut.senses().utime, 0);
  wire::Telemetry telemetry;
  telemetry.senses_id = senses.id;
  receive(telemetry, 0);
  EXPECT_EQ(dut.senses().utime, 777);
  EXPECT_NEAR(static_cast<double>(dut.senses().since_utime - now), 10'900, 100)
      << "42 bytes on the line";
}

TEST_F(RobotLinkTest, SensesTakeAPartOfTheLineAndTheNewestAreSent) {
  plug();
  answerAll();
  int sent = 0;
  for (int i = 1; i <= 1000; ++i) {
    now += 1'000;
    if (i % 50 == 0) receive(wire::Telemetry(), 0);
    senseAndTick(i);
    for (const wire::Frame& frame : takeSent()) {
      wire::SetSenses senses;
      if (!wire::unpack(frame, senses)) continue;
      ++sent;
      // A frame that the robot sends between two values lets those before go.
      EXPECT_GE(senses.sense[0], i - 1) << "the newest are sent";
    }
  }
  EXPECT_GE(sent, 50) << "as often as the tracker sends them";
  EXPECT_LE(sent, 55) << "42 bytes, 10.9 ms each";
}

TEST_F(RobotLinkTest, SensesThatWaitAreSentOnceAfterAStop) {
  plug();
  answerAll();
  senseAndTick(1);
  EXPECT_THAT(typesOf(takeSent()), ElementsAre(wire::SetSenses::kType));
  now += 15'000;
  senseAndTick(2);
  dut.stop(5, false, now);
  EXPECT_THAT(typesOf(takeSent()), ElementsAre(wire::Stop::kType));
  now += 100'000;
  dut.tick(now);
  EXPECT_THAT(typesOf(takeSent()), ElementsAre(wire::Stop::kType, wire::SetSenses::kType));
  now += 20'000;
  dut.tick(now);
  EXPECT_THAT(typesOf(takeSent()), testing::IsEmpty());
}

TEST_F(RobotLinkTest, SensesThatWaitAreNotForTheNextLine) {
  plug();
  answerAll();
  senseAndTick(1);
  senseAndTick(2);
  dut.unplug();
  now += 1'000'000;
  plug();
  EXPECT_THAT(answerAll(), Not(Contains(wire::SetSenses::kType)));
}

TEST_F(RobotLinkTest, StandingNeedsNoSettings) {
  plug();
  answerAll();

  command(1, stand());

  EXPECT_THAT(answerAll(), ElementsAre(wire::Order::kType));
}

TEST_F(RobotLinkTest, ARepeatedCommandSendsOnlyTheOrderAgain) {
  plug();
  answerAll();
  command(7, drive(0.1));
  answerAll();

  now += 120'000;
  command(7, drive(0.1));

  EXPECT_THAT(answerAll(), ElementsAre(wire::Order::kType));
}

TEST_F(RobotLinkTest, AStopIsSentBeforeTheAnswerToACommandAndRepeatedUntilItIsConfirmed) {
  plug();
  takeSent();  // SET_SEED is not answered

  dut.stop(5, false, now);
  const std::vector<wire::Frame> first = takeSent();
  dut.tick(now + 100'000);
  const std::vector<wire::Frame> second = takeSent();
  ASSERT_EQ(first.size(), 1U);
  ASSERT_FALSE(second.empty());
  EXPECT_EQ(first[0].type, wire::Stop::kType);
  EXPECT_EQ(second[0].type, wire::Stop::kType);
  EXPECT_EQ(dut.stopSeq(), 0);

  acknowledge(second[0]);

  EXPECT_EQ(dut.stopSeq(), 5);
  dut.tick(now + 220'000);
  for (const wire::Frame& frame : takeSent()) EXPECT_NE(frame.type, wire::Stop::kType);
}

TEST_F(RobotLinkTest, SendsNoOrderWhileAStopIsNotConfirmed) {
  plug();
  answerAll();
  dut.stop(5, false, now);
  takeSent();

  command(7, stand());

  EXPECT_THAT(answerAll(), Not(Contains(wire::Order::kType)));
}

TEST_F(RobotLinkTest, AnOrderThatIsSentAgainHasTheRemainingLease) {
  plug();
  answerAll();
  command(1, stand(), 1000);
  const std::optional<wire::Order> first = orderIn(takeSent());

  dut.tick(now + 150'000);
  const std::optional<wire::Order> second = orderIn(takeSent());

  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->lease_ms, 1000U);
  EXPECT_EQ(second->lease_ms, 850U);
  EXPECT_EQ(dut.counters().retries, 1);
}

TEST_F(RobotLinkTest, GivesACommandUpAfterThreeAttempts) {
  plug();
  for (int i = 0; i < 3; ++i) {
    now += 150'000;
    dut.tick(now);
  }

  EXPECT_TRUE(dut.isDegraded());
  EXPECT_EQ(dut.counters().retries, 2);
  EXPECT_EQ(dut.counters().failed, 1);
  EXPECT_THAT(dut.takeNotes(), Contains(HasSubstr("does not answer")));
}

TEST_F(RobotLinkTest, ARobotThatRestartsStandsUntilANewOrder) {
  plug();
  answerAll();
  command(7, drive(0.1));
  answerAll();
  ASSERT_EQ(dut.commandSeq(), 7);

  dut.unplug();
  plug(2);
  answerAll();
  now += 120'000;
  command(7, drive(0.1));
  const std::optional<wire::Order> repeated = orderIn(takeSent());
  ASSERT_TRUE(repeated);
  EXPECT_EQ(repeated->mode, wire::Order::kStand);
  EXPECT_EQ(dut.commandSeq(), 0);
  EXPECT_EQ(dut.counters().reboots, 1);
}

TEST_F(RobotLinkTest, AClockThatGoesBackByTheLongestTimeIsARestart) {
  plug();
  answerAll();
  now += 100'000;
  wire::Hello hello;
  hello.schema = wire::kSchema;
  hello.boot_id = 1;
  hello.uptime_ms = 0U - 0x7FFFFFFFU;  // it was 0
  receive(hello, 0);
  EXPECT_EQ(dut.counters().reboots, 1);
}

TEST_F(RobotLinkTest, AnOrderBeyondTheWheelsIsRejectedAndThePreviousOneStays) {
  plug();
  answerAll();
  command(7, drive(0.1));
  answerAll();

  // Longer than the spacing of repeated orders, shorter than the silence after which a link is
  // stale.
  now += 120'000;
  command(8, drive(0.5));
  const std::optional<wire::Order> order = orderIn(takeSent());

  EXPECT_TRUE(dut.isRejected());
  EXPECT_EQ(dut.commandSeq(), 8) << "the refusal is the answer to the command";
  ASSERT_TRUE(order);
  EXPECT_EQ(order->left_um_s, 100'000);
  EXPECT_THAT(dut.takeNotes(), Contains(HasSubstr("refuses ROBOT_COMMAND 8")));
}

TEST_F(RobotLinkTest, AfterARefusalOfItsSettingsNothingIsSentUntilANewOrder) {
  plug();
  answerAll();
  command(7, drive(0.1));
  const std::vector<wire::Frame> sent = takeSent();
  ASSERT_EQ(sent.size(), 1U);
  acknowledge(sent[0], wire::kBadValue);
  EXPECT_TRUE(dut.isRejected());
  EXPECT_THAT(answerAll(), testing::IsEmpty());

  command(8, drive(0.05));

  EXPECT_FALSE(answerAll().empty());
  EXPECT_FALSE(dut.isRejected());
  EXPECT_EQ(dut.commandSeq(), 8);
}

}  // namespace
}  // namespace lab::bridge
