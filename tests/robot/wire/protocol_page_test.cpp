// Compares docs/protocol.md with the code: types, sizes, offsets, widths, names, times, examples.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <iomanip>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "robot/wire/config.hpp"
#include "tests/robot/wire/message_examples.hpp"

namespace lab::wire {
namespace {

std::vector<std::string> linesOf(const std::string& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file) << path;
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

const std::vector<std::string>& page() {
  static const std::vector<std::string> lines = linesOf(LAB_DOCS_DIRECTORY "/protocol.md");
  return lines;
}

std::string wholePage() {
  std::string text;
  for (const std::string& line : page()) text += line + "\n";
  return text;
}

using Row = std::vector<std::string>;

/// The cells of a line of a table, without blanks and backquotes at their ends.
Row cellsOf(const std::string& line) {
  Row cells;
  std::istringstream in(line.substr(1));
  for (std::string cell; std::getline(in, cell, '|');) {
    const auto first = cell.find_first_not_of(" `");
    cells.push_back(first == std::string::npos
                        ? ""
                        : cell.substr(first, cell.find_last_not_of(" `") - first + 1));
  }
  return cells;
}

/// The rows of the nth table below a heading, without header and separator; empty if there is no
/// such table.
std::vector<Row> tableBelow(const std::string& heading, std::size_t nth = 0) {
  std::vector<std::vector<Row>> tables;
  bool below = false;
  bool inside = false;
  for (const std::string& line : page()) {
    if (below && line.starts_with("#")) break;
    below = below || line == heading;
    const bool was_inside = inside;
    inside = below && line.starts_with("|");
    if (inside && !was_inside) tables.emplace_back();
    if (inside) tables.back().push_back(cellsOf(line));
  }
  EXPECT_TRUE(below) << "docs/protocol.md has no line '" << heading << "'";
  if (nth >= tables.size()) return {};
  return {tables[nth].begin() + 2, tables[nth].end()};
}

std::string hexOf(unsigned value, int digits) {
  std::ostringstream out;
  out << "0x" << std::hex << std::uppercase << std::setw(digits) << std::setfill('0') << value;
  return out.str();
}

/// The types of a message's fields in the notation of the page, and their sizes.
struct FieldList {
  std::vector<std::pair<std::string, int>> fields;
  void operator()(const std::uint8_t&) { fields.emplace_back("u8", 1); }
  void operator()(const std::uint16_t&) { fields.emplace_back("u16", 2); }
  void operator()(const std::uint32_t&) { fields.emplace_back("u32", 4); }
  void operator()(const std::int32_t&) { fields.emplace_back("i32", 4); }
  template <std::uint8_t N>
  void counts10(const std::uint16_t (&)[N]) {
    fields.emplace_back(std::to_string(N) + " x u10", N / 4 * 5);
  }
};

/// The names of the fields of every message type, in the order of robot/wire/messages.hpp.
std::map<int, std::vector<std::string>> namesInSource() {
  std::map<int, std::vector<std::string>> names;
  const std::regex type("kType = 0x([0-9A-F]+)");
  const std::regex field("v(?:\\.counts10)?\\(m\\.(\\w+)");
  int current = 0;
  for (const std::string& line : linesOf(LAB_WIRE_DIRECTORY "/messages.hpp")) {
    std::smatch match;
    if (std::regex_search(line, match, type)) current = std::stoi(match[1], nullptr, 16);
    if (std::regex_search(line, match, field)) names[current].push_back(match[1]);
  }
  return names;
}

TEST(ProtocolPage, ListsEveryMessageWithItsSizesAndTimes) {
  const auto rows = tableBelow("## Messages");
  std::size_t at = 0;
  forEachMessage([&](const char* name, const auto& message) {
    ASSERT_LT(at, rows.size());
    const int payload = payloadSize<std::remove_cvref_t<decltype(message)>>();
    std::ostringstream ms;
    ms << std::fixed << std::setprecision(1) << (payload + kFrameOverhead) * 10 / 38.4;
    const Row row(rows[at].begin(), rows[at].begin() + 6);
    EXPECT_EQ(
        row, (Row{hexOf(message.kType, 2), name,
                  message.kType < 0x80 ? "host to robot" : "robot to host", std::to_string(payload),
                  std::to_string(payload + kFrameOverhead), ms.str()}));
    ++at;
  });
  EXPECT_EQ(at, rows.size());
}

TEST(ProtocolPage, ListsEveryFieldAtItsOffset) {
  const auto names = namesInSource();
  forEachMessage([&](const char* name, const auto& message) {
    const auto rows = tableBelow("### " + hexOf(message.kType, 2) + " " + name);
    FieldList list;
    std::remove_cvref_t<decltype(message)>::fields(message, list);
    ASSERT_EQ(rows.size(), list.fields.size()) << name;
    int offset = 0;
    std::vector<std::string> documented;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      EXPECT_EQ(rows[i][0], std::to_string(offset)) << name << " " << rows[i][2];
      EXPECT_EQ(rows[i][1], list.fields[i].first) << name << " " << rows[i][2];
      EXPECT_FALSE(rows[i][3].empty()) << name << " " << rows[i][2];
      offset += list.fields[i].second;
      const std::string field = rows[i][2].substr(0, rows[i][2].find('['));
      if (std::find(documented.begin(), documented.end(), field) == documented.end()) {
        documented.push_back(field);
      }
    }
    const auto known = names.find(message.kType);
    EXPECT_EQ(documented, known == names.end() ? std::vector<std::string>{} : known->second)
        << name;
  });
}

/// The first cells of a table as numbers.
std::vector<int> numbersBelow(const std::string& heading, std::size_t nth = 0) {
  std::vector<int> numbers;
  for (const Row& row : tableBelow(heading, nth)) numbers.push_back(std::stoi(row[0]));
  return numbers;
}

TEST(ProtocolPage, ListsEveryNumberOfTheEnums) {
  EXPECT_EQ(numbersBelow("### 0x83 ACK", 1),
            (std::vector<int>{kOk, kUnknownType, kBadLength, kBadValue, kWrongConfig, kBusy,
                              kStoreFailed, kMissing, kNoPlace, kBadProgram}));
  EXPECT_EQ(numbersBelow("### 0x94 EVENT", 1),
            (std::vector<int>{kBooted, kLeaseOver, kStopLatched, kStopReleased, kWatchdogRestart,
                              kSettingsDefault, kSettingsStored, kProgramStored}));
  EXPECT_EQ(
      numbersBelow("### 0x90 TELEMETRY", 1),
      (std::vector<int>{dynamics::kReversing, dynamics::kStopped, dynamics::kLeaseExpired,
                        dynamics::kSaturated, dynamics::kTumbling, dynamics::kDriven,
                        dynamics::kNoLightBand, dynamics::kUnconfigured, dynamics::kNoProgram}));
  EXPECT_EQ(numbersBelow("### Parameters"),
            (std::vector<int>{kUid, kGainLeft, kGainRight, kDeadBandLeft, kDeadBandRight,
                              kWheelBase, kTelemetryPeriod, kStepLog}));
  EXPECT_EQ(numbersBelow("### Settings"), (std::vector<int>{kBadBands, kBadReversal, kBadLimits}));
}

TEST(ProtocolPage, GivesVersionSchemaAndCheckValue) {
  const std::string text = wholePage();
  EXPECT_NE(text.find("Protocol version " + std::to_string(kProtocolVersion) + ", schema " +
                      hexOf(kSchema, 4)),
            std::string::npos);
  EXPECT_EQ(tableBelow("### 0x82 HELLO")[0][3].substr(0, 6), hexOf(kSchema, 4));
  EXPECT_NE(text.find("`123456789` it is 0x906E"), std::string::npos);
  EXPECT_NE(text.find("A payload of n bytes is a frame of n + " + std::to_string(kFrameOverhead) +
                      " bytes, at most " + std::to_string(kMaxFrame)),
            std::string::npos);
}

/// All lines of the page that contain a frame in hex, decoded.
std::vector<Frame> examplesOnPage() {
  const std::regex frame("00( [0-9A-F]{2})+ 00");
  std::vector<Frame> frames;
  for (const std::string& line : page()) {
    if (!std::regex_match(line, frame)) continue;
    Decoder decoder;
    const auto found = received(decoder, hexBytes(line));
    EXPECT_EQ(found.size(), 1U) << line;
    if (found.empty()) continue;
    EXPECT_EQ(encoded(found[0]), hexBytes(line));
    frames.push_back(found[0]);
  }
  return frames;
}

TEST(ProtocolPage, ExampleFramesMatchTheText) {
  const auto frames = examplesOnPage();
  ASSERT_EQ(frames.size(), 3U);
  Order order;
  ASSERT_TRUE(unpack(frames[0], order));
  EXPECT_EQ(frames[0].seq, 7);
  EXPECT_EQ(order.id, 9);
  EXPECT_EQ(order.mode, Order::kDrive);
  EXPECT_EQ(order.config, 0xBEEF);
  EXPECT_EQ(order.left_um_s, -50000);
  EXPECT_EQ(order.right_um_s, 50000);
  EXPECT_EQ(order.lease_ms, 500U);
  for (const int i : {1, 2}) {
    Ack ack;
    ASSERT_TRUE(unpack(frames[static_cast<std::size_t>(i)], ack));
    EXPECT_EQ(frames[static_cast<std::size_t>(i)].seq, 7);
    EXPECT_EQ(ack.type, Order::kType);
    EXPECT_EQ(ack.status, i == 1 ? kOk : kWrongConfig);
    EXPECT_EQ(ack.detail, 0);
  }
}

TEST(ProtocolPage, DecodesTheExampleIntoItsRawBytes) {
  Bytes raw;
  for (const Row& row : tableBelow("### Example")) raw = raw + hexBytes(row[2]);
  const auto frames = examplesOnPage();
  ASSERT_FALSE(frames.empty());
  EXPECT_EQ(stuffed(raw), encoded(frames[0]));
}

TEST(ProtocolPage, GivesTheLoadOfTheLine) {
  std::map<std::string, int> frame_of;
  forEachMessage([&](const char* name, const auto& message) {
    frame_of[name] = payloadSize<std::remove_cvref_t<decltype(message)>>() + kFrameOverhead;
  });
  for (const Row& row : tableBelow("## Load of the line")) {
    std::smatch match;
    const std::regex name("[A-Z_]{4,}");
    ASSERT_TRUE(std::regex_search(row[0], match, name)) << row[0];
    const int bytes = std::stoi(row[1]) * frame_of.at(match[0]);
    EXPECT_EQ(row[2], std::to_string(bytes)) << row[0];
    EXPECT_NEAR(std::stod(row[3]), 100 * bytes / 3840.0, 0.051) << row[0];
  }
}

}  // namespace
}  // namespace lab::wire
