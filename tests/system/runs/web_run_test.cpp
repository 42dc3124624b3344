// The dashboard during a run and a replay, and requests from the command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <lab/experiment_event_t.hpp>
#include <lab/experiment_status_t.hpp>
#include <set>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "tests/support/lab_process.hpp"

namespace lab::system_test {
namespace {

using std::chrono::seconds;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;
namespace fs = std::filesystem;

class WebRun : public testing::Test {
 protected:
  WebRun() { setenv("XDG_RUNTIME_DIR", folder.path().c_str(), 1); }

  [[nodiscard]] std::string labRun(const std::string& more) const {
    return "exec lab run " + experiment("light_switching").string() + " --out " + runs().string() +
           " --set dashboard.port=28480 " + more;
  }
  [[nodiscard]] fs::path runs() const { return folder.path() / "runs"; }

  /// The printed address of the dashboard; empty if there is none.
  static std::string addressIn(const std::string& output) {
    const auto at = output.find("web      http://");
    const auto end = output.find('\n', at);
    return at == std::string::npos || end == std::string::npos
               ? ""
               : output.substr(at + 9, end - at - 9);
  }

  static std::string addressOf(Background& lab) {
    waitUntil([&] { return !addressIn(lab.output()).empty(); }, seconds(60));
    return addressIn(lab.output());
  }

  /// Whether the dashboard answers at this address.
  static bool answers(const std::string& address) {
    return run("python3 -c 'import sys, urllib.request as u; "
               "sys.exit(b\"<html\" not in u.urlopen(sys.argv[1], timeout=2).read().lower())' '" +
               address + "'")
               .exit_code == 0;
  }

  /// The dashboard's files in the registry folder.
  [[nodiscard]] std::set<std::string> leftInRegistry() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder.path() / "active-lab")) {
      const std::string name = entry.path().filename();
      if (name.find(".web") != std::string::npos) names.insert(name);
    }
    return names;
  }

  TemporaryFolder folder;
};

struct Record {
  std::vector<std::string> marks;
  std::set<std::string> faults;
  std::string end;
  std::int64_t statuses = 0;
  std::int64_t last_status = 0;
  std::set<int> phases;
};

Record recordOf(const fs::path& log) {
  Record record;
  readLog({log}, [&record](const Packet& packet) {
    experiment_event_t event{};
    experiment_status_t status{};
    if (packet.channel == channels::kExperimentEvent && decode(packet.data, event)) {
      if (event.kind == experiment_event_t::MARK &&
          (record.marks.empty() || record.marks.back() != event.text)) {
        record.marks.push_back(event.text);
      }
      if (event.kind == experiment_event_t::FAULT) record.faults.insert(event.text);
      if (event.kind == experiment_event_t::END) record.end = event.text;
    }
    if (packet.channel == channels::kExperimentStatus && decode(packet.data, status)) {
      ++record.statuses;
      record.last_status = status.seq;
      record.phases.insert(status.phase);
    }
  });
  return record;
}

TEST_F(WebRun, AnswersExecutesRequestsAndIsRestartedWhenKilled) {
  const fs::path copy = folder.path() / "address";
  Background lab(labRun("--web --web-address-file " + copy.string()));
  ASSERT_TRUE(
      waitUntil([&] { return lab.output().find("running ") != std::string::npos; }, seconds(60)))
      << lab.output();
  const std::string address = addressOf(lab);
  ASSERT_THAT(address, HasSubstr("http://127.0.0.1:28480/#token=")) << lab.output();
  EXPECT_THAT(lab.output(), testing::StartsWith("web      http://"));
  EXPECT_TRUE(waitUntil([&] { return readFile(copy) == address + "\n"; }, seconds(60)));
  EXPECT_EQ(fs::status(copy).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_TRUE(answers(address));

  EXPECT_EQ(run("lab resume").exit_code, 1);
  const Finished pause = run("lab pause");
  EXPECT_EQ(pause.exit_code, 0) << pause.output;
  const Finished again = run("lab pause");
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.output, HasSubstr("refused: the script is paused already"));
  EXPECT_EQ(run("lab mark robot 1 lost a wheel").exit_code, 0);
  EXPECT_EQ(run("lab mark \"$(printf 'two\\nlines')\"").exit_code, 2);
  EXPECT_EQ(run("lab resume").exit_code, 0);
  EXPECT_EQ(run("lab light 0.5 --for 1").exit_code, 0);

  for (const pid_t pid : childrenWith(lab.pid(), "/dashboard")) kill(pid, SIGKILL);
  ASSERT_TRUE(waitUntil(
      [&] { return lab.output().find("dashboard died (killed by signal 9)") != std::string::npos; },
      seconds(60)));
  EXPECT_TRUE(waitUntil([&] { return answers(address); }, seconds(60))) << "on the same port";

  const Finished end = run("lab end seen enough");
  EXPECT_EQ(end.exit_code, 0) << end.output;
  const Finished ended = lab.wait(seconds(60));
  EXPECT_EQ(ended.exit_code, 0) << ended.output;
  EXPECT_FALSE(answers(address));
  EXPECT_FALSE(fs::exists(copy));
  EXPECT_THAT(leftInRegistry(), IsEmpty());

  const fs::path done = onlyRun(runs());
  const Record record = recordOf(done / "log.lcmlog");
  EXPECT_THAT(record.faults, IsEmpty());
  EXPECT_EQ(record.end, "ended by lab_end: seen enough");
  EXPECT_THAT(record.marks, Contains("script paused by lab_pause"));
  EXPECT_THAT(record.marks, Contains(testing::StartsWith("script resumed by lab_resume after ")));
  EXPECT_THAT(record.marks, Contains("lab_mark: robot 1 lost a wheel"));
  EXPECT_THAT(record.marks, Contains("dashboard died (killed by signal 9) and was restarted"));
  EXPECT_EQ(record.statuses, record.last_status) << "the log contains all of them";
  EXPECT_THAT(record.phases, testing::IsSupersetOf({static_cast<int>(experiment_status_t::PAUSED),
                                                    static_cast<int>(experiment_status_t::ENDED)}));
  EXPECT_TRUE(readJson(done / "provenance.json").at("interrupted"));
  EXPECT_GT(fs::file_size(done / "report.html"), 100U);
  EXPECT_THAT(ended.output, Not(HasSubstr("last count"))) << "the commands report their own counts";
}

TEST_F(WebRun, RunsADashboardInRealTimeUnlessDisabled) {
  const std::string brief = labRun("--no-report --set duration_s=1");

  const Finished by_itself = run("unset CI; " + brief);
  EXPECT_EQ(by_itself.exit_code, 0) << by_itself.output;
  EXPECT_NE(addressIn(by_itself.output), "") << by_itself.output;
  EXPECT_EQ(addressIn(run("unset CI; " + brief + " --no-web").output), "");
  EXPECT_EQ(addressIn(run("export CI=1; " + brief).output), "");
}

TEST_F(WebRun, ReplaysWithADashboardAndRefusesOtherRequests) {
  ASSERT_EQ(run(labRun("--virtual-time --no-report --set duration_s=20")).exit_code, 0);
  EXPECT_EQ(run(labRun("--virtual-time --web")).exit_code, 2);
  const Finished no_page = run(labRun("--no-web --web-address-file " + (runs() / "a").string()));
  EXPECT_EQ(no_page.exit_code, 2);
  EXPECT_THAT(no_page.output, HasSubstr("has no dashboard"));
  Background replay("cd " + onlyRun(runs()).string() + " && exec lab replay . --web --speed 2");
  const std::string address = addressOf(replay);
  ASSERT_NE(address, "") << replay.output();
  EXPECT_TRUE(answers(address));
  EXPECT_EQ(run("lab pause").exit_code, 0);
  const Finished mark = run("lab mark nothing");
  EXPECT_EQ(mark.exit_code, 1);
  EXPECT_THAT(mark.output, HasSubstr("this is a replay"));
  EXPECT_EQ(run("lab resume").exit_code, 0);
  EXPECT_TRUE(waitUntil(
      [&] { return replay.output().find("paused (the space") != std::string::npos; }, seconds(60)))
      << "it pauses at its end";
  EXPECT_TRUE(replay.running());
  EXPECT_EQ(run("lab end").exit_code, 0);
  const Finished ended = replay.wait(seconds(60));
  EXPECT_EQ(ended.exit_code, 0);
  EXPECT_THAT(ended.output, HasSubstr("lab      replay-light_switching"));
  EXPECT_FALSE(answers(address));
  EXPECT_THAT(leftInRegistry(), IsEmpty());
}

/// Runs of older versions may have keys that would run code; a replay executes nothing.
TEST_F(WebRun, ReplaysAnOlderRunWithADashboard) {
  ASSERT_EQ(run(labRun("--virtual-time --no-report --set duration_s=20")).exit_code, 0);
  const fs::path file = onlyRun(runs()) / "experiment.toml";
  run("sed -i 's/^configuration = .*/configuration = \"my.xml\"/' " + file.string());
  ASSERT_THAT(readFile(file), HasSubstr("my.xml"));
  EXPECT_EQ(run("lab check " + file.string()).exit_code, 2);
  Background replay("exec lab replay " + onlyRun(runs()).string() + " --web");
  EXPECT_TRUE(answers(addressOf(replay))) << replay.output();
  replay.signal(SIGINT);
  EXPECT_EQ(replay.wait(seconds(10)).exit_code, 0);
}

TEST_F(WebRun, ReplaysARunForThisMachineOnlyWhateverItsFileSays) {
  ASSERT_EQ(run(labRun("--virtual-time --no-report --set duration_s=20")).exit_code, 0);
  const fs::path file = onlyRun(runs()) / "experiment.toml";
  run("sed -i '/^.dashboard.$/,/^$/ s/^address = .*/address = \"127.0.0.2\"/' " + file.string());
  ASSERT_THAT(readFile(file), HasSubstr("[dashboard]\naddress = \"127.0.0.2\""));
  Background replay("exec lab replay " + onlyRun(runs()).string() + " --web");
  EXPECT_THAT(addressOf(replay), StartsWith("http://127.0.0.1:")) << replay.output();
  replay.signal(SIGINT);
  EXPECT_EQ(replay.wait(seconds(10)).exit_code, 0);
}

TEST_F(WebRun, ShowsPastRunsWithoutALab) {
  Background web("exec lab web --port 28481 --runs " + folder.path().string());
  const std::string address = addressOf(web);
  ASSERT_THAT(address, HasSubstr(":28481/#token=")) << web.output();
  EXPECT_TRUE(answers(address));
  web.signal(SIGINT);
  EXPECT_EQ(web.wait(seconds(60)).exit_code, 0) << web.output();
  EXPECT_FALSE(answers(address));
}

}  // namespace
}  // namespace lab::system_test
