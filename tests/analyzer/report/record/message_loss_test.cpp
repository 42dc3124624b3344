#include "analyzer/report/record/message_loss.hpp"

#include <gtest/gtest.h>

#include "common/bus/channels.hpp"

namespace lab::report {
namespace {

constexpr std::int64_t kSecond = 1'000'000;
constexpr std::int64_t kLogBegins = 1000 * kSecond;

/// Sends messages to a counter as one start of one service.
class Sender {
 public:
  Sender(MessageLossCounter& ledger, std::string name, std::int64_t instance,
         std::int64_t start_utime)
      : loss_counter_(ledger),
        name_(std::move(name)),
        instance_(instance),
        start_utime_(start_utime) {}

  void send(std::string_view channel, std::int64_t seq, std::int64_t received_utime = kLogBegins,
            std::int64_t age_us = 0) {
    MessageHeader header;
    header.utime = received_utime - age_us;
    header.sender = name_;
    header.instance = instance_;
    header.seq = seq;
    loss_counter_.count(channel, header, received_utime);
  }

  void status(std::int64_t seq, const std::vector<std::pair<std::string, std::int64_t>>& sent,
              bool ended) {
    send(channels::kServiceStatus, seq);
    service_status_t status{};
    status.sender = name_;
    status.instance = instance_;
    status.start_utime = start_utime_;
    status.state = ended ? service_status_t::ENDED : service_status_t::READY;
    for (const auto& [channel, messages] : sent) status.sent.push_back({channel, messages});
    loss_counter_.take(status);
  }

 private:
  MessageLossCounter& loss_counter_;
  std::string name_;
  std::int64_t instance_;
  std::int64_t start_utime_;
};

StreamLoss find(const MessageLossCounter& ledger, const std::string& sender,
                std::string_view channel, int start = 1) {
  for (const StreamLoss& loss : ledger.streams()) {
    if (loss.sender == sender && loss.channel == channel && loss.start == start) return loss;
  }
  ADD_FAILURE() << "no stream " << channel << " of " << sender;
  return {};
}

TEST(MessageLossCounter, CountsAllMessagesOfASenderThatStartedInTheLog) {
  MessageLossCounter dut;
  Sender service(dut, "sim_svc", 7, kLogBegins);

  for (std::int64_t seq = 3; seq <= 98; ++seq) service.send("TRACKED_FRAME", seq);
  service.status(1, {{"TRACKED_FRAME", 100}, {"SERVICE_STATUS", 1}}, true);

  // The first two and the last two leave no gap in the message numbers.
  EXPECT_EQ(find(dut, "sim_svc", "TRACKED_FRAME").lost, 4);
  EXPECT_EQ(find(dut, "sim_svc", "TRACKED_FRAME").received, 96);
  EXPECT_FALSE(find(dut, "sim_svc", "TRACKED_FRAME").at_least);
}

TEST(MessageLossCounter, CountsAStreamWithoutAnyMessageInTheLog) {
  MessageLossCounter dut;
  Sender service(dut, "sim_svc", 7, kLogBegins);

  service.status(1, {{"SIM_TRUTH", 40}, {"SERVICE_STATUS", 1}}, true);

  EXPECT_EQ(find(dut, "sim_svc", "SIM_TRUTH").lost, 40);
}

TEST(MessageLossCounter, CountsFromTheFirstMessageOfAnEarlierSender) {
  MessageLossCounter dut;
  Sender service(dut, "sim_svc", 7, kLogBegins - 60 * kSecond);

  service.send("TRACKED_FRAME", 501);
  service.status(61, {{"TRACKED_FRAME", 501}, {"SERVICE_STATUS", 61}}, false);
  service.send("TRACKED_FRAME", 503);
  service.status(62, {{"TRACKED_FRAME", 503}, {"SERVICE_STATUS", 62}}, true);

  EXPECT_EQ(find(dut, "sim_svc", "TRACKED_FRAME").lost, 1);
  EXPECT_EQ(find(dut, "sim_svc", "SERVICE_STATUS").lost, 0);
}

TEST(MessageLossCounter, CountsAChannelThatBeganAfterTheLogFromItsFirstMessage) {
  MessageLossCounter dut;
  Sender service(dut, "lab", 7, kLogBegins - 2 * kSecond);

  service.status(3, {{"SERVICE_STATUS", 3}}, false);
  service.send("EXPERIMENT_EVENT", 2);
  service.status(4, {{"EXPERIMENT_EVENT", 2}, {"SERVICE_STATUS", 4}}, true);

  EXPECT_EQ(find(dut, "lab", "EXPERIMENT_EVENT").lost, 1);
}

TEST(MessageLossCounter, GivesALowerBoundForAKilledSender) {
  MessageLossCounter dut;
  Sender service(dut, "sim_svc", 7, kLogBegins);

  service.status(1, {{"TRACKED_FRAME", 0}, {"SERVICE_STATUS", 1}}, false);
  for (const std::int64_t seq : {1, 2, 5, 6}) service.send("TRACKED_FRAME", seq);

  EXPECT_EQ(find(dut, "sim_svc", "TRACKED_FRAME").lost, 2);
  EXPECT_TRUE(find(dut, "sim_svc", "TRACKED_FRAME").at_least);
}

TEST(MessageLossCounter, CountsRepeatedCommands) {
  MessageLossCounter dut;
  Sender service(dut, "lab", 7, kLogBegins);

  for (int i = 0; i < 9; ++i) service.send(channels::kRobotCommand, 1);
  service.send(channels::kRobotCommand, 2);
  service.status(1, {{"ROBOT_COMMAND", 12}, {"SERVICE_STATUS", 1}}, true);

  EXPECT_EQ(find(dut, "lab", "ROBOT_COMMAND").lost, 2);
}

TEST(MessageLossCounter, CountsCommandsOfAnEarlierSenderFromItsFirstStatus) {
  MessageLossCounter dut;
  Sender service(dut, "lab", 7, kLogBegins - 60 * kSecond);

  service.send(channels::kRobotCommand, 1);
  service.status(61, {{"ROBOT_COMMAND", 300}, {"SERVICE_STATUS", 61}}, false);
  for (int i = 0; i < 3; ++i) service.send(channels::kRobotCommand, 1);
  service.status(62, {{"ROBOT_COMMAND", 305}, {"SERVICE_STATUS", 62}}, true);

  EXPECT_EQ(find(dut, "lab", "ROBOT_COMMAND").lost, 2);
}

TEST(MessageLossCounter, SeparatesTheStartsOfAService) {
  MessageLossCounter dut;
  Sender first(dut, "sim_svc", 7, kLogBegins);
  Sender second(dut, "sim_svc", 9, kLogBegins + kSecond);

  first.send("TRACKED_FRAME", 1);
  second.send("TRACKED_FRAME", 2);
  second.status(1, {{"TRACKED_FRAME", 2}, {"SERVICE_STATUS", 1}}, true);

  EXPECT_EQ(find(dut, "sim_svc", "TRACKED_FRAME", 1).lost, 0);
  EXPECT_TRUE(find(dut, "sim_svc", "TRACKED_FRAME", 1).at_least);
  EXPECT_EQ(find(dut, "sim_svc", "TRACKED_FRAME", 2).lost, 1);
  EXPECT_FALSE(find(dut, "sim_svc", "TRACKED_FRAME", 2).at_least);
}

TEST(MessageLossCounter, DoesNotCountALateMessageAsLost) {
  MessageLossCounter dut;
  Sender service(dut, "sim_svc", 7, kLogBegins);

  for (const std::int64_t seq : {2, 1, 4, 3}) service.send("TRACKED_FRAME", seq);
  service.status(1, {{"TRACKED_FRAME", 4}, {"SERVICE_STATUS", 1}}, true);

  EXPECT_EQ(find(dut, "sim_svc", "TRACKED_FRAME").lost, 0);
}

TEST(MessageLossCounter, ReportsTheLargestAge) {
  MessageLossCounter dut;
  Sender service(dut, "sim_svc", 7, kLogBegins);

  service.send("TRACKED_FRAME", 1, kLogBegins, 20'000);
  service.send("TRACKED_FRAME", 2, kLogBegins + 1, 35'000);
  service.send("TRACKED_FRAME", 3, kLogBegins + 2, 10'000);

  EXPECT_DOUBLE_EQ(find(dut, "sim_svc", "TRACKED_FRAME").largest_age, 0.035);
}

}  // namespace
}  // namespace lab::report
