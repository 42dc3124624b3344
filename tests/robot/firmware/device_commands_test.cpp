#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "tests/support/robot_on_bench.hpp"

namespace lab::firmware {
namespace {

wire::SetParam param(uint8_t id, int32_t value) {
  wire::SetParam message;
  message.id = id;
  message.value = value;
  return message;
}

RobotOnBench& booted(RobotOnBench& robot) {
  robot.boot();
  return robot;
}

TEST(Ping, IsAnsweredWithTheTimeOfItsReception) {
  RobotOnBench robot;
  robot.boot();
  robot.run(123);
  wire::Ping ping;
  ping.token_high = 0xDEADBEEF;
  ping.token_low = 42;
  const uint8_t seq = robot.send(ping);
  robot.run(20);
  const wire::Pong pong = robot.last<wire::Pong>();
  EXPECT_EQ(pong.token_high, 0xDEADBEEFU);
  EXPECT_EQ(pong.token_low, 42U);
  EXPECT_EQ(pong.t_ms, 123U);
  EXPECT_EQ(pong.t_us, 250);
  bool echoed = false;
  for (const Heard& heard : robot.heard()) {
    echoed = echoed || (heard.frame.type == wire::Pong::kType && heard.frame.seq == seq);
  }
  EXPECT_TRUE(echoed);
}

TEST(Ping, ReadLateStillHasTheTimeOfItsReception) {
  RobotOnBench robot;
  startPrograms(robot, 5000);
  wire::Frame frame;
  wire::pack(wire::Ping{}, 1, frame);
  uint8_t bytes[wire::kMaxFrame];
  const uint8_t size = wire::encode(frame, bytes);
  const uint32_t draws = robot.device().core().report().draw_count;
  for (uint8_t i = 0; i < size; ++i) robot.device().receive(robot.now() - 3, 900, bytes[i]);
  EXPECT_EQ(robot.device().core().report().draw_count, draws);
  robot.run(20);
  EXPECT_EQ(robot.last<wire::Pong>().t_ms, robot.now() - 23);
  EXPECT_EQ(robot.last<wire::Pong>().t_us, 900);
}

TEST(GetInfo, IsAnsweredByHello) {
  RobotOnBench robot;
  robot.boot();
  robot.run(5);
  robot.send(wire::GetInfo{});
  robot.run(30);
  EXPECT_EQ(robot.all<wire::Hello>().size(), 2U);
  EXPECT_EQ(robot.last<wire::Hello>().uptime_ms, 5U);
}

TEST(Commands, WithUnknownTypeOrWrongLengthAreRefused) {
  RobotOnBench robot;
  startPrograms(robot, 600000);
  const dynamics::CoreReport before = robot.device().core().report();
  for (int type = 0; type < 0x80; ++type) {
    for (uint8_t size = 0; size <= wire::kMaxPayload; ++size) {
      wire::Frame frame;
      frame.type = static_cast<uint8_t>(type);
      frame.seq = size;
      frame.size = size;
      const bool known = type == 0x01 || type == 0x02 || (type >= 0x10 && type <= 0x1E);
      const uint8_t lengths[] = {5, 24, 23, 2, 16, 2, 8, 5, 1, 0, 5, 33, 4, 0, 33};
      const uint8_t right = type == 1 ? 8 : type == 2 ? 0 : lengths[known ? type - 0x10 : 0];
      if (known && size == right) continue;
      robot.heard().clear();
      robot.sendFrame(frame);
      robot.run(15);
      wire::Ack ack;
      for (const Heard& heard : robot.heard()) {
        if (wire::unpack(heard.frame, ack)) break;
      }
      ASSERT_EQ(ack.type, type);
      ASSERT_EQ(ack.status, known ? wire::kBadLength : wire::kUnknownType) << type << " " << size;
    }
  }
  EXPECT_EQ(robot.device().core().report().program_epoch, before.program_epoch);
  EXPECT_FALSE(robot.stands());
}

TEST(Commands, FromRobotsAreNotAnswered) {
  RobotOnBench robot;
  robot.boot();
  robot.send(wire::Ping{});
  robot.run(100);
  robot.heard().clear();
  for (int type = 0x80; type < 0x100; ++type) {
    wire::Frame frame;
    frame.type = static_cast<uint8_t>(type);
    robot.sendFrame(frame);
    robot.run(5);
  }
  EXPECT_TRUE(robot.all<wire::Ack>().empty());
}

TEST(Commands, RepeatedAreAnsweredAgainButNotExecuted) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  wire::Order drive = robot.order(wire::Order::kDrive, 60000, 3);
  const uint8_t seq = robot.send(drive);
  robot.run(60);
  const uint32_t epoch = robot.device().core().report().program_epoch;
  robot.send(robot.order(wire::Order::kTable, 60000, 4));
  robot.run(60);
  EXPECT_GT(robot.device().core().report().program_epoch, epoch);

  const uint8_t last = robot.send(robot.order(wire::Order::kStand, 60000, 5));
  robot.run(1200);
  EXPECT_EQ(robot.last<wire::Counters>().commands_repeated, 0);
  const uint32_t standing = robot.device().core().report().program_epoch;
  for (int i = 0; i < 3; ++i) {
    robot.heard().clear();
    robot.sendAgain(robot.order(wire::Order::kStand, 60000, 5), last);
    robot.run(60);
    EXPECT_EQ(robot.last<wire::Ack>().status, wire::kOk);
  }
  EXPECT_EQ(robot.device().core().report().program_epoch, standing);
  robot.run(1000);
  EXPECT_EQ(robot.last<wire::Counters>().commands_repeated, 3);
  // Only the last command is remembered, and it must also have the same payload.
  robot.sendAgain(drive, last);
  EXPECT_FALSE(robot.stands());
  EXPECT_NE(seq, last);
}

TEST(Commands, RepeatedRefusalIsTheSameRefusal) {
  RobotOnBench robot;
  robot.boot();
  wire::Order order = robot.order(wire::Order::kTable, 1000);
  order.config = 0x1234;
  const uint8_t seq = robot.send(order);
  robot.run(60);
  EXPECT_EQ(robot.last<wire::Ack>().status, wire::kWrongConfig);
  robot.heard().clear();
  robot.sendAgain(order, seq);
  robot.run(60);
  EXPECT_EQ(robot.last<wire::Ack>().status, wire::kWrongConfig);
}

TEST(Apply, AppliesAllSettingsOrNone) {
  RobotOnBench robot;
  robot.boot();
  const dynamics::CoreSettings settings = twoPrograms();
  for (const uint32_t hash : {settings.programs[0], settings.programs[1]}) {
    EXPECT_EQ(robot.load(testPrograms().code(hash)).status, wire::kOk);
  }
  robot.command(wire::programMessage(settings, 0));
  robot.command(wire::programMessage(settings, 1));
  wire::Apply apply;
  apply.config = wire::configCrc(settings);
  EXPECT_EQ(robot.command(apply).status, wire::kWrongConfig) << "two messages are missing";
  EXPECT_EQ(robot.last<wire::Telemetry>().config, 0);
  EXPECT_TRUE(robot.last<wire::Telemetry>().flags & dynamics::kUnconfigured);
  EXPECT_EQ(robot.configure(settings).status, wire::kOk);
  robot.run(100);
  EXPECT_EQ(robot.last<wire::Telemetry>().config, apply.config);
  EXPECT_TRUE(robot.device().core().settings() == settings);
}

TEST(Apply, WithTheSameSettingsChangesNothing) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  const uint32_t epoch = robot.device().core().report().program_epoch;
  EXPECT_EQ(robot.configure(twoPrograms()).status, wire::kOk);
  EXPECT_EQ(robot.device().core().report().program_epoch, epoch);
}

TEST(Apply, RefusesSettingsWithAFault) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  dynamics::CoreSettings fast = twoPrograms();
  fast.max_wheel_um_s = -1;
  const wire::Ack ack = robot.configure(fast);
  EXPECT_EQ(ack.status, wire::kBadValue);
  EXPECT_EQ(ack.detail, wire::kBadLimits);
  EXPECT_TRUE(robot.device().core().settings() == twoPrograms());
  EXPECT_FALSE(robot.stands());
}

TEST(SetProgram, ForANonexistentSlotIsRefused) {
  RobotOnBench robot;
  wire::SetProgram program;
  program.slot = dynamics::kSlots;
  const wire::Ack ack = booted(robot).command(program);
  EXPECT_EQ(ack.status, wire::kBadValue);
  EXPECT_EQ(ack.detail, 0);
}

TEST(Order, IsRefusedForOtherSettingsAndDoesNotRenewTheLease) {
  RobotOnBench robot;
  startPrograms(robot, 500);
  wire::Order order = robot.order(wire::Order::kDrive, 60000, 9);
  ++order.config;
  EXPECT_EQ(robot.command(order).status, wire::kWrongConfig);
  EXPECT_EQ(robot.device().core().report().program, twoPrograms().programs[0]);
  robot.run(500);
  EXPECT_TRUE(robot.stands());
  EXPECT_EQ(robot.last<wire::Telemetry>().order_id, 1);
}

TEST(Order, WithAnUnknownModeIsRefused) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  const wire::Ack ack = robot.command(robot.order(3, 60000));
  EXPECT_EQ(ack.status, wire::kBadValue);
  EXPECT_EQ(ack.detail, 1);
  EXPECT_EQ(robot.device().core().report().program, twoPrograms().programs[0]);
}

TEST(Order, DrivesTheWheels) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  EXPECT_EQ(robot.command(robot.order(wire::Order::kDrive, 60000, 77)).status, wire::kOk);
  EXPECT_EQ(robot.board().left, dynamics::dutyForSpeed(100000, dynamics::kMaxWheelUmS));
  EXPECT_EQ(robot.board().right, dynamics::dutyForSpeed(-50000, dynamics::kMaxWheelUmS));
  robot.run(100);
  EXPECT_EQ(robot.last<wire::Telemetry>().order_id, 77);
  EXPECT_EQ(robot.last<wire::Telemetry>().left_um_s, 100000);
  EXPECT_EQ(robot.last<wire::Telemetry>().right_um_s, -50000);
  // Beyond the limit: clamped and flagged, as on every robot.
  wire::Order order = robot.order(wire::Order::kDrive, 60000, 78);
  order.left_um_s = INT32_MAX;
  order.right_um_s = INT32_MIN;
  EXPECT_EQ(robot.command(order).status, wire::kOk);
  EXPECT_EQ(robot.board().left, 255);
  EXPECT_EQ(robot.board().right, -255);
  robot.run(100);
  EXPECT_TRUE(robot.last<wire::Telemetry>().flags & dynamics::kSaturated);
}

TEST(SetSeed, RepeatedDoesNotRepeatDraws) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  wire::SetSeed seed;
  seed.high = 0;
  seed.low = 42;
  EXPECT_EQ(robot.command(seed).status, wire::kOk);
  EXPECT_EQ(robot.device().core().rng().digest(), dynamics::Rng(42).digest());
  robot.run(2000);
  const uint32_t digest = robot.device().core().rng().digest();
  EXPECT_NE(digest, dynamics::Rng(42).digest());
  robot.send(seed);
  EXPECT_EQ(robot.device().core().rng().digest(), digest);
  seed.high = 1;
  robot.send(seed);
  EXPECT_EQ(robot.device().core().rng().digest(), dynamics::Rng((1ULL << 32) | 42).digest());
}

struct ParamRange {
  uint8_t id;
  int32_t low;
  int32_t high;
  int32_t initial;
};

class Params : public testing::TestWithParam<ParamRange> {};

TEST_P(Params, AreReadAndWrittenWithinTheirRange) {
  const ParamRange range = GetParam();
  RobotOnBench robot;
  robot.boot();
  const auto value = [&] {
    wire::GetParam get;
    get.id = range.id;
    robot.send(get);
    robot.run(60);
    const wire::ParamValue found = robot.last<wire::ParamValue>();
    EXPECT_EQ(found.id, range.id);
    return found.value;
  };
  EXPECT_EQ(value(), range.initial);
  for (int32_t good : {range.low, range.high}) {
    EXPECT_EQ(robot.command(param(range.id, good)).status, wire::kOk);
    EXPECT_EQ(value(), good);
  }
  if (range.low == INT32_MIN) return;
  for (int32_t bad : {range.low - 1, range.high + 1, INT32_MIN, INT32_MAX, range.low - 256}) {
    const wire::Ack ack = robot.command(param(range.id, bad));
    EXPECT_EQ(ack.status, wire::kBadValue) << bad;
    EXPECT_EQ(ack.detail, 1);
    EXPECT_EQ(value(), range.high);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Params,
                         testing::Values(ParamRange{wire::kUid, INT32_MIN, INT32_MAX, 0},
                                         ParamRange{wire::kGainLeft, 500000, 1500000, 1000000},
                                         ParamRange{wire::kGainRight, 500000, 1500000, 1000000},
                                         ParamRange{wire::kDeadBandLeft, 0, 127, 0},
                                         ParamRange{wire::kDeadBandRight, 0, 127, 0},
                                         ParamRange{wire::kWheelBase, 10000, 500000, 75000},
                                         ParamRange{wire::kTelemetryPeriod, 10, 60000, 50},
                                         ParamRange{wire::kStepLog, 0, 1, 1}));

TEST(Param, WithAnUnknownIdIsRefused) {
  RobotOnBench robot;
  robot.boot();
  for (const uint8_t id : std::initializer_list<uint8_t>{0, 9, 255}) {
    const wire::Ack set = robot.command(param(id, 1));
    EXPECT_EQ(set.status, wire::kBadValue);
    EXPECT_EQ(set.detail, 0);
    wire::GetParam get;
    get.id = id;
    const wire::Ack got = robot.command(get);
    EXPECT_EQ(got.type, wire::GetParam::kType);
    EXPECT_EQ(got.status, wire::kBadValue);
  }
}

TEST(Param, ForAWheelTakesEffectAtOnce) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  robot.command(robot.order(wire::Order::kDrive, 60000));
  robot.send(param(wire::kGainLeft, 800000));
  EXPECT_EQ(robot.board().left, std::lround(100000 * 255 / (270000 * 0.8)));
  robot.send(param(wire::kDeadBandRight, 55));
  EXPECT_EQ(robot.board().right, -55 - std::lround(50000 * 200 / 270000.0));
}

TEST(Commit, WritesOneBytePerMillisecondAndAnswersAfterReadingBack) {
  RobotOnBench robot;
  robot.boot();
  robot.command(param(wire::kUid, 0x51000007));
  robot.command(param(wire::kGainLeft, 1100000));
  const int before = robot.board().store_writes;
  const uint8_t seq = robot.send(wire::Commit{});
  for (int i = 0; i < 20; ++i) {
    EXPECT_LE(robot.board().store_writes, before + i);
    robot.run(1);
  }
  robot.run(60);
  EXPECT_EQ(robot.last<wire::Ack>().status, wire::kOk);
  EXPECT_EQ(robot.last<wire::Ack>().type, wire::Commit::kType);
  EXPECT_EQ(robot.last<wire::Event>().code, wire::kSettingsStored);
  bool answered = false;
  for (const Heard& heard : robot.heard()) {
    answered = answered || (heard.frame.type == wire::Ack::kType && heard.frame.seq == seq);
  }
  EXPECT_TRUE(answered);

  robot.boot();
  EXPECT_EQ(robot.device().settings().uid, 0x51000007U);
  EXPECT_EQ(robot.device().settings().left.gain_ppm, 1100000);
  robot.run(60);
  EXPECT_EQ(robot.last<wire::Hello>().settings_from, 0);
}

TEST(Commit, OfUnchangedSettingsWritesNothing) {
  RobotOnBench robot;
  robot.boot();
  EXPECT_EQ(robot.command(wire::Commit{}).status, wire::kOk);
  const int writes = robot.board().store_writes;
  EXPECT_EQ(robot.command(wire::Commit{}).status, wire::kOk);
  EXPECT_EQ(robot.board().store_writes, writes);
}

TEST(Commit, WaitsUntilTheWheelsStand) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  const int writes = robot.board().store_writes;
  EXPECT_EQ(robot.command(wire::Commit{}).status, wire::kBusy);
  EXPECT_EQ(robot.board().store_writes, writes);
  robot.command(robot.order(wire::Order::kStand, 60000));
  EXPECT_EQ(robot.command(wire::Commit{}).status, wire::kOk);
  EXPECT_GT(robot.board().store_writes, writes);
}

TEST(Commit, RepeatedDuringWritingIsAnsweredOnceAtTheEnd) {
  RobotOnBench robot;
  robot.boot();
  robot.run(20);
  const uint8_t seq = robot.send(wire::Commit{});
  robot.run(3);
  robot.sendAgain(wire::Commit{}, seq);
  wire::Commit another;
  const uint8_t second = robot.send(another);
  robot.run(100);
  std::vector<std::pair<int, int>> answers;
  for (const Heard& heard : robot.heard()) {
    wire::Ack ack;
    if (wire::unpack(heard.frame, ack)) answers.emplace_back(heard.frame.seq, ack.status);
  }
  const std::pair<int, int> busy{second, wire::kBusy};
  const std::pair<int, int> done{seq, wire::kOk};
  EXPECT_THAT(answers, testing::ElementsAre(busy, done));
}

TEST(Commit, ToADefectiveEepromIsReported) {
  RobotOnBench robot;
  robot.boot();
  robot.board().store_dead = true;
  EXPECT_EQ(robot.command(wire::Commit{}).status, wire::kStoreFailed);
}

}  // namespace
}  // namespace lab::firmware
