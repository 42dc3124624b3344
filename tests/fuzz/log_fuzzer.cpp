// Logs: the report of a run without its figures, and what a replay would send. An input that begins
// with LCM's sync word is a log, any other one is a sequence of messages as in messages_fuzzer.cpp.
// If its first byte is not 0, two numbers follow: the place [s] and the speed of the replay.
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <lab/experiment_command_t.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "analyzer/log_source.hpp"
#include "analyzer/report/html/report_page.hpp"
#include "analyzer/report/record/run_record.hpp"
#include "analyzer/report/sections/segments.hpp"
#include "analyzer/report/summary/diffusion_sentence.hpp"
#include "analyzer/report/summary/findings.hpp"
#include "analyzer/report/summary/summary.hpp"
#include "analyzer/report/summary/trajectories.hpp"
#include "analyzer/report_error.hpp"
#include "runner/commands/log_events.hpp"
#include "runner/commands/log_playback.hpp"
#include "tests/fuzz/input.hpp"
#include "tests/fuzz/memory_file.hpp"
#include "tests/fuzz/messages.hpp"

namespace lab::fuzz {
namespace {

using Log = std::vector<std::uint8_t>;

template <class Number>
void append(Log& log, Number value) {
  for (int shift = 8 * static_cast<int>(sizeof value) - 8; shift >= 0; shift -= 8) {
    log.push_back(static_cast<std::uint8_t>(value >> shift));
  }
}

/// Values of SEEK and SPEED.
struct Wanted {
  double seek = 2;
  double speed = 2;
};

Wanted wantedOf(Input& input) {
  Wanted wanted;
  if (input.number<std::uint8_t>() == 0) return wanted;
  wanted.seek = input.number<double>();
  wanted.speed = input.number<double>();
  return wanted;
}

/// The events as lcm-logger writes them.
Log logOf(Input& input) {
  constexpr std::uint32_t kSync = 0xEDA1DA01;
  Log log;
  std::int64_t utime = 946'684'800'000'000;
  for (std::int64_t number = 0; !input.empty(); ++number) {
    const TimedMessage message = nextMessage(input);
    append(log, kSync);
    append(log, number);
    append(log, utime);
    append(log, static_cast<std::uint32_t>(message.channel.size()));
    append(log, static_cast<std::uint32_t>(message.data.size()));
    log.insert(log.end(), message.channel.begin(), message.channel.end());
    log.insert(log.end(), message.data.begin(), message.data.end());
    utime += message.wait_us;
  }
  return log;
}

void report(const std::vector<std::filesystem::path>& files) {
  try {
    static_cast<void>(report::logFiles(files.front()));
    static_cast<void>(report::findStart(files));
    const report::RunRecord record = report::readRun(files, {analysis::Depth::kLive, true});
    static_cast<void>(report::summaryJson(record));
    std::ostringstream trajectories;
    report::writeTrajectories(record, trajectories);
    static_cast<void>(report::segmentsCsv(record));
    static_cast<void>(report::reportHtml(record, {}));
    static_cast<void>(report::headlines(record));
    static_cast<void>(report::diffusionSentence(record));
  } catch (const report::ReportError&) {
  }
}

void replay(const std::vector<std::filesystem::path>& files, const Wanted& wanted) {
  runner::LogEvents events(files);
  if (events.all().empty()) return;
  std::int64_t now = 0;
  runner::LogPlayback playback(events, "run", 1, runner::AtEnd::kPause, now);
  const auto send = [](std::string_view channel, Bytes message) {
    static_cast<void>(runner::asReplay(channel, message));
  };
  for (const std::int8_t action : {experiment_command_t::SEEK, experiment_command_t::SPEED}) {
    experiment_command_t command{};
    command.action = action;
    command.value = action == experiment_command_t::SEEK ? wanted.seek : wanted.speed;
    static_cast<void>(playback.execute(command, now));
    for (int i = 0; i < 20; ++i) {
      now += 500'000;
      static_cast<void>(playback.advance(now));
      playback.play(now, send);
      static_cast<void>(playback.status(now));
    }
  }
}

}  // namespace
}  // namespace lab::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::array<std::uint8_t, 4> kSync{0xED, 0xA1, 0xDA, 0x01};
  lab::fuzz::Input input(bytes, size);
  const bool is_log = size >= kSync.size() && std::equal(kSync.begin(), kSync.end(), bytes);
  const lab::fuzz::Wanted wanted = is_log ? lab::fuzz::Wanted{} : lab::fuzz::wantedOf(input);
  const lab::fuzz::Log log = is_log ? lab::fuzz::Log(bytes, bytes + size) : lab::fuzz::logOf(input);
  const lab::fuzz::MemoryFile file(log.data(), log.size());
  lab::fuzz::report({file.path()});
  lab::fuzz::replay({file.path()}, wanted);
  return 0;
}
