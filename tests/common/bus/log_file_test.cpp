// Log files: exact times, recovery from damage, no overwriting, reported losses.
#include "common/bus/log_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "common/bus/channels.hpp"
#include "common/files/file_text.hpp"
#include "tests/support/file_size_limit.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::log_file_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

constexpr std::int64_t kEvents = 1000;
constexpr std::size_t kHeader = 28;  // sync 4, number 8, time 8, lengths 4 and 4
constexpr std::size_t kChannelLength = 7;
constexpr std::size_t kDataLength = 100;
constexpr std::size_t kEventSize = kHeader + kChannelLength + kDataLength;

struct LoggedEvent {
  std::string channel;
  std::vector<std::uint8_t> data;
  std::int64_t utime = 0;
  bool operator==(const LoggedEvent&) const = default;
};

LoggedEvent eventNumber(std::int64_t i) {
  return {"CHANNEL", std::vector<std::uint8_t>(kDataLength, static_cast<std::uint8_t>(i)),
          1'700'000'000'123'456 + 7 * i};
}

void write(LogWriter& log, const LoggedEvent& event) {
  log.write({event.channel, event.data, event.utime});
}

class LogFile : public testing::Test {
 protected:
  fs::path written(const std::string& name, std::int64_t first = 0, std::int64_t count = kEvents) {
    LogWriter log(folder_ / name);
    for (std::int64_t i = first; i < first + count; ++i) write(log, eventNumber(i));
    return folder_ / name;
  }

  LogReadResult read(const std::vector<fs::path>& files) {
    heard_.clear();
    return readLog(files, [this](const Packet& packet) {
      heard_.push_back({std::string(packet.channel),
                        {packet.data.begin(), packet.data.end()},
                        packet.received_utime});
    });
  }

  /// Applies `damage` to the bytes of a log of a thousand events and reads it. Checks that all
  /// events read are events that were written.
  template <class Damage>
  LogReadResult readDamaged(Damage damage) {
    fs::remove(folder_ / "whole.log");
    std::string bytes = readWholeFile(written("whole.log")).value_or("");
    damage(bytes);
    std::ofstream(folder_ / "damaged.log", std::ios::binary) << bytes;
    const LogReadResult result = read({folder_ / "damaged.log"});
    for (const LoggedEvent& event : heard_) {
      EXPECT_EQ(event, eventNumber((event.utime - eventNumber(0).utime) / 7));
    }
    return result;
  }

  TemporaryFolder folder_;
  std::vector<LoggedEvent> heard_;
};

TEST_F(LogFile, ReadsWhatWasWrittenWithExactTimes) {
  const LogReadResult result = read({written("log.lcmlog")});
  EXPECT_EQ(result.events, kEvents);
  EXPECT_EQ(result.resyncs, 0);
  ASSERT_EQ(heard_.size(), static_cast<std::size_t>(kEvents));
  for (std::int64_t i = 0; i < kEvents; ++i) {
    ASSERT_EQ(heard_[static_cast<std::size_t>(i)], eventNumber(i));
  }
}

TEST_F(LogFile, HasLcmsFormat) {
  {
    LogWriter log(folder_ / "log.lcmlog");
    for (int i = 0; i < 2; ++i) {
      log.write({"AB", std::vector<std::uint8_t>{0x11, 0x22, 0x33}, 0x0102030405060708});
    }
  }
  const auto event = [](char number) {
    return std::string("\xED\xA1\xDA\x01", 4) + std::string(7, '\0') + number +
           std::string("\x01\x02\x03\x04\x05\x06\x07\x08", 8) + std::string("\0\0\0\x02", 4) +
           std::string("\0\0\0\x03", 4) + "AB\x11\x22\x33";
  };
  EXPECT_EQ(readWholeFile(folder_ / "log.lcmlog").value_or(""), event('\0') + event('\1'));
}

TEST_F(LogFile, OverwritesNothing) {
  const fs::path path = written("log.lcmlog");
  EXPECT_THROW(LogWriter{path}, std::runtime_error);
  EXPECT_EQ(fs::file_size(path), kEvents * kEventSize);
}

TEST_F(LogFile, NamesFilesThatItCannotWriteOrRead) {
  EXPECT_THROW(LogWriter{folder_ / "nowhere/log.lcmlog"}, std::runtime_error);
  EXPECT_THROW(read({folder_ / "absent.lcmlog"}), std::runtime_error);
  fs::create_directory(folder_ / "folder");
  EXPECT_THROW(read({folder_ / "folder"}), std::runtime_error);  // a read error, not the end
}

TEST_F(LogFile, ReportsAFullDisk) {
  LogWriter log(folder_ / "log.lcmlog");
  const FileSizeLimit full(10 * kEventSize);
  for (std::int64_t i = 0; i < 100; ++i) write(log, eventNumber(i));
  EXPECT_THROW(log.flush(), std::runtime_error);
  EXPECT_THROW(
      {
        for (std::int64_t i = 0; i < 100'000; ++i) write(log, eventNumber(i));
      },
      std::runtime_error);
}

TEST_F(LogFile, LosesOnlyACutEvent) {  // LCM's own reader stops there
  const LogReadResult result =
      readDamaged([](std::string& bytes) { bytes.erase(500 * kEventSize + 60, 50); });
  EXPECT_EQ(result.events, kEvents - 1);
  EXPECT_EQ(result.resyncs, 1);
}

TEST_F(LogFile, LosesOnlyAnEventOfWhichAPieceIsLeft) {
  const LogReadResult result =
      readDamaged([](std::string& bytes) { bytes.erase(500 * kEventSize + 10, kEventSize - 10); });
  EXPECT_EQ(result.events, kEvents - 1);
  EXPECT_EQ(result.resyncs, 1);
}

TEST_F(LogFile, LosesBothEventsOfACutAcrossTwo) {
  const LogReadResult result =
      readDamaged([](std::string& bytes) { bytes.erase(500 * kEventSize - 20, 50); });
  EXPECT_EQ(result.events, kEvents - 2);
  EXPECT_EQ(result.resyncs, 1);
}

TEST_F(LogFile, RecoversFromADamagedLength) {  // LCM's own reader would skip the rest of the log
  for (const std::size_t byte : {0U, 1U, 2U}) {
    const LogReadResult result =
        readDamaged([byte](std::string& bytes) { bytes[500 * kEventSize + 24 + byte] = '\x10'; });
    EXPECT_EQ(result.events, kEvents - 1) << byte;
    EXPECT_EQ(result.resyncs, 1) << byte;
  }
}

TEST_F(LogFile, CountsOneDamagedPlaceForOneGap) {
  const LogReadResult result = readDamaged([](std::string& bytes) {
    std::fill_n(bytes.begin() + 300 * kEventSize, 10 * kEventSize, '\0');
    std::fill_n(bytes.begin() + 700 * kEventSize + 3, 20, '\xED');
  });
  // 10 zeroed events and 1 overwritten event are lost; each gap may also cost the event before it.
  EXPECT_LE(kEvents - result.events, 10 + 1 + 2);
  EXPECT_GE(kEvents - result.events, 10 + 1);
  EXPECT_EQ(result.resyncs, 2);
}

TEST_F(LogFile, LosesTheLastEventOfATruncatedLogAndReportsIt) {
  for (const std::size_t missing : {std::size_t{1}, kDataLength, kEventSize - 1}) {
    const LogReadResult result =
        readDamaged([missing](std::string& bytes) { bytes.resize(bytes.size() - missing); });
    EXPECT_EQ(result.events, kEvents - 1) << missing;
    EXPECT_EQ(result.resyncs, 1) << missing;
  }
}

TEST_F(LogFile, ReadsFilesThatAreNoLogs) {
  std::ofstream(folder_ / "empty.log");
  EXPECT_EQ(read({folder_ / "empty.log"}).resyncs, 0);
  std::ofstream(folder_ / "letter.txt") << "Dear lab, this is not a log.";
  const LogReadResult result = read({folder_ / "letter.txt"});
  EXPECT_EQ(result.events, 0);
  EXPECT_EQ(result.resyncs, 1);
}

TEST_F(LogFile, SkipsLcmsOwnProbe) {
  {
    LogWriter log(folder_ / "log.lcmlog");
    write(log, {std::string(channels::kLcmSelfTest), {1, 2, 3}, 5});
    write(log, eventNumber(0));
  }
  EXPECT_EQ(read({folder_ / "log.lcmlog"}).events, 1);
}

TEST_F(LogFile, ReadsASeriesAsOneLog) {  // a restarted logger continues in .01, .02, ...
  const fs::path first = written("log.lcmlog", 0, 3);
  written("log.lcmlog.100", 9, 3);
  written("log.lcmlog.99", 6, 3);
  written("log.lcmlog.01", 3, 3);
  written("log.lcmlog.bak", 900, 3);
  written("other.lcmlog.01", 900, 3);
  const std::vector<fs::path> files = logSeries(first);
  EXPECT_THAT(files, ElementsAre(first, folder_ / "log.lcmlog.01", folder_ / "log.lcmlog.99",
                                 folder_ / "log.lcmlog.100"));
  EXPECT_EQ(read(files).events, 12);
  for (std::size_t i = 0; i < heard_.size(); ++i) {
    EXPECT_EQ(heard_[i], eventNumber(static_cast<std::int64_t>(i)));
  }
}

TEST_F(LogFile, ReplacesADamagedTimeButKeepsAPauseAndAClockStep) {
  constexpr std::int64_t kHour = 3'600'000'000;
  const std::vector<std::int64_t> written_times{
      1, 1'000'000'000'000'000'000, 2, 3, -5, 4, 2 * kHour, 2 * kHour + 1, kHour, kHour + 1};
  {
    LogWriter log(folder_ / "times.lcmlog");
    for (const std::int64_t utime : written_times) write(log, {"CHANNEL", {1}, utime});
  }
  const LogReadResult result = read({folder_ / "times.lcmlog"});
  std::vector<std::int64_t> times;
  for (const LoggedEvent& event : heard_) times.push_back(event.utime);
  EXPECT_THAT(times, ElementsAre(1, 1, 2, 3, 3, 4, 2 * kHour, 2 * kHour + 1, kHour, kHour + 1));
  EXPECT_EQ(result.bad_times, 2);
}

TEST_F(LogFile, ReplacesADamagedFirstAndLastTime) {
  {
    LogWriter log(folder_ / "times.lcmlog");
    const std::int64_t year = 31'557'600'000'000;
    for (const std::int64_t utime : {20 * year, std::int64_t{5}, std::int64_t{6}, 9 * year}) {
      write(log, {"CHANNEL", {1}, utime});
    }
  }
  const LogReadResult result = read({folder_ / "times.lcmlog"});
  std::vector<std::int64_t> times;
  for (const LoggedEvent& event : heard_) times.push_back(event.utime);
  EXPECT_THAT(times, ElementsAre(5, 5, 6, 6));
  EXPECT_EQ(result.bad_times, 2);
}

}  // namespace
}  // namespace lab::log_file_test
