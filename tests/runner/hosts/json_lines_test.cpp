#include "runner/hosts/json_lines.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <array>
#include <nlohmann/json.hpp>
#include <vector>

namespace lab::runner {
namespace {

struct Pipe {
  Pipe() { EXPECT_EQ(pipe(ends.data()), 0); }
  ~Pipe() {
    close(ends[0]);
    if (open) close(ends[1]);
  }
  void end() {
    close(ends[1]);
    open = false;
  }
  std::array<int, 2> ends{};
  bool open = true;
};

struct Received {
  std::vector<nlohmann::json> messages;
  std::vector<std::string> noise;
  void receive(JsonLines& lines) {
    lines.receive([this](const auto& message) { messages.push_back(message); },
                  [this](const auto& line) { noise.push_back(line); });
  }
};

TEST(JsonLines, DeliversMessagesCompleteAndInOrder) {
  Pipe data;
  Pipe unused;
  JsonLines sender(unused.ends[0], data.ends[1]);
  JsonLines dut(data.ends[0], unused.ends[1]);
  Received received;

  sender.send({{"do", "ping"}, {"utime", 1234567890123456}});
  sender.send({{"say", "line"}, {"text", "two\nlines"}});
  received.receive(dut);

  ASSERT_EQ(received.messages.size(), 2U);
  EXPECT_EQ(received.messages[0]["utime"], 1234567890123456);
  EXPECT_EQ(received.messages[1]["text"], "two\nlines");
  EXPECT_FALSE(dut.closed());
}

TEST(JsonLines, AValueOfAnotherTypeIsReportedAsNoiseOnce) {
  Pipe data;
  Pipe unused;
  JsonLines dut(data.ends[0], unused.ends[1]);
  const std::string text = "{\"say\":5}\n{\"say\":\"alive\"}\n";
  ASSERT_EQ(write(data.ends[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  std::vector<std::string> messages;
  std::vector<std::string> noise;
  for (int i = 0; i < 2; ++i) {
    dut.receive([&](const auto& message) { messages.push_back(message.value("say", "")); },
                [&](const auto& line) { noise.push_back(line); });
  }
  EXPECT_EQ(messages, std::vector<std::string>{"alive"});
  EXPECT_EQ(noise, std::vector<std::string>{"{\"say\":5}"});
}

TEST(JsonLines, WaitsForTheRestOfALineAndSeparatesNoise) {
  Pipe data;
  Pipe unused;
  JsonLines dut(data.ends[0], unused.ends[1]);
  Received received;

  ASSERT_EQ(write(data.ends[1], "motd\n[1]\n{\"a\"", 13), 13);
  received.receive(dut);
  EXPECT_TRUE(received.messages.empty());
  EXPECT_THAT(received.noise, testing::ElementsAre("motd", "[1]"));

  ASSERT_EQ(write(data.ends[1], ":1}\n", 4), 4);
  received.receive(dut);
  ASSERT_EQ(received.messages.size(), 1U);
  EXPECT_EQ(received.messages[0]["a"], 1);
}

TEST(JsonLines, LinesBeyondTheLimitOfACallStayForTheNext) {
  Pipe data;
  Pipe unused;
  JsonLines dut(data.ends[0], unused.ends[1]);
  std::string text;
  for (int i = 0; i < 2500; ++i) text += "{\"n\":" + std::to_string(i) + "}\n";
  ASSERT_EQ(write(data.ends[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  std::vector<int> numbers;
  for (const std::size_t expected : {1000U, 2000U, 2500U, 2500U}) {
    dut.receive([&](const auto& message) { numbers.push_back(message.value("n", -1)); },
                [](const auto&) {}, 1000);
    ASSERT_EQ(numbers.size(), expected);
    EXPECT_EQ(numbers.back(), static_cast<int>(expected) - 1);
    EXPECT_EQ(dut.hasLine(), expected < 2500);
  }
}

/// Lines that come faster than they are handled wait in the pipe, not in memory.
TEST(JsonLines, ReadsNoMoreWhileManyLinesWait) {
  Pipe data;
  Pipe unused;
  JsonLines sender(unused.ends[0], data.ends[1]);
  JsonLines dut(data.ends[0], unused.ends[1]);
  for (int i = 0; i < 10'000; ++i) sender.send({{"data", std::string(1000, 'x')}});
  for (int i = 0; i < 300; ++i) {
    dut.receive([](const auto&) {}, [](const auto&) {}, 1);
    sender.flush();
  }
  EXPECT_GT(sender.waiting(), 5'000'000U);
}

TEST(JsonLines, NeverBlocksOnASlowReader) {
  Pipe data;
  Pipe unused;
  JsonLines sender(unused.ends[0], data.ends[1]);
  JsonLines dut(data.ends[0], unused.ends[1]);
  const std::string large(1'000'000, 'x');  // a pipe holds 65536

  sender.send({{"data", large}});
  EXPECT_GT(sender.waiting(), 900'000U);
  Received received;
  for (int i = 0; i < 100 && received.messages.empty(); ++i) {
    received.receive(dut);
    sender.flush();
  }

  ASSERT_EQ(received.messages.size(), 1U);
  EXPECT_EQ(received.messages[0]["data"], large);
  EXPECT_EQ(sender.waiting(), 0U);
}

TEST(JsonLines, DetectsThatTheOtherSideHasClosed) {
  Pipe data;
  Pipe unused;
  JsonLines dut(data.ends[0], unused.ends[1]);
  Received received;

  ASSERT_EQ(write(data.ends[1], "{}\n", 3), 3);
  data.end();
  received.receive(dut);

  EXPECT_EQ(received.messages.size(), 1U);
  EXPECT_TRUE(dut.closed());
}

TEST(EncodedBytes, FollowRfc4648AndDecodeToTheOriginal) {
  EXPECT_EQ(encodedBytes(""), "");
  EXPECT_EQ(encodedBytes("f"), "Zg==");
  EXPECT_EQ(encodedBytes("fo"), "Zm8=");
  EXPECT_EQ(encodedBytes("foo"), "Zm9v");
  EXPECT_EQ(encodedBytes("foobar"), "Zm9vYmFy");
  std::string all;
  for (int i = 0; i < 1000; ++i) all += static_cast<char>(i * 7);
  for (std::size_t size = 0; size < all.size(); ++size) {
    ASSERT_EQ(decodedBytes(encodedBytes(all.substr(0, size))), all.substr(0, size));
  }
}

}  // namespace
}  // namespace lab::runner
