#include "runner/campaign/campaign_folder.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/files/atomic_file.hpp"
#include "common/files/experiment_error.hpp"
#include "runner/command_line/exit_code.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::runner::campaign::campaign_folder_test {
namespace {

namespace fs = std::filesystem;
using support::readFile;
using support::writeFile;
using testing::HasSubstr;
using Kind = RowState::Kind;

const CodeVersion kCode{"0.1.0 (abc)", 5};

StoredCampaign sampleCampaign() {
  Request request;
  request.name = "sample";
  request.file = "/sample.toml";
  request.over = {"a=1,2"};
  return {request,
          "2026-01-31T12:00:00Z",
          "the user's file\n",
          {makePoint({"1"}, "text with\nlines and \"quotes\"\n", 60),
           makePoint({"2"}, "another\n", 120)}};
}

void writeResult(const fs::path& folder, const Row& row, const CodeVersion& code) {
  RunResult result;
  result.identity = row.identity;
  result.code = code.text;
  result.seed = row.seed;
  result.columns = {{"abp.D_r_rad2_s", 0.75}};
  replaceFile(folder / resultFile(row.identity), resultText(result));
}

class CampaignFolder : public testing::Test {
 protected:
  CampaignFolder() {
    writeCampaign(folder_, campaign_, {{"files/0123.txt", {"content", {}}}});
    rows_ = rowsOf(campaign_.request, campaign_.points, kCode);
  }

  Survey survey() { return surveyRows(folder_, rows_); }

  /// Why the folder is refused; empty: it is read.
  std::string problem() {
    try {
      static_cast<void>(readCampaign(folder_));
    } catch (const std::exception& error) {
      return error.what();
    }
    return {};
  }

  /// Why the folder is refused with these points in place of its second one.
  std::string problemWith(const PointValues& values, double duration) {
    StoredCampaign other = campaign_;
    other.points[1] = makePoint(values, "another\n", duration);
    writeCampaign(folder_, other, {});
    return problem();
  }

  TemporaryFolder temporary_;
  fs::path folder_ = temporary_ / "campaign";
  StoredCampaign campaign_ = sampleCampaign();
  std::vector<Row> rows_;
};

TEST_F(CampaignFolder, IsReadAsItWasWritten) {
  const StoredCampaign read = readCampaign(folder_);

  EXPECT_EQ(read.request, campaign_.request);
  EXPECT_EQ(read.created, campaign_.created);
  EXPECT_EQ(read.experiment_text, campaign_.experiment_text);
  ASSERT_EQ(read.points.size(), 2U);
  EXPECT_EQ(read.points[0].experiment, campaign_.points[0].experiment);
  EXPECT_EQ(read.points[1].values, campaign_.points[1].values);
  EXPECT_EQ(read.points[1].duration, 120);
  EXPECT_EQ(readFile(folder_ / "files/0123.txt"), "content");
}

TEST_F(CampaignFolder, IsReadAfterItWasMoved) {
  writeResult(folder_, rows_[0], kCode);
  const fs::path moved = temporary_ / "elsewhere";
  fs::rename(folder_, moved);

  EXPECT_EQ(readCampaign(moved).points.size(), 2U);
  EXPECT_EQ(surveyRows(moved, rows_).count(Kind::kDone), 1U);
}

TEST_F(CampaignFolder, SaysWhichOfItsFilesIsDamaged) {
  const std::string points = readFile(folder_ / names::kPoints);

  writeFile(folder_ / names::kPoints, points.substr(0, points.size() - 20));
  EXPECT_THAT(problem(), HasSubstr("points.jsonl:3: found a damaged line"));
  std::string other = points;
  other.replace(other.find("another"), 7, "anether");
  writeFile(folder_ / names::kPoints, other);
  EXPECT_THAT(problem(), HasSubstr("points.jsonl:3: found a line without its checksum"));
  writeFile(folder_ / names::kPoints, points.substr(0, points.find("another") - 100));
  EXPECT_THAT(problem(), HasSubstr("points.jsonl:"));
  EXPECT_THAT(problem(), HasSubstr("lab sweep FILE --out"));
  writeFile(folder_ / names::kPoints, points);
  writeFile(folder_ / names::kRequest, "fileversion = 1\n");
  EXPECT_THAT(problem(), HasSubstr("campaign.toml: name: found nothing"));
  fs::remove(folder_ / names::kRequest);
  EXPECT_THAT(problem(), HasSubstr("found no campaign.toml"));
}

TEST_F(CampaignFolder, HasAValueOfEachSweptKeyAtEachPoint) {
  EXPECT_EQ(problemWith({"3"}, 120), "");
  EXPECT_THAT(problemWith({}, 120), HasSubstr("points.jsonl:3: found 0 values for 1 swept keys"));
  EXPECT_THAT(problemWith({"2", "3"}, 120), HasSubstr("points.jsonl:3: found 2 values"));
  EXPECT_THAT(problemWith({"2"}, 0), HasSubstr("points.jsonl:3: found a run of 0 s"));
  EXPECT_THAT(problemWith({"2"}, 1e18), HasSubstr("points.jsonl:3: found a run of 1e+18 s"));

  StoredCampaign other = campaign_;
  other.request.over = {"a"};
  writeCampaign(folder_, other, {});
  EXPECT_THAT(problem(), HasSubstr("campaign.toml: over a: found no key"));
}

TEST_F(CampaignFolder, HasAsManyPointsAndRunsAsFitIntoMemory) {
  const std::string points = readFile(folder_ / names::kPoints);
  const auto withHead = [&](const std::string& count) {
    std::string text = points;
    const std::string_view head = "\"points\":2";
    return text.replace(text.find(head), head.size(), "\"points\":" + count);
  };

  writeFile(folder_ / names::kPoints, withHead("1"));
  EXPECT_THAT(problem(), HasSubstr("points.jsonl:3: found more than 1 points"));
  writeFile(folder_ / names::kPoints, withHead("100001"));
  EXPECT_THAT(problem(), HasSubstr("points.jsonl:1: found 100001 points"));

  StoredCampaign other = campaign_;
  other.request.over = {"a=1:11:11"};
  other.request.seeds = 100'000;
  other.points.clear();
  for (int i = 1; i <= 11; ++i) {
    other.points.push_back(makePoint({std::to_string(i)}, std::to_string(i), 60));
  }
  writeCampaign(folder_, other, {});
  EXPECT_THAT(problem(), HasSubstr("campaign.toml: found 11 points with 100000 seeds each"));
}

TEST_F(CampaignFolder, RefusesLinksWhereEnginesWrite) {
  fs::create_directory(folder_ / "slurm");
  fs::create_directory(folder_ / "parallel");
  writeFile(folder_ / "slurm/7_0.log", "a log");
  EXPECT_NO_THROW(refuseCampaignLinks(folder_));

  for (const char* name : {"slurm/8_0.log", "parallel/returned", "parallel/joblog.txt"}) {
    fs::create_symlink(temporary_ / "elsewhere", folder_ / name);
    EXPECT_THROW(refuseCampaignLinks(folder_), UserError) << name;
    fs::remove(folder_ / name);
  }
  for (const char* name : {"slurm", "parallel"}) {
    fs::remove_all(folder_ / name);
    fs::create_symlink(temporary_ / "elsewhere", folder_ / name);
    EXPECT_THROW(refuseCampaignLinks(folder_), UserError) << name;
    fs::remove(folder_ / name);
  }
}

TEST_F(CampaignFolder, KeepsARequestThatIsReplaced) {
  StoredCampaign other = campaign_;
  other.request.seeds = 9;
  writeCampaign(folder_, other, {});

  EXPECT_EQ(readCampaign(folder_).request.seeds, 9);
  EXPECT_THAT(readFile(folder_ / names::kEarlier / "1-campaign.toml"), HasSubstr("seeds = 1\n"));
  writeCampaign(folder_, other, {});
  EXPECT_FALSE(fs::exists(folder_ / names::kEarlier / "2-campaign.toml"));
}

TEST_F(CampaignFolder, KnowsWhichRowsAreDone) {
  EXPECT_EQ(survey().count(Kind::kMissing), 2U);

  writeResult(folder_, rows_[1], kCode);
  EXPECT_EQ(survey().rows[1].kind, Kind::kDone);
  EXPECT_EQ(survey().rows[1].result->columns.size(), 1U);
}

TEST_F(CampaignFolder, NamesResultsThatAreDamaged) {
  writeResult(folder_, rows_[0], kCode);
  const fs::path file = folder_ / resultFile(rows_[0].identity);
  const std::string text = readFile(file);

  for (const std::string& damaged :
       {std::string(), text.substr(0, text.size() / 2), text + "x", std::string(100, '\0')}) {
    writeFile(file, damaged);
    EXPECT_EQ(survey().rows[0].kind, Kind::kDamaged);
    EXPECT_NE(survey().rows[0].note, "");
  }
}

TEST_F(CampaignFolder, KnowsResultsOfOtherVersionsAndOfOtherPoints) {
  const CodeVersion later{"0.2.0 (def)", 6};
  const std::vector<Row> later_rows = rowsOf(campaign_.request, campaign_.points, later);
  writeResult(folder_, later_rows[0], later);
  Request request = campaign_.request;
  request.seed = 77;
  writeResult(folder_, rowsOf(request, campaign_.points, kCode)[0], kCode);

  EXPECT_EQ(survey().rows[0].kind, Kind::kStale);
  EXPECT_EQ(survey().rows[0].note, "0.2.0 (def)");
  EXPECT_EQ(survey().of_other_points, 1U);
}

TEST_F(CampaignFolder, KnowsWhyARowFailed) {
  writeFile(folder_ / failureFile(rows_[0].identity), "no memory\n");

  EXPECT_EQ(survey().rows[0].kind, Kind::kFailed);
  EXPECT_EQ(survey().rows[0].note, "no memory");
  writeResult(folder_, rows_[0], kCode);
  EXPECT_EQ(survey().rows[0].kind, Kind::kDone);
}

TEST_F(CampaignFolder, IsLockedByOneProcessAtATime) {
  const auto lock = FileLock::tryLock(folder_ / "lock");

  ASSERT_TRUE(lock.has_value());
  EXPECT_FALSE(FileLock::tryLock(folder_ / "lock").has_value());
}

TEST_F(CampaignFolder, RemovesWhatKilledProcessesLeftBehind) {
  fs::path left;
  {
    const WorkFolder work(folder_);
    left = work.path().parent_path() / (work.path().filename().string() + "1");
    fs::create_directories(left);
    writeFile(left / "log", "half a log");
    EXPECT_TRUE(fs::exists(work.path()));
  }
  const WorkFolder work(folder_);

  EXPECT_FALSE(fs::exists(left));
}

TEST_F(CampaignFolder, LocksNothingThroughALink) {
  const fs::path elsewhere = temporary_ / "elsewhere";
  fs::create_symlink(elsewhere, folder_ / "lock");

  EXPECT_THROW(static_cast<void>(FileLock::tryLock(folder_ / "lock")), std::runtime_error);
  EXPECT_FALSE(fs::exists(elsewhere));
}

TEST_F(CampaignFolder, FollowsNoLinkAmongTheWorkFolders) {
  const fs::path elsewhere = temporary_ / "elsewhere";
  const fs::path nowhere = temporary_ / "nowhere";
  fs::create_directory(elsewhere);
  std::string own;
  {
    const WorkFolder work(folder_);
    own = work.path().filename().string();
  }
  // As of a killed process, and as of this one, whose number can be guessed.
  fs::create_directory(folder_ / "work" / (own + "1"));
  fs::create_symlink(nowhere, folder_ / "work" / (own + "1") / "lock");
  fs::create_directory_symlink(elsewhere, folder_ / "work" / ("." + own));
  const WorkFolder work(folder_);

  EXPECT_FALSE(fs::exists(nowhere));
  EXPECT_FALSE(fs::is_symlink(work.path()));
  EXPECT_TRUE(fs::is_empty(elsewhere));
}

}  // namespace
}  // namespace lab::runner::campaign::campaign_folder_test
