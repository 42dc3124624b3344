#include "runner/commands/spy_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <lab/link_status_t.hpp>
#include <lab/robot_status_t.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/stream_counter.hpp"

namespace lab::runner::spy_table_test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::int64_t kNow = 1'700'000'000'000'000;

class SpyTableTest : public testing::Test {
 protected:
  template <class Message>
  void send(std::string_view channel, const std::string& sender, std::int64_t seq,
            Message message = {}) {
    message.sender = sender;
    message.seq = seq;
    const std::vector<std::uint8_t> data = encode(message);
    dut_.take({channel, data, kNow});
  }

  SpyTable dut_;
};

std::ptrdiff_t linesOf(const std::string& text) { return std::ranges::count(text, '\n'); }

TEST_F(SpyTableTest, ShowsRateSizeAgeAndLossOfEachStream) {
  for (const std::int64_t seq : {1, 2, 5}) send<robot_status_t>("ROBOT_STATUS", "sim_svc", seq);
  send<robot_status_t>("ROBOT_STATUS", "robot_bridge", 1);
  dut_.take({"ROBOT_STATUS", std::vector<std::uint8_t>{1, 2, 3}, kNow});

  const std::string text = dut_.text(2, kNow + 40'000);

  EXPECT_THAT(text, HasSubstr("ROBOT_STATUS      robot_status_t     sim_svc             1.5"));
  EXPECT_THAT(text, HasSubstr("      40         3       2\n"));
  EXPECT_THAT(text, HasSubstr("robot_bridge        0.5"));
  EXPECT_THAT(text, HasSubstr("ROBOT_STATUS      NOT DECODED        1 messages"));
  EXPECT_THAT(dut_.text(2, kNow + 40'000), HasSubstr("sim_svc             0.0"));
}

TEST_F(SpyTableTest, SaysThatTheNameOfASenderMayBeTooLong) {
  send<robot_status_t>("ROBOT_STATUS", std::string(64, 'x'), 1);

  EXPECT_THAT(dut_.text(1, kNow),
              HasSubstr("ROBOT_STATUS      NOT DECODED        1 messages: other message versions, "
                        "another program, or a sender's name above 63 bytes\n"));
}

TEST_F(SpyTableTest, KeepsABoundedNumberOfStreamsAndTellsOfFurtherOnes) {
  // Those that came once and are silent give their places to others.
  for (int sender = 0; sender < 100'000; ++sender) {
    send<robot_status_t>("ROBOT_STATUS", "s" + std::to_string(sender), 1);
  }
  EXPECT_LE(dut_.size(), 2 * StreamCounter::kMostStreams);
  const std::string text = dut_.text(1, kNow);
  EXPECT_LE(dut_.size(), StreamCounter::kMostStreams);
  EXPECT_THAT(text, HasSubstr("messages of further streams: 256 are listed at most"));
  EXPECT_LE(linesOf(text), 2 + 256);
}

TEST_F(SpyTableTest, ListsABoundedNumberOfChannelsOfOthers) {
  const std::vector<std::uint8_t> data{1, 2, 3};
  for (int channel = 0; channel < 5000; ++channel) {
    dut_.take({"X" + std::to_string(channel), data, kNow});
  }
  const std::string text = dut_.text(1, kNow);
  EXPECT_EQ(linesOf(text), 1 + 100 + 1);
  EXPECT_THAT(text, HasSubstr("(other channels)  NOT DECODED     4900 messages\n"));
}

TEST_F(SpyTableTest, ShowsABoundedNumberOfLinks) {
  link_status_t status{};
  status.peers.resize(2000);
  status.num_peers = 2000;
  for (auto& peer : status.peers) peer.state = link_peer_t::JOINED;
  for (int host = 0; host < 150; ++host) {
    status.host = "h" + std::to_string(host);
    send(channels::kLinkStatus, "dds_gateway", host, status);
  }
  const std::string text = dut_.text(1, kNow);
  EXPECT_EQ(linesOf(text), 2 + 100 * 100);
  EXPECT_THAT(text, HasSubstr("link h0 - : joined"));
}

TEST_F(SpyTableTest, ShowsNoLinkThatIsTooLargeOrImpossible) {
  link_status_t status{};
  status.host = "good";
  status.peers.resize(1);
  status.num_peers = 1;
  send(channels::kLinkStatus, "dds_gateway", 1, status);
  status.peers[0].lost = -1;
  status.host = "impossible";
  send(channels::kLinkStatus, "dds_gateway", 2, status);
  status.peers[0].lost = 0;
  status.host = "large" + std::string(300'000, 'x');
  send(channels::kLinkStatus, "dds_gateway", 3, status);

  const std::string text = dut_.text(1, kNow);

  EXPECT_THAT(text, HasSubstr("link good - : ?"));
  EXPECT_THAT(text, Not(HasSubstr("link impossible")));
  EXPECT_THAT(text, Not(HasSubstr("link large")));
}

}  // namespace
}  // namespace lab::runner::spy_table_test
