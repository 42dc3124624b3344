// Properties in which the simulator must equal the chip, whatever version of libsimavr is
// installed. Each test fails without the corresponding correction in chip.cpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim_svc/emulator/chip.hpp"

/// Replaces the library's function and counts how often the simulator would sleep in real time.
static int usleep_calls = 0;
extern "C" int usleep(useconds_t) {
  ++usleep_calls;
  return 0;
}

namespace lab::emulator {
namespace {

constexpr std::uint64_t kByteCycles = 2080;  // ten bits at 38462 baud
constexpr std::uint64_t kMsCycles = 8000;

class Probe {
 public:
  explicit Probe(ChipSettings settings = {}, bool on = true)
      : chip_(std::make_shared<const FirmwareImage>(LAB_PROBE_ELF), settings) {
    if (on) {
      chip_.switchOn();
      run(10);
    }
  }

  void run(std::uint64_t ms) {
    now_ += ms * kMsCycles;
    chip_.runTo(now_);
    for (const SentByte& byte : chip_.takeSent(now_)) sent_.push_back(byte);
  }
  void tell(std::string_view letters) {
    for (const char letter : letters) {
      chip_.receive(LineByte{static_cast<std::uint8_t>(letter), false});
    }
  }
  /// The bytes received since the last call.
  std::vector<SentByte> take() { return std::exchange(sent_, {}); }
  std::string text() {
    std::string text;
    for (const SentByte& byte : take()) text += static_cast<char>(byte.value);
    return text;
  }
  Chip& chip() { return chip_; }
  std::uint64_t now() const { return now_; }

 private:
  Chip chip_;
  std::uint64_t now_ = 0;
  std::vector<SentByte> sent_;
};

TEST(Simulator, ReportsWhyItStarted) {
  Probe probe;
  EXPECT_EQ(probe.text(), std::string("!\x01"));
  probe.chip().reset();
  probe.run(10);
  EXPECT_EQ(probe.text(), std::string("!\x02"));
}

TEST(Simulator, AByteTakesTenBits) {
  Probe probe;
  probe.take();
  probe.tell("t");
  probe.run(100);
  const auto sent = probe.take();
  ASSERT_EQ(sent.size(), 100U);
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(sent[i].value, i);
    if (i > 0) {
      EXPECT_NEAR(static_cast<double>(sent[i].cycle - sent[i - 1].cycle), kByteCycles, 40) << i;
    }
  }
  // simavr has no transmit buffer, so a program that polls loses a few cycles per byte.
  EXPECT_NEAR(static_cast<double>(sent.back().cycle - sent.front().cycle), 99.0 * kByteCycles,
              99 * 10);
}

TEST(Simulator, ReceivesBytesAtTheSpeedOfTheHost) {
  for (const double baud : {38400.0, 38461.5, 39200.0, 37700.0}) {
    ChipSettings settings;
    settings.line_baud = baud;
    Probe probe(settings);
    probe.take();
    probe.tell("c");
    for (int i = 0; i < 5000; ++i) probe.tell("x");
    probe.tell("E");
    probe.run(1500);
    const auto said = probe.take();
    ASSERT_EQ(said.size(), 3U) << baud;
    EXPECT_EQ(said[0].value + 256 * said[1].value, 5000) << baud;
    EXPECT_EQ(said[2].value, 0) << baud;
    EXPECT_NEAR(static_cast<double>(said[0].cycle), 10.0 * kMsCycles + 5003 * 10 * kChipHz / baud,
                500);
  }
}

TEST(Simulator, TheReceiverHoldsTwoBytes) {
  Probe probe;
  probe.take();
  probe.tell("dxxxxxxxxxx");
  probe.run(40);
  EXPECT_EQ(probe.text(), "d??");
  EXPECT_EQ(probe.chip().counts().bytes_overrun, 8U);
  probe.tell("x");
  probe.run(10);
  EXPECT_EQ(probe.text(), "?");
}

TEST(Simulator, AByteWithoutStopBitIsMarked) {
  Probe probe;
  probe.take();
  probe.tell("c");
  probe.chip().receive(LineByte{'x', true});
  probe.tell("E");
  probe.run(20);
  const auto said = probe.take();
  ASSERT_EQ(said.size(), 3U);
  EXPECT_NE(said[2].value, 0);
}

TEST(Simulator, TheLineSurvivesManyWatchdogResets) {
  Probe probe;
  probe.take();
  for (int i = 0; i < 150; ++i) {
    probe.tell("w");
    probe.run(40);
    ASSERT_EQ(probe.text(), std::string("!\x08")) << i;
    probe.tell("x");
    probe.run(5);
    ASSERT_EQ(probe.text(), "?") << i;
  }
  EXPECT_EQ(probe.chip().counts().resets, 150U);
}

TEST(Simulator, AWatchdogResetStopsTheMotorsButNotTheLine) {
  Probe probe;
  probe.tell("p");
  probe.run(20);
  ASSERT_EQ(probe.chip().duty(), (Duty{100, -200}));
  probe.take();
  probe.tell("w");
  for (int i = 0; i < 200; ++i) probe.tell("x");  // 52 ms; most of them after the reset
  probe.run(100);
  EXPECT_EQ(probe.chip().duty(), Duty{});
  const auto changes = probe.chip().takeChanges(kNever);
  ASSERT_EQ(changes.size(), 2U);
  EXPECT_EQ(changes[1].duty, Duty{});
  const std::string said = probe.text();
  EXPECT_THAT(said, testing::StartsWith(std::string("!\x08?")));
  EXPECT_GT(said.size(), 100U);
}

TEST(Simulator, DoesNotSleepInRealTime) {
  usleep_calls = 0;
  Probe probe;
  probe.tell("tttt");  // a program that polls its line
  probe.run(200);
  probe.tell("i");  // a program that sleeps
  probe.run(200);
  EXPECT_EQ(usleep_calls, 0);
}

TEST(Simulator, ADutyAndItsPinsAreReportedAsOneChange) {
  Probe probe;
  static_cast<void>(probe.chip().takeChanges(kNever));
  probe.tell("p");
  probe.run(20);
  const auto changes = probe.chip().takeChanges(kNever);
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].duty, (Duty{100, -200}));
  EXPECT_GT(changes[0].cycle, 10 * kMsCycles + kByteCycles);
  EXPECT_LT(changes[0].cycle, 10 * kMsCycles + 3 * kByteCycles);
}

TEST(Simulator, AnEepromWriteTakesItsTime) {
  Probe probe;
  probe.take();
  probe.tell("e");
  probe.run(20);
  const auto said = probe.take();
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].value, 'e');
  const double ms = static_cast<double>(said[0].cycle - 10 * kMsCycles) / kMsCycles;
  EXPECT_NEAR(ms, 2 * 3.4 + 2 * 0.26, 0.1);
  EXPECT_EQ(probe.chip().eeprom()[100], 0x55);
  EXPECT_EQ(probe.chip().eeprom()[101], 0x56);
  EXPECT_EQ(probe.chip().counts().eeprom_writes, 2U);
}

TEST(Simulator, APowerCutCorruptsTheByteBeingWritten) {
  Probe probe;
  probe.chip().cutPowerInWrite(2);
  probe.tell("e");
  probe.run(20);
  EXPECT_EQ(probe.chip().power(), ChipPower::kOff);
  EXPECT_EQ(probe.chip().eeprom()[100], 0x55);
  EXPECT_NE(probe.chip().eeprom()[101], 0x56);
  probe.take();
  probe.chip().switchOn();
  probe.run(20);
  EXPECT_EQ(probe.text(), std::string("!\x01"));
}

TEST(Simulator, AStackPointerOfWhichOnlyOneByteIsWrittenIsNotMeasured) {
  ChipSettings settings;
  settings.profile = true;
  Probe probe(settings);
  probe.take();
  probe.tell("m");
  probe.run(10);
  EXPECT_EQ(probe.text(), "m");
  EXPECT_EQ(probe.chip().counts().lowest_stack, 0x07FB);
}

TEST(Simulator, SleepingWithInterruptsOffIsACrash) {
  Probe probe;
  EXPECT_EQ(probe.chip().power(), ChipPower::kRunning);
  probe.tell("s");
  probe.run(20);
  EXPECT_EQ(probe.chip().power(), ChipPower::kCrashed);
  probe.run(20);
  EXPECT_EQ(probe.chip().power(), ChipPower::kCrashed);
  probe.chip().switchOff();
  probe.chip().switchOn();
  probe.run(20);
  EXPECT_EQ(probe.chip().power(), ChipPower::kRunning);
}

// While D2 is low, simavr polls it in every cycle, which is twenty times slower and divides a sleep
// into steps of two cycles.
TEST(Simulator, SleepsInOneStepWhateverThePinsAre) {
  Probe probe;
  probe.tell("i");
  probe.run(10);
  const std::uint64_t before = probe.chip().counts().rounds;
  probe.run(1000);
  EXPECT_LT(probe.chip().counts().rounds - before, 20'000U);
}

// In simavr a sleep ends one cycle late. Without the correction, a stop just before a timer would
// remove this delay.
TEST(Simulator, AStopAtAnyCycleBeforeATimerChangesNothing) {
  constexpr std::size_t kTicks = 2500;
  Probe reference;
  reference.take();
  reference.tell("b");
  reference.run(kTicks + 10);
  const auto expected = reference.take();
  ASSERT_GE(expected.size(), kTicks);

  Probe stopped;
  stopped.take();
  stopped.tell("b");
  for (std::size_t i = 1; i < kTicks; ++i) {
    stopped.chip().runTo(expected[i].cycle - i);  // another distance from each tick
  }
  stopped.run(kTicks + 10);
  const auto said = stopped.take();
  ASSERT_EQ(said.size(), expected.size());
  for (std::size_t i = 0; i < said.size(); ++i) ASSERT_EQ(said[i].cycle, expected[i].cycle) << i;
}

TEST(Simulator, TimeContinuesWhileItIsOff) {
  Probe probe({}, false);
  probe.run(100);
  EXPECT_EQ(probe.chip().cycle(), 100 * kMsCycles);
  EXPECT_EQ(probe.chip().power(), ChipPower::kOff);
  probe.tell("x");  // not received
  probe.run(10);
  probe.chip().switchOn();
  probe.run(10);
  const auto said = probe.take();
  ASSERT_EQ(said.size(), 2U);
  EXPECT_GT(said[0].cycle, 110 * kMsCycles);
}

TEST(Simulator, RefusesFilesThatAreNoProgramWithOneLine) {
  const auto errorOf = [](const std::filesystem::path& path) {
    try {
      FirmwareImage program(path);
    } catch (const FirmwareImageError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(errorOf("/nowhere/x.elf"), testing::HasSubstr("/nowhere/x.elf: cannot be read"));
  EXPECT_THAT(errorOf("/proc/self/exe"), testing::HasSubstr("expected one for the AVR"));
  EXPECT_THAT(errorOf("/etc/hostname"), testing::HasSubstr("not an ELF file"));
}

}  // namespace
}  // namespace lab::emulator
