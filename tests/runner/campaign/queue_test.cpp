#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runner/campaign/queue/campaign_queue.hpp"
#include "runner/campaign/queue/queue_command.hpp"
#include "runner/command_line/exit_code.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::runner::campaign {
namespace {

using State = QueuedCampaign::State;

QueuedCampaign campaignOf(std::int64_t number, State state) {
  QueuedCampaign campaign;
  campaign.number = number;
  campaign.arguments = {"scan.toml", "--over", "a=\"1\",2"};
  campaign.folder = "/data/lab";
  campaign.state = state;
  return campaign;
}

TEST(CampaignQueue, ReadsWhatItWrites) {
  std::vector<QueuedCampaign> queue{campaignOf(3, State::kFailed), campaignOf(5, State::kWaiting)};
  queue[0].begin_us = 1'000'000;
  queue[0].end_us = 61'000'000;
  queue[0].exit_code = 1;
  EXPECT_EQ(readQueue(queueText(queue), "queue.json"), queue);
  EXPECT_TRUE(readQueue("", "queue.json").empty());
  EXPECT_EQ(lineOf(queue[0]),
            "  3  lab sweep scan.toml --over a=\"1\",2  (failed in 60 s, exit code 1)");
}

TEST(CampaignQueue, ADamagedFileIsOneLine) {
  for (const char* text : {"{", "[{}]", "[1]", "{\"number\":1}", "[{\"number\":\"x\"}]", "{}"}) {
    EXPECT_THROW(static_cast<void>(readQueue(text, "queue.json")), UserError) << text;
  }
}

TEST(CampaignQueue, ImpossibleNumbersAreDamage) {
  const std::string text = queueText({campaignOf(3, State::kFailed)});
  for (const char* key : {"number", "begin_us", "end_us", "exit_code"}) {
    std::string changed = text;
    const std::size_t begin = text.find(':', text.find(fmt::format("\"{}\"", key))) + 1;
    changed.replace(begin, text.find_first_of(",\n", begin) - begin, " 1e300");
    EXPECT_THROW(static_cast<void>(readQueue(changed, "queue.json")), UserError) << changed;
  }
}

TEST(CampaignQueue, TheInterruptedCampaignComesFirst) {
  EXPECT_EQ(nextOf({campaignOf(1, State::kDone), campaignOf(2, State::kWaiting),
                    campaignOf(3, State::kRunning)}),
            2U);
  EXPECT_EQ(nextOf({campaignOf(1, State::kFailed), campaignOf(2, State::kWaiting)}), 1U);
  EXPECT_FALSE(nextOf({campaignOf(1, State::kDone)}));
}

TEST(CampaignQueue, AddsNoCampaignThatAsksForHelpOrHasAnError) {
  const TemporaryFolder folder;
  testing::internal::CaptureStdout();
  EXPECT_EQ(addToQueue({.campaigns = folder / "queue", .arguments = {"scan.toml", "--help"}}),
            kDone);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), testing::HasSubstr(" sweep [OPTIONS]"));
  EXPECT_THAT(
      [&] {
        addToQueue({.campaigns = folder / "queue", .arguments = {"scan.toml", "--seds", "2"}});
      },
      testing::ThrowsMessage<UserError>(
          "--seds: no such option of `lab sweep`; did you mean --seeds?"));
  EXPECT_FALSE(std::filesystem::exists(folder / "queue"));
}

}  // namespace
}  // namespace lab::runner::campaign
