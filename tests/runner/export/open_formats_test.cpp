// MCAP and HDF5: what is written is read back, byte for byte.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <lab/tracked_frame_t.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "common/schema/schema.hpp"
#include "runner/command_line/exit_code.hpp"
#include "runner/export/csv_export.hpp"
#include "runner/export/hdf5_export.hpp"
#include "runner/export/hdf5_import.hpp"
#include "runner/export/mcap_export.hpp"
#include "runner/export/mcap_reader.hpp"
#include "runner/export/mcap_writer.hpp"
#include "runner/export/table_channels.hpp"
#include "tests/lcmtypes/contract.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::runner {
namespace open_formats_test {

namespace fs = std::filesystem;

class OpenFormats : public testing::Test {
 protected:
  /// A log with messages of every type, each on a channel of its own.
  OpenFormats() {
    LogWriter writer(log);
    std::int64_t utime = 1'700'000'000'000'000;
    for (const std::size_t length : {2U, 0U, 5U, 1U}) {
      forEachType(ChannelTypes{}, [&]<class Message>() {
        writer.write({std::string("CHANNEL_") + Message::getTypeName(),
                      encode(sample<Message>(length)), utime += 1001});
      });
    }
    writer.flush();
    types = 22;
  }

  [[nodiscard]] std::string bytesOf(const fs::path& file) const { return support::readFile(file); }

  TemporaryFolder folder;
  fs::path log = folder.path() / "log.lcmlog";
  std::int64_t types = 0;
};

TEST_F(OpenFormats, McapGivesTheLogBack) {
  const fs::path mcap = folder.path() / "run.mcap";
  for (const bool compress : {true, false}) {
    McapOptions options;
    options.compress = compress;
    const McapResult result = writeMcap({log}, folder.path(), mcap, options);
    EXPECT_EQ(result.messages, 4 * types);
    EXPECT_EQ(result.left_out, 0);
    const fs::path back = folder.path() / (compress ? "back.lcmlog" : "back2.lcmlog");

    EXPECT_EQ(writeLogOfMcap(mcap, back), 4 * types);

    EXPECT_EQ(bytesOf(back), bytesOf(log));
  }
}

TEST_F(OpenFormats, Hdf5GivesTheLogBack) {
  const fs::path h5 = folder.path() / "run.h5";
  const LeftOut left_out = writeHdf5({log}, h5, {{"run", "test"}});
  EXPECT_EQ(left_out.messages, 0);
  EXPECT_EQ(channelsText(left_out), "");
  ASSERT_TRUE(isHdf5(h5));

  EXPECT_EQ(importHdf5(h5, folder.path() / "back.lcmlog", folder.path() / "poses.csv"),
            Hdf5Content::kLog);

  EXPECT_EQ(bytesOf(folder.path() / "back.lcmlog"), bytesOf(log));
}

TEST_F(OpenFormats, CountsWhatIsLeftOut) {
  const fs::path worse = folder.path() / "worse.lcmlog";
  {
    LogWriter writer(worse);
    std::vector<std::uint8_t> cut = encode(sample<clock_t>(0));
    cut.pop_back();
    writer.write({"CLOCK", encode(sample<clock_t>(0)), 1});
    writer.write({"CLOCK", cut, 2});
    writer.write({"OTHER", std::vector<std::uint8_t>{1, 2, 3}, 3});
  }

  const McapResult result =
      writeMcap({worse}, folder.path(), folder.path() / "worse.mcap", McapOptions{});
  const LeftOut left_out = writeHdf5({worse}, folder.path() / "worse.h5", {});
  fs::create_directory(folder.path() / "csv");
  const LeftOut not_in_csv = writeCsv({worse}, folder.path() / "csv");

  EXPECT_EQ(result.messages, 3);
  EXPECT_EQ(result.left_out, 2);
  EXPECT_EQ(left_out.messages, 2);
  EXPECT_EQ(not_in_csv.messages, 2);
  EXPECT_EQ(writeLogOfMcap(folder.path() / "worse.mcap", folder.path() / "back.lcmlog"), 1);
}

std::vector<std::string> filesIn(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    names.push_back(entry.path().lexically_relative(folder).string());
  }
  std::ranges::sort(names);
  return names;
}

/// A stranger's log has channels of any bytes: "/home/me/.bashrc\0" would be a file there.
TEST_F(OpenFormats, TablesLieInTheirFolderWhateverTheChannels) {
  using std::string_literals::operator""s;
  const fs::path strange = folder.path() / "strange.lcmlog";
  const std::vector<std::string> refused{folder.path() / "absolute\0"s,
                                         "../up",
                                         ".hidden",
                                         "in/folder",
                                         "CLOCK\0"s,
                                         "columns",  // columns.csv is there already
                                         "\x1b[2J",
                                         std::string(64, 'x')};
  {
    LogWriter writer(strange);
    const std::vector<std::uint8_t> message = encode(sample<clock_t>(0));
    for (const std::string& channel : refused) writer.write({channel, message, 1});
    writer.write({"CLOCK", message, 2});
    writer.write({"A-b_1.c", message, 3});
  }
  const fs::path results = folder.path() / "results";
  fs::create_directories(results / "csv/in");

  const LeftOut not_in_csv = writeCsv({strange}, results / "csv");
  const LeftOut not_in_hdf5 = writeHdf5({strange}, results / "strange.h5", {});

  EXPECT_THAT(filesIn(results), testing::ElementsAre("csv", "csv/A-b_1.c.csv", "csv/CLOCK.csv",
                                                     "csv/columns.csv", "csv/in", "strange.h5"));
  EXPECT_THAT(filesIn(folder.path()), testing::Not(testing::Contains("absolute")));
  EXPECT_EQ(not_in_csv.messages, 0);
  EXPECT_EQ(not_in_csv.channels.size(), refused.size());
  EXPECT_EQ(not_in_hdf5.messages, 0);
  EXPECT_EQ(not_in_hdf5.channels.size(), refused.size() - 1);  // "columns" is a name like others
  EXPECT_TRUE(fs::exists(results / "strange.h5"));
  const std::string text = channelsText(not_in_csv);
  EXPECT_THAT(text, testing::StartsWith("8 messages on 8 channels left out: found the names "));
  EXPECT_THAT(text, testing::HasSubstr("\"\\x1b[2J\", \"../up\", \".hidden\""));
  EXPECT_THAT(text, testing::HasSubstr("\"CLOCK\\x00\" and 3 more, expected 1 to 63 letters"));
}

/// "A.robots" would be the name of two tables.
TEST_F(OpenFormats, NoTwoTablesHaveOneName) {
  const fs::path twice = folder.path() / "twice.lcmlog";
  {
    LogWriter writer(twice);
    writer.write({"A.robots", encode(sample<clock_t>(0)), 1});
    writer.write({"A", encode(sample<tracked_frame_t>(3)), 2});
    writer.write({"poses", encode(sample<clock_t>(0)), 3});
  }
  const fs::path csv = folder.path() / "csv";
  fs::create_directory(csv);

  const LeftOut not_in_csv = writeCsv({twice}, csv);
  const LeftOut not_in_hdf5 = writeHdf5({twice}, folder.path() / "twice.h5", {});

  EXPECT_EQ(std::ranges::count(bytesOf(csv / "A.robots.csv"), '\n'), 1 + 3);
  EXPECT_THAT(not_in_csv.channels, testing::ElementsAre(testing::Pair("A.robots", 1)));
  EXPECT_THAT(not_in_hdf5.channels,
              testing::ElementsAre(testing::Pair("A.robots", 1), testing::Pair("poses", 1)));
}

/// A file of 100 kB could make a log of any size.
TEST_F(OpenFormats, McapThatExpandsWithoutEndIsRefused) {
  const fs::path huge = folder.path() / "huge.lcmlog";
  {
    experiment_event_t event{};
    event.text = std::string(1'000'000, 'a');
    const std::vector<std::uint8_t> message = encode(event);
    LogWriter writer(huge);
    for (std::int64_t i = 1; i <= 100; ++i) writer.write({"EXPERIMENT_EVENT", message, i});
  }
  const fs::path mcap = folder.path() / "huge.mcap";
  McapOptions options;
  options.ros = false;
  static_cast<void>(writeMcap({huge}, folder.path(), mcap, options));
  ASSERT_LT(fs::file_size(mcap), 300'000U);

  EXPECT_THAT(
      [&] { static_cast<void>(writeLogOfMcap(mcap, folder.path() / "back.lcmlog")); },
      testing::ThrowsMessage<UserError>(testing::HasSubstr("more than 300 times the size of")));
  EXPECT_LT(fs::file_size(folder.path() / "back.lcmlog"), 91'000'000U);
}

/// Where the middle byte of the first chunk is. A record is an opcode of one byte (6: chunk), a
/// little-endian length of eight and its content (mcap.dev/spec).
std::size_t middleOfChunk(const std::string& bytes) {
  std::size_t at = 8;  // after the magic
  while (at + 9 < bytes.size()) {
    std::uint64_t length = 0;
    for (std::size_t i = 8; i > 0; --i) {
      length = length << 8U | static_cast<unsigned char>(bytes[at + i]);
    }
    if (bytes[at] == 6) return at + 9 + static_cast<std::size_t>(length / 2);
    at += 9 + static_cast<std::size_t>(length);
  }
  throw std::runtime_error("no chunk");
}

TEST_F(OpenFormats, McapSaysWhatIsWrongWithAFile) {
  const fs::path mcap = folder.path() / "run.mcap";
  static_cast<void>(writeMcap({log}, folder.path(), mcap, McapOptions{}));
  std::string bytes = bytesOf(mcap);
  const std::size_t in_chunk = middleOfChunk(bytes);
  bytes[in_chunk] = static_cast<char>(bytes[in_chunk] ^ 1);
  std::ofstream(folder.path() / "damaged.mcap", std::ios::binary) << bytes;
  std::ofstream(folder.path() / "text.mcap") << "no MCAP";

  const auto ignore = [](const mcap::Message&) {};
  EXPECT_THROW(mcap::read(folder.path() / "damaged.mcap", ignore), UserError);
  EXPECT_THROW(mcap::read(folder.path() / "text.mcap", ignore), UserError);
  EXPECT_FALSE(mcap::isMcap(folder.path() / "text.mcap"));
  EXPECT_TRUE(mcap::isMcap(mcap));
}

TEST_F(OpenFormats, McapThatWasCutShortIsReadAsFarAsItGoes) {
  const fs::path mcap = folder.path() / "run.mcap";
  mcap::Writer writer(mcap, "test", {.compress = true, .chunk_bytes = 100});
  const auto schema = writer.addSchema("a/msg/A", "ros2msg", "uint8 x\n");
  const auto channel = writer.addChannel(schema, "/a", "cdr");
  for (std::uint8_t i = 0; i < 100; ++i) {
    writer.addMessage(channel, i, i, std::vector<std::uint8_t>{0, 1, 0, 0, i});
  }
  writer.close();
  const auto count = [&](const fs::path& file) {
    std::int64_t messages = 0;
    const mcap::ReadResult result = mcap::read(file, [&](const mcap::Message& message) {
      EXPECT_EQ(message.topic, "/a");
      EXPECT_EQ(message.log_time, static_cast<std::uint64_t>(messages));
      ++messages;
    });
    EXPECT_EQ(result.messages, messages);
    return std::pair(messages, result.whole);
  };
  std::string bytes = bytesOf(mcap);
  bytes.resize(bytes.size() / 3);
  std::ofstream(folder.path() / "cut.mcap", std::ios::binary) << bytes;

  const auto whole = count(mcap);
  const auto cut = count(folder.path() / "cut.mcap");

  EXPECT_EQ(whole, std::pair(std::int64_t{100}, true));
  EXPECT_GT(cut.first, 0);
  EXPECT_LT(cut.first, 100);
  EXPECT_FALSE(cut.second);
}

// Every column of every table, and no other, is in columns.csv and in the header of its file.
/// A log of frames in which each robot of 0 .. robots - 1 is seen every other time.
void writeFrames(const fs::path& log, std::int32_t robots, int frames) {
  LogWriter writer(log);
  for (int i = 0; i < frames; ++i) {
    tracked_frame_t frame{};
    frame.utime = 1'700'000'000'000'000 + 40'000 * i;
    frame.seq = i;
    frame.sender = "tracker";
    frame.frame = i;
    for (std::int32_t id = i % 2; id < robots; id += 2) {
      frame.robots.push_back({});
      frame.robots.back().robot_id = id;
    }
    frame.num_robots = static_cast<std::int32_t>(frame.robots.size());
    writer.write({channels::kTrackedFrame, encode(frame), frame.utime});
  }
  writer.flush();
}

TEST_F(OpenFormats, TrexHasMoreRobotsThanAProcessMayHaveFiles) {
  constexpr std::int32_t kRobots = 1100;
  const fs::path frames = folder / "frames.lcmlog";
  writeFrames(frames, kRobots, 3);
  fs::create_directory(folder / "trex");
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit few = before;
  few.rlim_cur = 600;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  writeTrex({frames}, folder / "trex", "run");
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  for (std::int32_t id = 0; id < kRobots; ++id) {
    const std::string text = bytesOf(folder / ("trex/run_id" + std::to_string(id) + ".csv"));
    ASSERT_EQ(std::count(text.begin(), text.end(), '\n'), 4) << id;
    ASSERT_EQ(text.find("\n0,inf") == std::string::npos, id % 2 == 0) << id;
  }
}

TEST_F(OpenFormats, TrexNeedsTheRoomForARowPerRobotAndFrame) {
  const fs::path frames = folder / "frames.lcmlog";
  writeFrames(frames, 100, 3);
  fs::create_directory(folder / "trex");
  EXPECT_THAT(
      [&] { writeTrex({frames}, folder / "trex", "run", 5999); },
      testing::ThrowsMessage<std::runtime_error>(testing::HasSubstr("too little disk in ")));
  EXPECT_TRUE(fs::is_empty(folder / "trex"));
  writeTrex({frames}, folder / "trex", "run", 6000);
}

TEST_F(OpenFormats, CsvHasEveryTable) {
  const fs::path csv = folder.path() / "csv";
  fs::create_directory(csv);

  EXPECT_EQ(writeCsv({log}, csv).messages, 0);

  const std::string frames = bytesOf(csv / "CHANNEL_tracked_frame_t.robots.csv");
  EXPECT_EQ(frames.substr(0, frames.find('\n')),
            "event,received_utime,parent,utime,robot_id,x,y,theta,covariance_xx,covariance_xy,"
            "covariance_xt,covariance_yy,covariance_yt,covariance_tt,confidence");
  EXPECT_EQ(std::ranges::count(frames, '\n'), 1 + 2 + 0 + 5 + 1);
  EXPECT_NE(bytesOf(csv / "columns.csv").find("CHANNEL_tracked_frame_t.robots,x,m,"),
            std::string::npos);
}

}  // namespace open_formats_test
}  // namespace lab::runner
