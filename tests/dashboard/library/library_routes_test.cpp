#include "dashboard/library/library_routes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <latch>
#include <string>
#include <thread>
#include <vector>

#include "tests/dashboard/web/web_fixture.hpp"
#include "tests/support/text_file.hpp"

namespace lab::dashboard {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

constexpr const char* kSummary = R"({"format": 1, "experiment": "abp", "duration_s": 60.5,
  "faults": [{"t_s": 1, "text": "robot 2 is silent"}],
  "programs": [{"name": "abp", "model": "abp", "pool": {"verdict": "agrees", "max_z": 1.5,
    "estimates": {"D_r_rad2_s": {"value": 0.7, "standard_error": 0.1, "low95": 0.5, "high95": 0.9,
                                 "theory": 0.75, "note": "x"},
                  "L_s_cm": {"value": 4, "standard_error": null, "low95": null, "high95": null,
                             "theory": 4, "note": ""}},
    "msd": {"lag_s": [0.1, 0.2], "value_cm2": [1, 2], "standard_error_cm2": [0.1, 0.2],
            "exact_cm2": [1, 2.1], "paper_cm2": [1, 2.2], "windows": [9, 8],
            "selection_biased": [false, true]},
    "angular_msd": {"lag_s": [0.1], "value_rad2": [3], "standard_error_rad2": [0.3]}},
   "each_robot": [{"robot": 1, "verdict": "disagrees", "max_z": 9}]}],
  "losses": {"log": [{"channel": "A", "lost": 3}, {"channel": "B", "lost": 4}]}})";

void makeRun(const fs::path& folder) {
  support::writeFile(folder / "experiment.toml", "name = \"abp\"\n");
  support::writeFile(folder / "summary.json", kSummary);
  support::writeFile(folder / "provenance.json",
                     R"({"started": "2026-01-31T12:00:00Z", "faults": []})");
  support::writeFile(folder / "report.html", "<html>report</html>");
  support::writeFile(folder / "trajectory_program.svg", "<svg/>");
  support::writeFile(folder / "figures" / "msd_abp.csv", "lag_s\n");
  support::writeFile(folder / "log.lcmlog", "secret");
}

TEST(RunList, ListsRunsWithTheirFacts) {
  const TemporaryFolder folder;
  makeRun(folder / "abp-20260131T120000Z");
  RunList list(folder / "");
  const std::vector<PastRun> runs = list.runs();
  ASSERT_THAT(runs, SizeIs(1));
  const PastRun& run = runs.front();
  EXPECT_EQ(run.name, "abp-20260131T120000Z");
  EXPECT_EQ(run.experiment, "abp");
  EXPECT_EQ(run.start_utc, "2026-01-31T12:00:00Z");
  EXPECT_EQ(run.duration_s, 60.5);
  EXPECT_TRUE(run.marked);
  EXPECT_EQ(run.lost, 7);
  ASSERT_THAT(run.verdicts, SizeIs(1));
  EXPECT_EQ(run.verdicts.front().verdict, "agrees");
  EXPECT_EQ(run.verdicts.front().max_z, 1.5);
  EXPECT_EQ(run.thumbnail, "trajectory_program.svg");
  EXPECT_TRUE(run.report);
  EXPECT_FALSE(run.film);
  EXPECT_EQ(run.problem, "");
}

TEST(RunList, KnowsWhichRunsHaveAFilm) {
  const TemporaryFolder folder;
  const fs::path run = folder / "abp-20260131T120000Z";
  makeRun(run);
  support::writeFile(run / "film.mp4", "film");
  RunList list(folder / "");
  EXPECT_FALSE(list.runs().front().film);  // without times it cannot be shown at the slider

  const TemporaryFolder other;
  const fs::path whole = other / "abp-20260131T120000Z";
  makeRun(whole);
  support::writeFile(whole / "film.mp4", "film");
  support::writeFile(whole / "film_clip.json", "{}");
  EXPECT_TRUE(RunList(other / "").runs().front().film);
}

TEST(RunList, ListsDamagedAndIncompleteRunsWithAProblem) {
  const TemporaryFolder folder;
  support::writeFile(folder / "running-20260301T000000Z/experiment.toml", "");
  const std::string whole = kSummary;
  support::writeFile(folder / "broken-20260201T000000Z/summary.json",
                     whole.substr(0, whole.size() / 2));
  support::writeFile(folder / "other-20260101T000000Z/summary.json", R"({"some": "thing"})");
  support::writeFile(folder / "odd-20251201T000000Z/summary.json",
                     R"({"format": 1, "programs": 3, "losses": [1]})");
  support::writeFile(folder / "odd-20251201T000000Z/provenance.json",
                     R"({"started": 5, "faults": "x"})");
  support::writeFile(folder / "nothing/readme.txt", "");
  support::writeFile(folder / "file", "");
  RunList list(folder / "");
  std::vector<std::string> names;
  for (const PastRun& run : list.runs()) {
    names.push_back(run.name);
    EXPECT_EQ(run.problem.empty(), run.name.starts_with("odd")) << run.name;
  }
  EXPECT_THAT(names, ElementsAre("running-20260301T000000Z", "broken-20260201T000000Z",
                                 "other-20260101T000000Z", "odd-20251201T000000Z"));
  EXPECT_EQ(RunList(folder / "none").json(), "[]");
}

/// A page that anybody may open must not take gigabytes of memory for a run that a stranger made.
TEST(RunList, ReadsNoProvenanceOfManyMegabytes) {
  const TemporaryFolder folder;
  makeRun(folder / "abp-20260131T120000Z");
  std::string text = R"({"started": "x", "a": [[])";
  for (int i = 0; i < 500'000; ++i) text += ",[]";
  support::writeFile(folder / "abp-20260131T120000Z/provenance.json", text + "]}");
  const std::vector<PastRun> runs = RunList(folder / "").runs();
  ASSERT_THAT(runs, SizeIs(1));
  EXPECT_EQ(runs.front().problem,
            "its provenance.json is larger than 1 MB, which no lab run writes");
}

TEST(RunList, DoesNotReadHostileSummaries) {
  const TemporaryFolder runs;
  fs::create_directory(runs / "large");
  fs::create_directory(runs / "long");
  std::ofstream(runs / "large/summary.json");
  fs::resize_file(runs / "large/summary.json", 65U << 20U);
  std::string numbers = R"({"format": 1, "x": [0)";
  for (int i = 0; i < 5'000'000; ++i) numbers += ",1";
  std::ofstream(runs / "long/summary.json") << numbers << "]}";

  // What the list keeps of a run is sent with every answer.
  std::string programs = R"({"format": 1, "programs": [{})";
  for (int i = 0; i < 1000; ++i) programs += ",{}";
  support::writeFile(runs / "many/summary.json", programs + "]}");
  support::writeFile(runs / "wordy/summary.json",
                     R"({"format": 1, "experiment": ")" + std::string(1001, 'a') + R"("})");

  EXPECT_THAT(readRun(runs / "large").problem, HasSubstr("larger than 64 MB"));
  for (const char* name : {"long", "many", "wordy"}) {
    EXPECT_THAT(readRun(runs / name).problem, HasSubstr("cannot be read")) << name;
  }
}

TEST(RunList, NoticesChangedAndRemovedRuns) {
  const TemporaryFolder folder;
  support::writeFile(folder / "a/experiment.toml", "");
  RunList list(folder / "");
  EXPECT_FALSE(list.runs().front().problem.empty());
  support::writeFile(folder / "a/summary.json", kSummary);
  EXPECT_TRUE(list.runs().front().problem.empty());
  fs::remove_all(folder / "a");
  EXPECT_THAT(list.runs(), IsEmpty());
}

TEST(RunList, ServesOnlyFilesOfTheReport) {
  const TemporaryFolder folder;
  makeRun(folder / "runs/a");
  support::writeFile(folder / "secret.json", "{}");
  fs::create_symlink(folder / "secret.json", folder / "runs/a/link.json");
  fs::create_symlink(folder / "runs/a/summary.json", folder / "runs/a/inner.json");
  const RunList list(folder / "runs");
  for (const char* name : {"report.html", "figures/msd_abp.csv", "summary.json", "inner.json"}) {
    EXPECT_TRUE(list.file("a", name)) << name;
  }
  for (const char* name :
       {"log.lcmlog", "link.json", "../../secret.json", "", ".", "figures", ".svg",
        "figures/../summary.json", "/etc/passwd", "none.svg", "a\\b.svg"}) {
    EXPECT_FALSE(list.file("a", name)) << name;
  }
  for (const char* run : {"", ".", "..", "../runs/a", "a/", "/", "b"}) {
    EXPECT_FALSE(list.file(run, "summary.json")) << run;
  }
}

class LibraryTest : public WebTest {
 protected:
  LibraryTest() {
    makeRun(folder_ / "runs/abp-20260131T120000Z");
    start();
  }
  const std::string kRun = "/api/runs/abp-20260131T120000Z/";
};

TEST_F(LibraryTest, RestrictsFilesOfRunsInTheBrowser) {
  EXPECT_THAT(send("GET", "/api/runs"), HasSubstr(R"("verdict":"agrees","max_z":1.5)"));
  EXPECT_THAT(send("GET", kRun + "report.html"),
              AllOf(StartsWith("HTTP/1.1 200"),
                    HasSubstr("Content-Security-Policy: sandbox allow-scripts;"),
                    EndsWith("<html>report</html>")));
  EXPECT_THAT(send("GET", kRun + "trajectory_program.svg"),
              AllOf(HasSubstr("Content-Type: image/svg+xml"),
                    HasSubstr("Content-Security-Policy: sandbox;"), EndsWith("<svg/>")));
  EXPECT_THAT(send("GET", kRun + "figures/msd_abp.csv"), HasSubstr("Content-Type: text/csv"));
  support::writeFile(folder_ / "runs/abp-20260131T120000Z/film.mp4", "film");
  EXPECT_THAT(send("GET", kRun + "film.mp4"),
              AllOf(HasSubstr("Content-Type: video/mp4"), EndsWith("film")));
  for (const char* name : {"log.lcmlog", "none.svg", "figures%2fmsd_abp.csv", ""}) {
    EXPECT_EQ(statusOf(send("GET", kRun + name)), "404") << name;
  }
}

TEST_F(LibraryTest, SendsLargeFilesCompletely) {
  std::string text;
  for (int i = 0; i < 400'000; ++i) text += std::to_string(i) + "\n";
  support::writeFile(folder_ / "runs/abp-20260131T120000Z/trajectories.csv", text);
  EXPECT_THAT(send("GET", kRun + "trajectories.csv"), EndsWith("\r\n\r\n" + text));
}

TEST_F(LibraryTest, ListsTheRunningLabsWithTheirPagesForThoseWhoMayControl) {
  setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1);
  EXPECT_THAT(send("GET", "/api/labs"), EndsWith("\r\n\r\n[]"));
  const std::string pid = std::to_string(getpid());
  const fs::path registry = folder_ / "active-lab";
  support::writeFile(registry / (pid + ".json"),
                     R"({"name": "abp-1", "url": "udpm://x", "pid": )" + pid +
                         R"(, "directory": "/runs/abp-1", "replay": false})");
  EXPECT_THAT(send("GET", "/api/labs", token()), HasSubstr(R"("name":"abp-1")"));
  EXPECT_THAT(send("GET", "/api/labs", token()), HasSubstr(R"("address":null)"));
  support::writeFile(registry / (pid + ".web"), "http://127.0.0.1:8481/#token=12\n");
  EXPECT_THAT(send("GET", "/api/labs", token()),
              HasSubstr(R"("address":"http://127.0.0.1:8481/#token=12")"));
  EXPECT_THAT(send("GET", "/api/labs"), HasSubstr(R"("address":null)"));
}

TEST_F(LibraryTest, ComparesRuns) {
  const std::string answer = send("GET", "/api/compare?runs=abp-20260131T120000Z");
  EXPECT_THAT(answer,
              HasSubstr(R"("curves":[{"name":"msd","unit":"cm²","lag":[0.1,0.2],"value":[1,2],)"
                        R"("sigma":[0.1,0.2],"exact":[1,2.1],"paper":[1,2.2],"windows":[9,8],)"
                        R"("biased":[false,true]},{"name":"angular_msd")"));
  EXPECT_THAT(answer,
              HasSubstr(R"({"name":"D_r","unit":"rad²/s","value":0.7,"sigma":0.1,"low":0.5,)"
                        R"("high":0.9,"theory":0.75,"note":"x"})"));
  EXPECT_THAT(answer, HasSubstr(R"({"name":"L_s","unit":"cm",)"));
  EXPECT_EQ(statusOf(send("GET", "/api/compare?runs=abp-20260131T120000Z,none")), "404");
  EXPECT_EQ(statusOf(send("GET", "/api/compare?runs=..%2f..")), "404");
  EXPECT_EQ(statusOf(send("GET", "/api/compare?runs=a,b,c,d,e,f,g,h,i")), "404");
  support::writeFile(folder_ / "runs/half/experiment.toml", "");
  EXPECT_EQ(statusOf(send("GET", "/api/compare?runs=half")), "409");
  support::writeFile(folder_ / "runs/half/summary.json", "{");
  EXPECT_EQ(statusOf(send("GET", "/api/compare?runs=half")), "409");
  // It would overflow the stack of what copies and prints it.
  constexpr std::size_t kDepth = 300'000;
  support::writeFile(folder_ / "runs/half/summary.json", R"({"programs": [{"pool": {"verdict": )" +
                                                             std::string(kDepth, '[') +
                                                             std::string(kDepth, ']') + "}}]}");
  EXPECT_EQ(statusOf(send("GET", "/api/compare?runs=half")), "409");
}

// Parsed, a summary takes many times its size.
TEST_F(LibraryTest, ComparesNotMoreThan20Megabytes) {
  for (const char* name : {"one", "two"}) {
    support::writeFile(folder_ / "runs" / name / "experiment.toml", "");
    support::writeFile(folder_ / "runs" / name / "summary.json",
                       R"({"programs": []})" + std::string(10'000'000, ' '));
  }
  EXPECT_EQ(statusOf(send("GET", "/api/compare?runs=one")), "200");
  EXPECT_EQ(statusOf(send("GET", "/api/compare?runs=two")), "200");
  const std::string answer = send("GET", "/api/compare?runs=one,two");
  EXPECT_EQ(statusOf(answer), "409");
  EXPECT_THAT(answer, HasSubstr("two: up to this run, the files summary.json have 20000032 bytes, "
                                "expected at most 20000000; compare fewer runs"));
}

TEST(LibraryRoutes, ComparesForOneClientAfterTheOther) {
  constexpr std::size_t kClients = 4;
  const TemporaryFolder folder;
  for (const char* name : {"one", "two", "three"}) makeRun(folder / "runs" / name);
  std::vector<std::thread::id> readers;
  std::latch all_have_called(kClients);
  std::atomic<bool> reading = false;
  std::atomic<bool> together = false;
  LibraryRoutes dut({.programs = {}, .experiments = {}, .runs = folder / "runs", .own = {}},
                    [&](const fs::path&) -> std::string {
                      if (reading.exchange(true)) together = true;
                      // The others call meanwhile, and would enter if they could.
                      all_have_called.wait();
                      readers.push_back(std::this_thread::get_id());
                      reading = false;
                      return kSummary;
                    });
  HttpRequest request;
  request.method = "GET";
  request.target = "/api/compare?runs=one,two,three";

  std::vector<HttpResponse> responses(kClients);
  std::vector<std::thread> clients;
  for (HttpResponse& response : responses) {
    clients.emplace_back([&] {
      all_have_called.count_down();
      EXPECT_TRUE(dut.get(request, false, response).yes());
    });
  }
  for (std::thread& client : clients) client.join();

  EXPECT_FALSE(together);
  for (const HttpResponse& response : responses) EXPECT_EQ(response.status, 200);
  ASSERT_THAT(readers, SizeIs(3 * kClients));
  for (std::size_t i = 0; i < readers.size(); ++i) {
    EXPECT_EQ(readers[i], readers[i / 3 * 3]) << "a comparison is read at a stretch";
  }
}

TEST(LibraryRoutes, ComparesNothingWhenTheServerEnds) {
  const TemporaryFolder folder;
  makeRun(folder / "runs/one");
  LibraryRoutes dut({.programs = {}, .experiments = {}, .runs = folder / "runs", .own = {}});
  HttpRequest request;
  request.method = "GET";
  request.target = "/api/compare?runs=one";
  HttpResponse response;
  dut.close();

  EXPECT_TRUE(dut.get(request, false, response).yes());

  EXPECT_EQ(response.status, 503);
}

}  // namespace
}  // namespace lab::dashboard
