#include "runner/commands/log_playback.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <lab/experiment_event_t.hpp>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/codec.hpp"
#include "common/bus/log_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::runner {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kLog = 7'000'000'000;  // begin of the log
constexpr std::int64_t kWall = 50;

std::int64_t us(double seconds) { return static_cast<std::int64_t>(std::llround(seconds * 1e6)); }

struct Recorded {
  std::string channel;
  std::vector<std::uint8_t> message;
  std::int64_t utime = 0;
};

Recorded frame(double at) {
  return {"F" + std::to_string(static_cast<int>(std::lround(at * 10))), {}, kLog + us(at)};
}

Recorded eventAt(double at, std::int8_t kind, const std::string& text, double repeated_after = 0) {
  experiment_event_t event{};
  event.utime = kLog + us(at);
  event.kind = kind;
  event.text = text;
  return {std::string(channels::kExperimentEvent), encode(event), kLog + us(at + repeated_after)};
}

/// A log of 60 s with a frame every 0.5 s; START at 0 and 30 s, a mark at 20 s that was sent three
/// times, and one at 55 s.
std::vector<Recorded> recordedEvents() {
  std::vector<Recorded> events;
  for (int i = 0; i <= 120; ++i) events.push_back(frame(i * 0.5));
  events.push_back(eventAt(0, experiment_event_t::START, "file"));
  events.push_back(eventAt(30, experiment_event_t::START, "file"));
  for (const double again : {0.0, 0.001, 0.002}) {
    events.push_back(eventAt(20, experiment_event_t::MARK, "fell over", again));
  }
  events.push_back(eventAt(55, experiment_event_t::MARK, "late"));
  std::ranges::stable_sort(events, {}, &Recorded::utime);
  return events;
}

/// A log with these events.
class RecordedLog {
 public:
  explicit RecordedLog(const std::vector<Recorded>& events) {
    LogWriter writer(file_);
    for (const Recorded& event : events) writer.write({event.channel, event.message, event.utime});
  }

  [[nodiscard]] LogEvents events() const { return LogEvents({file_}); }

 private:
  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "log.lcmlog";
};

class LogPlaybackTest : public testing::Test {
 protected:
  explicit LogPlaybackTest(AtEnd at_end = AtEnd::kPause)
      : playback_(events_, "run-1", 1, at_end, kWall) {}

  /// Plays until `s` on the wall clock [s]. @return the texts or channels of what was sent
  std::vector<std::string> playTo(double s) {
    now_ = kWall + us(s);
    std::vector<std::string> sent;
    playback_.advance(now_);
    playback_.play(now_, [&sent](std::string_view channel, Bytes message) {
      experiment_event_t happened{};
      const bool is_event = channel == channels::kExperimentEvent;
      EXPECT_TRUE(!is_event || decode(message, happened));
      sent.push_back(is_event ? happened.text : std::string(channel));
    });
    return sent;
  }

  std::string request(std::int8_t action, double value = 0) {
    experiment_command_t command{};
    command.action = action;
    command.value = value;
    return playback_.execute(command, now_);
  }

  RecordedLog log_{recordedEvents()};
  LogEvents events_ = log_.events();
  std::int64_t now_ = kWall;
  LogPlayback playback_;
};

TEST_F(LogPlaybackTest, PlaysInOrderOfTime) {
  EXPECT_THAT(playTo(0), ElementsAre("F0", "file"));
  EXPECT_THAT(playTo(1.2), ElementsAre("F5", "F10"));
  EXPECT_THAT(playTo(1.3), IsEmpty());
  const experiment_status_t status = playback_.status(now_);
  EXPECT_EQ(status.phase, experiment_status_t::PLAYING);
  EXPECT_EQ(status.run, "run-1");
  EXPECT_DOUBLE_EQ(status.elapsed, 1.3);
  EXPECT_DOUBLE_EQ(status.left, 58.7);
  EXPECT_EQ(status.rate, 1);
  EXPECT_EQ(status.jumps, 0);
  EXPECT_EQ(status.step, -1);
}

TEST_F(LogPlaybackTest, AJumpForwardSendsSkippedEventsOnceAndTheTwoSecondsBefore) {
  playTo(1);
  EXPECT_EQ(request(experiment_command_t::SEEK, 40), "");
  EXPECT_EQ(playback_.status(now_).jumps, 1) << "before any message of the new place";
  EXPECT_THAT(playTo(1), ElementsAre("file", "fell over", "F380", "F385", "F390", "F395", "F400"));
  EXPECT_THAT(playTo(1.5), ElementsAre("F405"));
  EXPECT_EQ(playback_.status(now_).jumps, 1);
}

TEST_F(LogPlaybackTest, AJumpBackSendsTheEventsBeforeItOnly) {
  playTo(60);
  EXPECT_EQ(request(experiment_command_t::SEEK, 3), "");
  EXPECT_THAT(playTo(60), ElementsAre("file", "F10", "F15", "F20", "F25", "F30"));
  EXPECT_EQ(request(experiment_command_t::SEEK, 0.75), "");
  EXPECT_THAT(playTo(60), ElementsAre("F0", "file", "F5"));
  EXPECT_EQ(playback_.status(now_).jumps, 2);
}

TEST_F(LogPlaybackTest, EventsWithinTheTwoSecondsAreSentAsRecorded) {
  EXPECT_EQ(request(experiment_command_t::SEEK, 20.4), "");
  EXPECT_THAT(playTo(0), ElementsAre("file", "F185", "F190", "F195", "F200", "fell over",
                                     "fell over", "fell over"));
}

TEST_F(LogPlaybackTest, JumpsWhilePausedAndStaysPaused) {
  playTo(5);
  EXPECT_EQ(request(experiment_command_t::PAUSE), "");
  EXPECT_THAT(request(experiment_command_t::PAUSE), HasSubstr("already"));
  EXPECT_EQ(request(experiment_command_t::SEEK, 10), "");
  EXPECT_EQ(playTo(6).back(), "F100");
  EXPECT_THAT(playTo(30), IsEmpty());
  EXPECT_EQ(playback_.status(now_).phase, experiment_status_t::PLAY_PAUSED);
  EXPECT_DOUBLE_EQ(playback_.status(now_).elapsed, 10);
  EXPECT_EQ(request(experiment_command_t::RESUME), "");
  EXPECT_THAT(request(experiment_command_t::RESUME), HasSubstr("not paused"));
  EXPECT_THAT(playTo(30.6), ElementsAre("F105"));
}

TEST_F(LogPlaybackTest, ChangesItsSpeedWithoutAJump) {
  playTo(10);
  EXPECT_EQ(request(experiment_command_t::SPEED, 4), "");
  EXPECT_THAT(playTo(10), IsEmpty());
  EXPECT_THAT(playTo(10.25), ElementsAre("F105", "F110"));
  EXPECT_EQ(playback_.status(now_).rate, 4);
  EXPECT_EQ(playback_.status(now_).jumps, 0);
  request(experiment_command_t::PAUSE);
  EXPECT_EQ(request(experiment_command_t::SPEED, 2), "");
  EXPECT_TRUE(playback_.paused());
  EXPECT_EQ(playback_.rate(), 0);
}

TEST_F(LogPlaybackTest, RefusesInvalidPlacesAndSpeeds) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double to : {-0.1, 60.1, nan, 1e300}) {
    EXPECT_THAT(request(experiment_command_t::SEEK, to), HasSubstr("allowed 0 to 60.000"));
  }
  for (const double speed : {0.0, -1.0, 1e5, nan}) {
    EXPECT_THAT(request(experiment_command_t::SPEED, speed), HasSubstr("allowed 0.001 to 10000"));
  }
  EXPECT_EQ(playback_.status(now_).jumps, 0);
  EXPECT_EQ(request(experiment_command_t::SEEK, 60), "") << "the end of the log";
}

TEST_F(LogPlaybackTest, RefusesWhatOnlyARunningLabCanDo) {
  EXPECT_THAT(request(experiment_command_t::MARK), HasSubstr("this is a replay"));
  EXPECT_THAT(request(99), HasSubstr("this is a replay"));
}

TEST_F(LogPlaybackTest, PausesAtItsEndAndRestartsOnResume) {
  playTo(59);
  playTo(61);
  EXPECT_FALSE(playback_.paused());
  EXPECT_TRUE(playback_.advance(kWall + us(61.1)));
  EXPECT_TRUE(playback_.paused());
  EXPECT_FALSE(playback_.over());
  EXPECT_FALSE(playback_.advance(kWall + us(61.2))) << "reported once";
  now_ = kWall + us(70);
  EXPECT_DOUBLE_EQ(playback_.status(now_).elapsed, 60);
  EXPECT_EQ(request(experiment_command_t::RESUME), "");
  EXPECT_EQ(playback_.status(now_).jumps, 1);
  EXPECT_THAT(playTo(70), ElementsAre("F0", "file"));
}

TEST_F(LogPlaybackTest, EndsOnRequest) {
  EXPECT_EQ(request(experiment_command_t::END), "");
  EXPECT_TRUE(playback_.over());
}

TEST_F(LogPlaybackTest, EndsWithItsLogWithoutADashboard) {
  LogPlayback dut(events_, "run-1", 10, AtEnd::kEnd, kWall);
  const auto nobody = [](std::string_view, Bytes) {};
  dut.play(kWall + us(6.1), nobody);
  EXPECT_EQ(dut.sent(), events_.all().size());
  EXPECT_FALSE(dut.over());
  EXPECT_TRUE(dut.advance(kWall + us(6.2)));
  EXPECT_TRUE(dut.over());
}

TEST_F(LogPlaybackTest, RestartsWithAJumpInALoop) {
  LogPlayback dut(events_, "run-1", 10, AtEnd::kLoop, kWall);
  std::size_t sent = 0;
  const auto count = [&sent](std::string_view, Bytes) { ++sent; };
  dut.play(kWall + us(6.1), count);
  EXPECT_EQ(sent, events_.all().size());
  EXPECT_TRUE(dut.advance(kWall + us(6.2)));
  EXPECT_EQ(dut.status(kWall + us(6.2)).jumps, 1);
  dut.play(kWall + us(6.2), count);
  EXPECT_EQ(sent, events_.all().size() + 2);
}

TEST(LogPlaybackOfALongLog, PlaysAllEventsInPortions) {
  std::vector<Recorded> recorded;
  for (int i = 0; i < 4500; ++i) recorded.push_back({std::to_string(i), {}, kLog + i});
  const RecordedLog log(recorded);
  LogEvents events = log.events();
  LogPlayback dut(events, "run-1", 1, AtEnd::kPause, kWall);
  std::vector<std::string> sent;
  const std::int64_t late = kWall + us(1);
  const auto play = [&] {
    const std::size_t before = sent.size();
    EXPECT_FALSE(dut.advance(late));
    dut.play(late, [&sent](std::string_view channel, Bytes) { sent.emplace_back(channel); });
    return sent.size() - before;
  };
  EXPECT_EQ(play(), 2000U);
  EXPECT_EQ(play(), 2000U);
  EXPECT_EQ(play(), 500U);
  experiment_command_t seek{};
  seek.action = experiment_command_t::SEEK;
  seek.value = dut.length();
  ASSERT_EQ(dut.execute(seek, late), "");
  sent.clear();
  EXPECT_EQ(play(), 2000U);
  EXPECT_EQ(play(), 2000U) << "events before the target of a jump too";
  EXPECT_EQ(play(), 500U);
  for (std::size_t i = 0; i < sent.size(); ++i) ASSERT_EQ(sent[i], std::to_string(i));
  EXPECT_TRUE(dut.advance(late)) << "the end of the log";
}

}  // namespace
}  // namespace lab::runner
