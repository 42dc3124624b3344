// Loading of programs of motion over the line.
#include <gmock/gmock.h>

#include <cstdlib>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "tests/support/robot_on_bench.hpp"

namespace lab::firmware::device_programs_test {
namespace {

using Code = std::vector<uint8_t>;

/// Drives straight at this speed [cm/s].
uint32_t straight(int speed) {
  return hashOf(programText({drivingPhase("run", std::to_string(speed) + " cm/s", "", "1 s")}));
}

dynamics::CoreSettings running(std::vector<uint32_t> programs) {
  dynamics::CoreSettings settings = twoPrograms();
  for (std::size_t i = 0; i < dynamics::kSlots; ++i) {
    settings.programs[i] = i < programs.size() ? programs[i] : 0;
  }
  return settings;
}

wire::Programs programsOf(RobotOnBench& robot) {
  robot.send(wire::GetPrograms{});
  robot.run(40);
  return robot.last<wire::Programs>();
}

TEST(LoadProgram, StoresAProgramThatRunsAndSurvivesAReset) {
  RobotOnBench robot;
  robot.boot();
  const uint32_t hash = straight(5);
  EXPECT_EQ(robot.load(testPrograms().code(hash)).status, wire::kOk);
  EXPECT_THAT(programsOf(robot).hash, testing::ElementsAre(hash, 0, 0, 0, 0));
  EXPECT_EQ(robot.last<wire::Event>().code, wire::kProgramStored);
  EXPECT_EQ(robot.last<wire::Event>().data, hash);
  robot.boot();
  EXPECT_THAT(programsOf(robot).hash, testing::ElementsAre(hash, 0, 0, 0, 0));
  const int writes = robot.board().store_writes;
  EXPECT_EQ(robot.configure(running({hash})).status, wire::kOk);
  EXPECT_EQ(robot.command(robot.order(wire::Order::kTable, 60000)).status, wire::kOk);
  EXPECT_EQ(robot.device().core().report().held.left, 50000);
  EXPECT_EQ(programsOf(robot).running, hash);
  EXPECT_EQ(robot.load(testPrograms().code(hash)).status, wire::kOk);
  EXPECT_EQ(robot.board().store_writes, writes) << "it is stored already";
}

TEST(LoadProgram, OfTheLargestSizeTakesLessThanASecondAt38400Baud) {
  RobotOnBench robot;
  robot.board().store_write_ms = 3.4;
  const Code code = programOfSize(dynamics::kLargestProgram, 5);
  robot.boot();
  robot.send(wire::Ping{});
  robot.run(2000);
  // The host sends each message when it has the answer to the one before, at the line's speed.
  const uint32_t begin = robot.now();
  const uint32_t hash = dynamics::programHash(code.data(), dynamics::kLargestProgram);
  const auto exchange = [&](const auto& message) {
    const uint32_t on_line =
        (wire::payloadSize<std::remove_cvref_t<decltype(message)>>() + wire::kFrameOverhead) * 10 /
            38 +
        1;
    robot.run(on_line);
    const std::size_t before = robot.all<wire::Ack>().size();
    robot.send(message);
    while (robot.all<wire::Ack>().size() == before && robot.now() - begin < 5000) robot.run(1);
    EXPECT_EQ(robot.last<wire::Ack>().status, wire::kOk);
  };
  exchange(wire::LoadBegin{hash, dynamics::kLargestProgram});
  for (uint8_t at = 0; at < dynamics::kLargestProgram; at = static_cast<uint8_t>(at + 32)) {
    wire::LoadData data;
    data.offset = at;
    std::copy(code.begin() + at, code.begin() + std::min(at + 32, 176), data.code);
    exchange(data);
  }
  exchange(wire::LoadEnd{hash});
  EXPECT_EQ(programsOf(robot).hash[0], hash);
  const uint32_t took = robot.now() - begin - 40;
  std::cout << "176 bytes: " << took << " ms\n";
  EXPECT_GT(took, 600U) << "the EEPROM alone takes 620 ms";
  EXPECT_LT(took, 1000U);
}

TEST(LoadProgram, DoesNotDisturbTheRunningProgram) {
  RobotOnBench robot;
  startPrograms(robot, 600000);
  RobotOnBench undisturbed;
  startPrograms(undisturbed, 600000);
  EXPECT_EQ(robot.load(testPrograms().code(straight(7))).status, wire::kOk);
  undisturbed.run(robot.now() - undisturbed.now());
  EXPECT_EQ(robot.device().core().report().draw_count,
            undisturbed.device().core().report().draw_count);
  EXPECT_EQ(robot.device().core().rng().digest(), undisturbed.device().core().rng().digest());
  EXPECT_FALSE(robot.stands());
}

TEST(Apply, IsRefusedWithoutItsPrograms) {
  RobotOnBench robot;
  startPrograms(robot, 60000);
  dynamics::CoreSettings settings = twoPrograms();
  settings.programs[2] = straight(8);
  for (uint8_t slot = 0; slot < dynamics::kSlots; ++slot) {
    robot.command(wire::programMessage(settings, slot));
  }
  robot.command(wire::lightMessage(settings));
  robot.command(wire::motionMessage(settings));
  const wire::Ack ack = robot.command(wire::Apply{wire::configCrc(settings)});
  EXPECT_EQ(ack.status, wire::kMissing);
  EXPECT_EQ(ack.detail, 2);
  EXPECT_TRUE(robot.device().core().settings() == twoPrograms());
  EXPECT_FALSE(robot.stands());
  EXPECT_EQ(robot.configure(settings).status, wire::kOk);
}

TEST(LoadProgram, NeverOverwritesAProgramInASlot) {
  RobotOnBench robot;
  robot.boot();
  std::vector<uint32_t> first{straight(1), straight(2), straight(3), straight(4)};
  EXPECT_EQ(robot.configure(running(first)).status, wire::kOk);
  EXPECT_EQ(robot.load(testPrograms().code(straight(5))).status, wire::kOk) << "the fifth place";
  EXPECT_EQ(robot.load(testPrograms().code(straight(6))).status, wire::kOk) << "in its place";
  EXPECT_THAT(programsOf(robot).hash,
              testing::ElementsAre(first[0], first[1], first[2], first[3], straight(6)));
  // Staged for a slot, it is protected as well.
  EXPECT_EQ(robot.command(wire::SetProgram{0, straight(6)}).status, wire::kOk);
  EXPECT_EQ(robot.command(wire::LoadBegin{straight(7), 20}).status, wire::kNoPlace);
  EXPECT_EQ(robot.load(testPrograms().code(straight(6))).status, wire::kOk) << "it is there";
  // Settings without programs free all places.
  EXPECT_EQ(robot.configure(running({})).status, wire::kOk);
  std::vector<uint32_t> second{straight(7), straight(8), straight(9), straight(10)};
  EXPECT_EQ(robot.configure(running(second)).status, wire::kOk);
}

TEST(LoadProgram, OtherBytesOrInvalidCodeAreRefused) {
  RobotOnBench robot;
  robot.boot();
  const Code good = testPrograms().code(straight(5));
  const auto load = [&](Code code, uint32_t hash) {
    EXPECT_EQ(robot.command(wire::LoadBegin{hash, static_cast<uint8_t>(code.size())}).status,
              wire::kOk);
    code.resize(32);
    wire::LoadData data;
    std::copy(code.begin(), code.end(), data.code);
    EXPECT_EQ(robot.command(data).status, wire::kOk);
    return robot.command(wire::LoadEnd{hash});
  };
  ASSERT_LE(good.size(), 32U);
  const uint32_t hash = straight(5);
  wire::Ack ack = load(good, hash + 1);
  EXPECT_EQ(ack.status, wire::kBadProgram);
  EXPECT_EQ(ack.detail, 0);
  Code bad = good;
  bad[4] = 0;
  ack = load(bad, hash);
  EXPECT_EQ(ack.status, wire::kBadProgram);
  EXPECT_EQ(ack.detail, 0) << "other bytes";
  ack = load(bad, dynamics::programHash(bad.data(), static_cast<uint8_t>(bad.size())));
  EXPECT_EQ(ack.status, wire::kBadProgram);
  EXPECT_EQ(ack.detail, dynamics::kBadOpcode);
  EXPECT_EQ(robot.command(wire::LoadEnd{12345}).status, wire::kBadProgram);
  EXPECT_THAT(programsOf(robot).hash, testing::Each(0U));
  EXPECT_EQ(robot.board().store[ProgramStore::kAddress], 0xFF) << "nothing was written";
  EXPECT_EQ(robot.command(wire::LoadBegin{hash, 2}).detail, 1);
  EXPECT_EQ(robot.command(wire::LoadBegin{hash, 177}).status, wire::kBadValue);
  EXPECT_EQ(robot.command(wire::LoadBegin{0, 100}).status, wire::kBadValue);
}

TEST(LoadProgram, IsBusyWhileTheEepromIsWritten) {
  RobotOnBench robot;
  robot.board().store_write_ms = 3.4;
  robot.boot();
  robot.send(wire::Ping{});
  robot.run(100);
  const Code code = programOfSize(dynamics::kLargestProgram, 5);
  const uint32_t hash = dynamics::programHash(code.data(), dynamics::kLargestProgram);
  robot.command(wire::LoadBegin{hash, dynamics::kLargestProgram});
  wire::LoadData data;
  for (uint8_t at = 0; at < dynamics::kLargestProgram; at = static_cast<uint8_t>(at + 32)) {
    data.offset = at;
    std::copy(code.begin() + at, code.begin() + std::min(at + 32, 176), data.code);
    robot.command(data);
  }
  const uint8_t seq = robot.send(wire::LoadEnd{hash});
  robot.run(20);
  robot.sendAgain(wire::LoadEnd{hash}, seq);
  for (const wire::Ack& ack : {robot.command(wire::LoadBegin{1, 100}), robot.command(data),
                               robot.command(wire::LoadEnd{hash}), robot.command(wire::Commit{})}) {
    EXPECT_EQ(ack.status, wire::kBusy);
  }
  robot.run(1000);
  int answers = 0;
  for (const Heard& heard : robot.heard()) {
    wire::Ack ack;
    if (heard.frame.seq != seq || !wire::unpack(heard.frame, ack)) continue;
    ++answers;
    EXPECT_EQ(ack.status, wire::kOk);
  }
  EXPECT_EQ(answers, 1);
}

TEST(LoadProgram, ADefectiveEepromIsReported) {
  RobotOnBench robot;
  robot.boot();
  robot.board().store_dead = true;
  EXPECT_EQ(robot.load(testPrograms().code(straight(5))).status, wire::kStoreFailed);
}

/// Sends a message until it is answered, over a line that loses frames in both directions.
class LossyHost {
 public:
  LossyHost(RobotOnBench& robot, double loss, unsigned seed)
      : robot_(robot), loss_(loss), random_(seed) {}

  template <class Message>
  uint8_t command(const Message& message, uint32_t timeout_ms) {
    wire::Frame frame;
    wire::pack(message, ++seq_, frame);
    for (int attempt = 0; attempt < 100; ++attempt) {
      std::size_t at = robot_.heard().size();
      ++sent_;
      if (!lost()) robot_.sendFrame(frame);
      for (uint32_t ms = 0; ms < timeout_ms; ++ms) {
        robot_.run(1);
        for (; at < robot_.heard().size(); ++at) {
          wire::Ack ack;
          const wire::Frame& heard = robot_.heard()[at].frame;
          if (heard.seq == seq_ && wire::unpack(heard, ack) && ack.type == Message::kType &&
              !lost()) {
            return ack.status;
          }
        }
      }
    }
    ADD_FAILURE() << "no answer";
    return 255;
  }

  int sent() const { return sent_; }

 private:
  bool lost() { return std::uniform_real_distribution<>(0, 1)(random_) < loss_; }

  RobotOnBench& robot_;
  double loss_;
  std::mt19937 random_;
  uint8_t seq_ = 0;
  int sent_ = 0;
};

TEST(LoadProgram, SurvivesLostFrames) {
  int sent = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    RobotOnBench robot;
    robot.board().store_write_ms = 3.4;
    robot.boot();
    LossyHost host(robot, 0.3, seed);
    const uint32_t hash = hashOf(rtpText("5 cm/s", "1 1/s", "0.5 s"));
    const Code& code = testPrograms().code(hash);
    EXPECT_EQ(host.command(wire::LoadBegin{hash, static_cast<uint8_t>(code.size())}, 150),
              wire::kOk);
    for (std::size_t at = 0; at < code.size(); at += 32) {
      wire::LoadData data;
      data.offset = static_cast<uint8_t>(at);
      std::copy(code.begin() + static_cast<std::ptrdiff_t>(at),
                code.begin() + static_cast<std::ptrdiff_t>(std::min(at + 32, code.size())),
                data.code);
      EXPECT_EQ(host.command(data, 150), wire::kOk);
    }
    EXPECT_EQ(host.command(wire::LoadEnd{hash}, 1000), wire::kOk);
    sent += host.sent();
    robot.boot();
    EXPECT_EQ(programsOf(robot).hash[0], hash);
    const dynamics::ProgramBytes stored =
        const_cast<ProgramStore&>(robot.device().programs()).find(hash);
    EXPECT_EQ(Code(stored.code, stored.code + stored.size), code);
  }
  EXPECT_GT(sent, 20 * 6) << "some were lost";
}

TEST(SetSenses, AreReadByProgramsAndEchoedInTelemetry) {
  RobotOnBench robot;
  robot.boot();
  const uint32_t hash =
      hashOf(programText({drivingPhase("run", "clamp(sense(2), -9, 9) * 1 cm/s", "", "100 ms")}));
  EXPECT_EQ(robot.configure(running({hash})).status, wire::kOk);
  robot.command(robot.order(wire::Order::kTable, 60000));
  EXPECT_EQ(robot.device().core().report().held.left, 0);
  wire::SetSenses senses;
  senses.id = 66;
  senses.sense[2] = 3 * dynamics::kOne / 2;
  const std::size_t acks = robot.all<wire::Ack>().size();
  robot.send(senses);
  robot.run(200);
  EXPECT_EQ(robot.device().core().report().held.left, 15000);
  EXPECT_EQ(robot.last<wire::Telemetry>().senses_id, 66);
  EXPECT_EQ(robot.all<wire::Ack>().size(), acks) << "a stream is not answered";
}

/// Loads any bytes with their own hash, without waiting for the EEPROM. @return whether it was
/// accepted
bool loadQuickly(RobotOnBench& robot, const Code& code) {
  const auto size = static_cast<uint8_t>(code.size());
  const uint32_t hash = dynamics::programHash(code.data(), size);
  robot.heard().clear();
  robot.send(wire::LoadBegin{hash, size});
  for (std::size_t at = 0; at < code.size(); at += 32) {
    wire::LoadData data;
    data.offset = static_cast<uint8_t>(at);
    std::copy(code.begin() + static_cast<std::ptrdiff_t>(at),
              code.begin() + static_cast<std::ptrdiff_t>(std::min(at + 32, code.size())),
              data.code);
    robot.send(data);
  }
  robot.send(wire::LoadEnd{hash});
  robot.run(200);
  return robot.device().programs().placeOf(hash) != ProgramStore::kNoPlace;
}

TEST(AnyByteCode, IsRefusedOrExecutedByTheFirmware) {
  const char* many = std::getenv("LAB_DEVICE_PROGRAMS");
  const int tries = many == nullptr ? 1500 : std::atoi(many);
  std::mt19937 random(3);
  const std::vector<Code> valid = {
      testPrograms().code(hashOf(rtpText("5 cm/s", "1 1/s", "0.5 s"))),
      testPrograms().code(hashOf(abpText("5 cm/s", "0.5 s", "3 rad/s"))),
      testPrograms().code(hashOf(wheelNoiseText("1 cm/s", "10 cm/s", "0.1 s")))};
  RobotOnBench robot;
  robot.boot();
  int accepted = 0;
  for (int i = 0; i < tries; ++i) {
    Code code = valid[random() % valid.size()];
    if (i % 8 == 0) {
      code.resize(3 + random() % 174);
      for (uint8_t& byte : code) byte = static_cast<uint8_t>(random());
    } else {
      for (unsigned change = 0; change <= random() % 3; ++change) {
        code[random() % code.size()] =
            static_cast<uint8_t>(random() % 3 == 0 ? random() : random() % 70);
      }
    }
    EXPECT_EQ(robot.configure(running({})).status, wire::kOk);
    if (!loadQuickly(robot, code)) {
      ASSERT_NE(dynamics::checkByteCode(code.data(), static_cast<uint16_t>(code.size())).fault,
                dynamics::kValidByteCode);
      continue;
    }
    ++accepted;
    testPrograms().add(code);
    robot.sensors().ir[random() % 6] = static_cast<uint16_t>(random() % 1024);
    ASSERT_EQ(robot
                  .configure(running(
                      {dynamics::programHash(code.data(), static_cast<uint8_t>(code.size()))}))
                  .status,
              wire::kOk);
    ASSERT_EQ(robot.command(robot.order(wire::Order::kTable, 60000)).status, wire::kOk);
    robot.run(300);
    ASSERT_GE(robot.device().core().report().phase, 0);
    ASSERT_LT(robot.device().core().report().phase, code[1]);
    ASSERT_LE(std::abs(robot.board().left), 255);
  }
  EXPECT_GT(accepted, tries / 20);
  EXPECT_LT(accepted, tries);
}

}  // namespace
}  // namespace lab::firmware::device_programs_test
