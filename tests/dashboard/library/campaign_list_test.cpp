#include "dashboard/library/campaign_list.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::dashboard {
namespace {

namespace fs = std::filesystem;

std::string progressOf(std::int64_t pid, bool running, const std::string& updated) {
  return nlohmann::json{{"total", 30},        {"done", 12},           {"failed", 1},
                        {"running", running}, {"seconds_left", 62.0}, {"pid", pid},
                        {"updated", updated}}
      .dump();
}

class Campaigns : public testing::Test {
 protected:
  fs::path make(const std::string& name, const std::string& progress) {
    const fs::path folder = temporary_ / "campaigns" / name;
    support::writeFile(folder / "campaign.toml", "fileversion = 1\n");
    support::writeFile(folder / "progress.json", progress);
    return folder;
  }

  TemporaryFolder temporary_;
  CampaignList list_{temporary_ / "campaigns"};
};

TEST_F(Campaigns, AreListedWithTheirProgressRunningOnesFirst) {
  const fs::path running = make("scan", progressOf(getpid(), true, "2026-01-31T12:00:00Z"));
  support::writeFile(running / "index.html", "<html></html>");
  support::writeFile(running / "journal.jsonl", "");
  make("dead", progressOf(999'999'999, true, "2026-02-01T12:00:00Z"));
  make("damaged", "{\"total\": \"many\", \"pid\": [], \"running\": 3");
  support::writeFile(temporary_ / "campaigns" / "other" / "file", "no campaign");
  const std::vector<CampaignFacts> all = list_.campaigns();
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].name, "scan");
  EXPECT_TRUE(all[0].running);
  EXPECT_TRUE(all[0].live);
  EXPECT_TRUE(all[0].page);
  EXPECT_EQ(all[0].total, 30);
  EXPECT_EQ(all[0].done, 12);
  EXPECT_EQ(all[0].failed, 1);
  EXPECT_EQ(all[0].seconds_left, 62);
  EXPECT_EQ(all[1].name, "dead");
  EXPECT_FALSE(all[1].running) << "its process has ended";
  EXPECT_FALSE(all[1].page);
  EXPECT_EQ(all[2].name, "damaged");
  EXPECT_EQ(all[2].total, 0);
  EXPECT_EQ(nlohmann::json::parse(list_.json()).size(), 3U);
}

TEST_F(Campaigns, WrongTypesInProgressAreNothing) {
  make("odd", R"({"total": "many", "pid": [], "running": 3, "updated": 7, "seconds_left": "x"})");
  const std::vector<CampaignFacts> all = list_.campaigns();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].total, 0);
  EXPECT_FALSE(all[0].running);
  EXPECT_FALSE(all[0].seconds_left);
}

TEST_F(Campaigns, OnlyFilesOfThePageAndOfReportsAreSent) {
  const fs::path folder = make("scan", "{}");
  support::writeFile(folder / "index.html", "page");
  support::writeFile(folder / "figures" / "D_r.svg", "<svg/>");
  support::writeFile(folder / "runs" / "ab-12" / "report.html", "report");
  support::writeFile(folder / "runs" / "ab-12" / "log.lcmlog", "log");
  support::writeFile(temporary_ / "secret.csv", "secret");
  fs::create_symlink(temporary_ / "secret.csv", folder / "link.csv");
  EXPECT_TRUE(list_.file("scan", "index.html"));
  EXPECT_TRUE(list_.file("scan", "figures/D_r.svg"));
  EXPECT_TRUE(list_.file("scan", "runs/ab-12/report.html"));
  for (const char* name : {"link.csv", "runs/ab-12/log.lcmlog", "runs/ab-12", "runs//report.html",
                           "runs/../campaign.toml", "../secret.csv", "", "nothing.html",
                           "figures/../../secret.csv", "runs/ab-12/../../campaign.toml"}) {
    EXPECT_FALSE(list_.file("scan", name)) << name;
  }
  support::writeFile(temporary_ / "elsewhere" / "report.html", "private");
  fs::create_directory_symlink(temporary_ / "elsewhere", folder / "runs" / "link");
  EXPECT_FALSE(list_.file("scan", "runs/link/report.html"));
  fs::rename(folder / "runs", temporary_ / "moved");
  fs::create_directory_symlink(temporary_ / "moved", folder / "runs");
  EXPECT_FALSE(list_.file("scan", "runs/ab-12/report.html"));
  EXPECT_FALSE(list_.file("..", "secret.csv"));
  EXPECT_FALSE(list_.file("nothing", "index.html"));
}

}  // namespace
}  // namespace lab::dashboard
