#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "runner/campaign/queue/campaign_queue.hpp"
#include "runner/command_line/exit_code.hpp"

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
  for (const char* text : {"{", "[{}]", "[1]", "{\"number\":1}", "[{\"number\":\"x\"}]"}) {
    EXPECT_THROW(static_cast<void>(readQueue(text, "queue.json")), UserError) << text;
  }
}

TEST(CampaignQueue, TheInterruptedCampaignComesFirst) {
  EXPECT_EQ(nextOf({campaignOf(1, State::kDone), campaignOf(2, State::kWaiting),
                    campaignOf(3, State::kRunning)}),
            2U);
  EXPECT_EQ(nextOf({campaignOf(1, State::kFailed), campaignOf(2, State::kWaiting)}), 1U);
  EXPECT_FALSE(nextOf({campaignOf(1, State::kDone)}));
}

}  // namespace
}  // namespace lab::runner::campaign
