#include "runner/live/dashboard_process.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <thread>

#include "runner/command_line/exit_code.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::runner {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST(WantsDashboard, InRealTimeUnlessDisabled) {
  EXPECT_TRUE(wantsDashboard({}, false, nullptr));
  EXPECT_TRUE(wantsDashboard({}, false, ""));
  EXPECT_FALSE(wantsDashboard({}, false, "true"));
  EXPECT_TRUE(wantsDashboard(true, false, "true"));
  EXPECT_FALSE(wantsDashboard(false, false, nullptr));
  EXPECT_FALSE(wantsDashboard({}, true, nullptr));
  EXPECT_FALSE(wantsDashboard(false, true, nullptr));
  EXPECT_THROW((void)wantsDashboard(true, true, nullptr), UserError);
}

/// A dashboard whose program is a shell script.
class DashboardProcessTest : public testing::Test {
 protected:
  DashboardOptions options(const std::string& script) {
    const fs::path program = folder_ / "dashboard";
    std::ofstream(program) << "#!/bin/sh\n" << script;
    fs::permissions(program, fs::perms::owner_all);
    return {.program = program,
            .url = "memq://",
            .runs = folder_ / "",
            .address_file = folder_ / "address",
            .address_copy = folder_ / "copy",
            .output = folder_ / "output"};
  }

  /// Supervises it until `done`, at most for 10 s.
  bool superviseUntil(DashboardProcess& page, const std::function<bool()>& done) {
    for (int i = 0; i < 1000 && !done(); ++i) {
      page.supervise(now_us_, report_);
      now_us_ += 100'000;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return done();
  }

  TemporaryFolder folder_;
  std::vector<std::string> faults_;
  std::int64_t now_us_ = 0;
  std::function<void(const std::string&)> report_ = [this](const std::string& what) {
    faults_.push_back(what);
  };
};

constexpr const char* kGood = R"(
while [ $# -gt 0 ]; do [ "$1" = --address-file ] && file=$2; shift; done
echo "http://127.0.0.1:8480/#token=$$" > "$file.new"; mv "$file.new" "$file"
echo $$ >> "$file.pids"
exec sleep 60
)";

TEST_F(DashboardProcessTest, ItsAddressIsReadableOnlyByTheOwnerAndRemovedAtTheEnd) {
  {
    DashboardProcess page(options(kGood));
    page.start(report_);
    ASSERT_TRUE(superviseUntil(page, [&] { return !page.address().empty(); }));
    EXPECT_THAT(page.address(), HasSubstr("http://127.0.0.1:8480/#token="));
    struct stat status {};
    ASSERT_EQ(stat((folder_ / "copy").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0600U);
    std::string copy;
    std::getline(std::ifstream(folder_ / "copy"), copy);
    EXPECT_EQ(copy, page.address());
  }
  EXPECT_FALSE(fs::exists(folder_ / "address"));
  EXPECT_FALSE(fs::exists(folder_ / "copy"));
  EXPECT_THAT(faults_, IsEmpty());
}

TEST_F(DashboardProcessTest, IgnoresTheAddressOfAnEarlierProcess) {
  std::ofstream(folder_ / "address") << "http://127.0.0.1:1/#token=old\n";
  DashboardProcess page(options(kGood));
  page.start(report_);
  ASSERT_TRUE(superviseUntil(page, [&] { return !page.address().empty(); }));
  EXPECT_THAT(page.address(), HasSubstr(":8480/"));
}

TEST_F(DashboardProcessTest, IsRestartedWithItsPreviousAddressFile) {
  DashboardProcess page(options(kGood));
  page.start(report_);
  ASSERT_TRUE(superviseUntil(page, [&] { return !page.address().empty(); }));
  const std::string before = page.address();
  int pid = 0;
  ASSERT_TRUE(superviseUntil(
      page, [&] { return static_cast<bool>(std::ifstream(folder_ / "address.pids") >> pid); }));
  ASSERT_EQ(kill(pid, SIGKILL), 0);
  ASSERT_TRUE(superviseUntil(page, [&] { return !faults_.empty(); }));
  EXPECT_THAT(faults_,
              testing::ElementsAre("dashboard died (killed by signal 9) and was restarted"));
  EXPECT_TRUE(fs::exists(folder_ / "address")) << "the next process uses it";
  ASSERT_TRUE(superviseUntil(page, [&] { return page.address() != before; }));
  std::string copy;
  std::getline(std::ifstream(folder_ / "copy"), copy);
  EXPECT_EQ(copy, page.address()) << "with another port or token";
  EXPECT_FALSE(page.givenUp());
}

TEST_F(DashboardProcessTest, IsNotRestartedAfterRepeatedFailures) {
  DashboardProcess page(options("exit 3\n"));
  page.start(report_);
  ASSERT_TRUE(superviseUntil(page, [&] { return page.givenUp(); }));
  EXPECT_THAT(faults_, SizeIs(6));
  EXPECT_EQ(faults_[1], "dashboard died (exit code 3) and is restarted in 0.5 s");
  EXPECT_THAT(faults_.back(), HasSubstr("everything else continues"));
}

TEST_F(DashboardProcessTest, IsSkippedIfItIsNotInstalled) {
  DashboardOptions missing = options(kGood);
  missing.program = folder_ / "nowhere";
  DashboardProcess page(missing);
  page.start(report_);
  EXPECT_TRUE(page.givenUp());
  page.supervise(now_us_, report_);
  EXPECT_THAT(faults_,
              testing::ElementsAre(testing::AllOf(
                  HasSubstr(missing.program.string() + " does not exist: ./lab build builds it"),
                  HasSubstr("everything else continues"))));
}

}  // namespace
}  // namespace lab::runner
