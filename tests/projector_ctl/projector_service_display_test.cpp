// The projector with a faulty display, in virtual time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <lab/light_command_t.hpp>
#include <lab/light_status_t.hpp>
#include <lab/service_status_t.hpp>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/memory_bus.hpp"
#include "common/experiment/light_messages.hpp"
#include "common/loop/virtual_loop.hpp"
#include "projector_ctl/projector_service.hpp"
#include "tests/projector_ctl/scripted_display.hpp"

namespace lab::projector::display_service_test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr int kSafe = 51;     // 0.2 of white
constexpr int kBright = 204;  // 0.8

class DisplayServiceTest : public testing::Test {
 protected:
  DisplayServiceTest() {
    experiment.light.safe_intensity = 0.2;
    loop.drainWith([this] { bus.deliver(); });
    bus.subscribe(channels::kLightStatus, [this](const Packet& packet) {
      light_status_t status{};
      ASSERT_TRUE(decode(packet.data, status));
      statuses.push_back(status);
    });
    bus.subscribe(channels::kServiceStatus, [this](const Packet& packet) {
      service_status_t heartbeat{};
      ASSERT_TRUE(decode(packet.data, heartbeat));
      if (heartbeat.sender == "projector_ctl") said = heartbeat.last_error;
    });
  }

  Screen::Setup setup() {
    Screen::Setup setup;
    setup.open = [this] { return std::make_unique<ScriptedDisplay>(script); };
    setup.place = [this](int columns, int rows) {
      if (columns != calibrated) throw std::runtime_error("calibration of another size");
      return Screen::Placement{{1.2, 0.9, columns, rows}, "c0ffee"};
    };
    setup.safe_field = {{light::Layer{.intensity = 0.2}}, {}, 1};
    setup.now = [this] { return loop.now(); };
    return setup;
  }

  void start() { start(setup()); }

  void start(Screen::Setup display) {
    dut = std::make_unique<ProjectorService>(
        ServiceContext{node, loop, experiment, testing::TempDir()}, std::filesystem::path{},
        std::make_unique<InlinePresenter>(std::move(display)));
    node.start();
  }

  void command(double intensity) {
    light_command_t command{};
    command.seq = ++seq;
    command.hold_until_utime = loop.now() + 3600'000'000;
    command.label = "step";
    command.layers.push_back(toMessage(light::Layer{.intensity = intensity}));
    command.num_layers = 1;
    sender.publishCommand(channels::kLightCommand, command);
  }

  void run(double seconds) {
    loop.runUntil(loop.now() + static_cast<std::int64_t>(seconds * 1e6 + 0.5));
  }

  [[nodiscard]] int shown() { return script.screen.row(90)[120]; }

  VirtualLoop loop;
  MemoryBus bus{[this] { return loop.now(); }};
  Node node{bus, loop, {"projector_ctl", 2, 1}};
  Node sender{bus, loop, {"lab", 0, 5}};
  Experiment experiment;
  DisplayScript script;
  int calibrated = 240;
  std::int64_t seq = 0;
  std::vector<light_status_t> statuses;
  std::string said;
  std::unique_ptr<ProjectorService> dut;
};

TEST_F(DisplayServiceTest, ShowsTheSafeFieldThenTheCommandThenTheSafeField) {
  start();
  EXPECT_EQ(shown(), kSafe);
  run(0.5);
  EXPECT_EQ(shown(), kSafe);
  command(0.8);
  run(0.5);
  EXPECT_EQ(shown(), kBright);
  const light_status_t& status = statuses.back();
  EXPECT_EQ(status.display, "bench");
  EXPECT_EQ(status.vsync, "none");
  EXPECT_EQ(status.calibration_id, "c0ffee");
  EXPECT_EQ(status.trouble, "");
  EXPECT_EQ(status.command_seq, 1);
  dut.reset();
  EXPECT_EQ(shown(), kSafe);
  EXPECT_EQ(script.closed, script.opened);
}

TEST_F(DisplayServiceTest, UsesTheSwapTimesOfADisplayThatWaits) {
  experiment.projector.latency = 0.04;
  script.waits = true;
  script.info.refresh_rate = 50;
  std::vector<std::int64_t> swaps;
  // Virtual time does not advance during a callback, so the time of the swap is set here.
  std::int64_t extra = 0;
  Screen::Setup display = setup();
  display.now = [&] { return loop.now() + extra; };
  script.swap = [&] {
    if (swaps.size() < 11) extra += 20'000;  // during the measurement of the pace
    swaps.push_back(loop.now());
  };
  Screen screen(std::move(display));
  screen.open();
  EXPECT_EQ(screen.state().pace, Pace::kDisplay);
  EXPECT_NEAR(screen.state().period, 0.02, 1e-9);
}

TEST_F(DisplayServiceTest, AddsTheLatencyToTheSwap) {
  experiment.projector.latency = 0.04;
  std::vector<std::int64_t> swaps;
  script.swap = [&] { swaps.push_back(loop.now()); };
  start();
  run(0.3);
  statuses.clear();
  command(0.8);
  run(0.2);
  ASSERT_FALSE(statuses.empty());
  for (const light_status_t& status : statuses) {
    EXPECT_TRUE(std::count(swaps.begin(), swaps.end(), status.utime - 40'000)) << status.utime;
    EXPECT_LE(status.first_shown_utime, status.utime);
  }
  dut.reset();  // its last picture needs `swaps`
}

TEST_F(DisplayServiceTest, ContinuesWithoutADisplayThatIsGoneAndOpensItAgain) {
  start();
  command(0.8);
  run(0.5);
  script.events = {DisplayEvent::kGone};
  script.there = false;
  run(0.05);
  const std::int64_t frame = statuses.back().frame;
  EXPECT_THAT(statuses.back().trouble, HasSubstr("gone"));
  EXPECT_EQ(statuses.back().display, "bench (gone)");
  EXPECT_EQ(statuses.back().vsync, "clock");
  run(2);
  EXPECT_THAT(said, HasSubstr("gone"));
  EXPECT_NEAR(static_cast<double>(statuses.back().frame - frame), 120, 2);  // by the clock
  command(0.4);
  run(1);
  EXPECT_EQ(statuses.back().command_seq, 2);
  EXPECT_EQ(script.opened, 1);
  script.there = true;
  run(1.1);
  EXPECT_EQ(script.opened, 2);
  EXPECT_EQ(shown(), 102);  // the present command
  EXPECT_EQ(statuses.back().trouble, "");
  EXPECT_EQ(statuses.back().display, "bench");
}

TEST_F(DisplayServiceTest, LosingAFastDisplayDoesNotDelayFrames) {
  script.waits = true;
  script.info.refresh_rate = 144;
  // Virtual time does not advance during a callback, so opening the display advances it itself.
  std::int64_t taken = 0;
  script.swap = [&] { taken += 6'944; };
  Screen::Setup display = setup();
  display.now = [&] { return loop.now() + (dut ? 0 : taken); };
  start(std::move(display));
  const int presented = script.presented;
  run(60);
  EXPECT_EQ(statuses.back().vsync, "display");
  EXPECT_NEAR(script.presented - presented, 144 * 60, 3);
  script.events = {DisplayEvent::kGone};
  script.there = false;
  run(0.05);
  EXPECT_EQ(statuses.back().vsync, "clock");
  std::int64_t last = statuses.back().utime;
  const std::int64_t frame = statuses.back().frame;
  for (int i = 0; i < 20; ++i) {
    run(0.1);
    EXPECT_LE(statuses.back().utime - last, 117'000) << i;  // 0.1 s and a frame
    EXPECT_GT(statuses.back().utime, last) << i;
    last = statuses.back().utime;
  }
  EXPECT_NEAR(static_cast<double>(statuses.back().frame - frame), 120, 6);
  dut.reset();  // its last picture needs `taken`
}

TEST_F(DisplayServiceTest, ADisplayThatFailsDuringReopeningStaysGone) {
  start();
  run(0.2);
  script.events = {DisplayEvent::kGone};
  run(0.05);
  script.breaks = true;
  run(1);
  EXPECT_EQ(script.opened, 2);
  EXPECT_EQ(script.closed, 2);
  EXPECT_THAT(statuses.back().trouble, HasSubstr("gone"));
  EXPECT_EQ(statuses.back().display, "bench (gone)");
  run(1);
  EXPECT_EQ(script.opened, 3);
  EXPECT_EQ(statuses.back().trouble, "");
  EXPECT_EQ(statuses.back().display, "bench");
}

TEST_F(DisplayServiceTest, ADisplayThatFailsWhilePresentingIsGone) {
  start();
  run(0.2);
  script.breaks = true;
  run(0.05);
  EXPECT_THAT(statuses.back().trouble, HasSubstr("lost"));
  run(1.2);
  EXPECT_EQ(statuses.back().trouble, "");
  EXPECT_EQ(script.opened, 2);
}

TEST_F(DisplayServiceTest, StaysClosedAfterEscapeTwice) {
  start();
  run(0.2);
  script.events = {DisplayEvent::kEscape};
  run(1.5);
  script.events = {DisplayEvent::kEscape};  // too late for a second one
  run(0.2);
  EXPECT_EQ(script.closed, 0);
  script.events = {DisplayEvent::kEscape, DisplayEvent::kEscape};
  run(0.1);
  EXPECT_EQ(script.closed, 1);
  EXPECT_THAT(statuses.back().trouble, HasSubstr("by hand"));
  run(3);
  EXPECT_EQ(script.opened, 1);
  EXPECT_THAT(said, HasSubstr("by hand"));
}

TEST_F(DisplayServiceTest, StaysClosedAfterTheUserClosesTheWindow) {
  start();
  run(0.2);
  script.events = {DisplayEvent::kClosed};
  run(3);
  EXPECT_EQ(script.opened, 1);
  EXPECT_THAT(statuses.back().trouble, HasSubstr("window was closed"));
}

TEST_F(DisplayServiceTest, ShowsTheSafeFieldIfTheCalibrationDoesNotFit) {
  start();
  command(0.8);
  run(0.5);
  EXPECT_EQ(shown(), kBright);
  script.info.width = 320;
  script.events = {DisplayEvent::kResized};
  run(0.5);
  EXPECT_EQ(script.opened, 3);  // including once to find that it does not fit
  EXPECT_EQ(script.screen.width, 320);
  EXPECT_EQ(shown(), kSafe);
  EXPECT_THAT(statuses.back().trouble, HasSubstr("calibration of another size"));
  script.info.width = 240;
  script.events = {DisplayEvent::kResized};
  run(0.5);
  EXPECT_EQ(shown(), kBright);
  EXPECT_EQ(statuses.back().trouble, "");
}

TEST_F(DisplayServiceTest, DrawsTheOverlayOnlyIfItIsOn) {
  script.info.width = calibrated = 960;
  script.info.height = 180;
  start();
  command(0);
  run(0.2);
  const auto bright = [&] {
    return std::count(script.screen.pixels.begin(), script.screen.pixels.end(), 255);
  };
  EXPECT_EQ(bright(), 0);
  script.events = {DisplayEvent::kOverlay};
  run(0.2);
  EXPECT_GT(bright(), 500);
  script.events = {DisplayEvent::kOverlay};
  run(0.2);
  EXPECT_EQ(bright(), 0);
  EXPECT_EQ(std::count(script.screen.pixels.begin(), script.screen.pixels.end(), 0), 960 * 180);
}

/// Ends a process while the swap of its display never returns.
[[noreturn]] void endWhileASwapHangs(bool comes_back) {
  auto script = std::make_unique<DisplayScript>();
  auto hangs = std::make_shared<std::promise<void>>();
  auto returns = std::make_shared<std::promise<void>>();
  script->swap = [&script = *script, hangs, returns] {
    if (script.presented < 2) return;  // the first picture is part of opening
    hangs->set_value();
    returns->get_future().wait();
  };
  Screen::Setup setup;
  setup.open = [&script = *script] { return std::make_unique<ScriptedDisplay>(script); };
  setup.place = [](int columns, int rows) {
    return Screen::Placement{{1.2, 0.9, columns, rows}, "c0ffee"};
  };
  auto clock = std::make_unique<VirtualLoop>();
  setup.now = [&clock] { return clock->now(); };
  {
    ThreadPresenter presenter(std::move(setup));
    presenter.submit({});
    hangs->get_future().wait();
  }
  clock.reset();  // the abandoned thread must not use it
  if (comes_back) {
    returns->set_value();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  std::exit(7);
}

TEST(ThreadPresenterTest, EndsWithASwapThatNeverReturns) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(endWhileASwapHangs(false), testing::ExitedWithCode(7),
              "display bench: its last swap does not return");
  EXPECT_EXIT(endWhileASwapHangs(true), testing::ExitedWithCode(7), "does not return");
}

}  // namespace
}  // namespace lab::projector::display_service_test
