#include "dashboard/library/run_launcher.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "dashboard/control/json_object_reader.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/text_file.hpp"

namespace lab::dashboard::run_launcher_test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

const std::atomic<bool> kNoStop = false;

/// Uses a shell script in place of `lab`.
class RunLauncherTest : public testing::Test {
 protected:
  RunLauncherTest() {
    support::writeFile(folder_ / "shipped/abp.toml",
                       "name = \"abp\"\ndescription = \"ABP\"\n[programs.abp]\n");
    support::writeFile(folder_ / "own/mine.toml", "name = \"mine\"\n[[robots]]\nid = 1\n");
    support::writeFile(folder_ / "own/camera.toml", "width_px = 3\n");
    support::writeFile(folder_ / "own/broken.toml", "name = \n");
    support::writeFile(folder_ / "own/experiments/deep.toml", "[[robots]]\n");
  }
  void lab(const std::string& script) {
    support::writeFile(folder_ / "bin/lab", "#!/bin/sh\n" + script);
    fs::permissions(folder_ / "bin/lab", fs::perms::owner_all);
  }
  json whenEnded() {
    while (true) {
      json started = json::parse(launcher_.started(true));
      if (started["state"] != "running") return started;
      std::this_thread::sleep_for(2ms);
    }
  }

  TemporaryFolder folder_;
  RunLauncher launcher_{{folder_ / "bin", folder_ / "shipped", folder_ / "runs", folder_ / "own"}};
};

TEST_F(RunLauncherTest, ListsShippedExperimentsAndThoseOfTheUser) {
  EXPECT_EQ(json::parse(launcher_.experiments()), json::parse(R"([
    {"file": "shipped/abp.toml", "name": "abp", "description": "ABP", "shipped": true},
    {"file": "broken.toml", "name": "broken", "description": "syntax error in line 1", "shipped": false},
    {"file": "mine.toml", "name": "mine", "description": "", "shipped": false},
    {"file": "experiments/deep.toml", "name": "deep", "description": "", "shipped": false}])"));
}

TEST_F(RunLauncherTest, SaysWhyAListedExperimentCannotBeRead) {
  std::string key = "a";
  for (int i = 0; i < 100; ++i) key += ".a";
  support::writeFile(folder_ / "own/broken.toml", "\n" + key + " = 1\n");
  EXPECT_THAT(launcher_.experiments(), HasSubstr("found a key of too many names in line 2"));
}

TEST_F(RunLauncherTest, PassesOnTheOutputOfLabCheck) {
  lab("for a in \"$@\"; do echo \"<$a>\"; done; echo bad key >&2; exit 2\n");
  const auto answer = launcher_.check(R"({"file":"mine.toml","set":["duration_s=5","a='$(id)'"]})");
  EXPECT_EQ(answer.status, 200);
  const json said = json::parse(answer.json);
  EXPECT_EQ(said["ok"], false);
  EXPECT_EQ(said["text"], "<check>\n<" + (folder_ / "own/mine.toml").string() +
                              ">\n<--set=duration_s=5>\n<--set=a='$(id)'>\nbad key\n");
  lab("exit 0\n");
  EXPECT_EQ(json::parse(launcher_.check(R"({"file":"shipped/abp.toml","set":[]})").json)["ok"],
            true);
}

TEST_F(RunLauncherTest, AcceptsOnlyListedFilesAndCompleteRequests) {
  lab("exit 0\n");
  for (const char* file :
       {"/etc/passwd", "../own/mine.toml", "camera.toml", "abp.toml", "", "--help"}) {
    EXPECT_EQ(launcher_.check(json{{"file", file}, {"set", json::array()}}.dump()).status, 404)
        << file;
  }
  for (const char* body :
       {"{}", R"({"file":"mine.toml"})", R"({"file":"mine.toml","set":"a=1"})",
        R"({"file":"mine.toml","set":["a"]})", R"({"file":"mine.toml","set":["=a"]})",
        R"({"file":"mine.toml","set":[1]})", R"({"file":"mine.toml","set":[],"x":1})",
        R"({"file":"mine.toml","set":["a=\n"]})"}) {
    EXPECT_THROW(static_cast<void>(launcher_.check(body)), JsonObjectError) << body;
    EXPECT_THROW(static_cast<void>(launcher_.start(body)), JsonObjectError) << body;
  }
  EXPECT_EQ(json::parse(launcher_.started(true))["state"], "none");
}

TEST_F(RunLauncherTest, StartsOneRunAndReportsItsProgress) {
  lab("echo \"run      /x/runs/mine-1\"; echo \"page http://127.0.0.1:1/#token=secret now\"\n"
      "for a in \"$@\"; do case $a in --web-address-file=*) f=${a#*=};; esac; done\n"
      "echo http://127.0.0.1:1/#token=secret > $f\n"
      "while [ ! -e " +
      (folder_ / "go").string() + " ]; do sleep 0.01; done; exit 3\n");
  const std::string order = R"({"file":"mine.toml","set":[],"virtual_time":false})";
  EXPECT_EQ(launcher_.start(order).status, 202);
  json told;
  while (told["address"].is_null() || told["run"].is_null()) {
    told = json::parse(launcher_.started(true));
  }
  EXPECT_EQ(told["state"], "running");
  EXPECT_EQ(told["address"], "http://127.0.0.1:1/#token=secret");
  EXPECT_EQ(told["run"], "mine-1");
  EXPECT_TRUE(told["code"].is_null());
  EXPECT_THAT(launcher_.started(false), Not(HasSubstr("secret")));
  EXPECT_THAT(launcher_.started(false), HasSubstr("#token=... now"));
  EXPECT_EQ(launcher_.start(order).status, 409);
  support::writeFile(folder_ / "go", "");
  EXPECT_EQ(whenEnded()["code"], 3);
  lab("echo \"$@\"\n");
  EXPECT_EQ(launcher_.start(R"({"file":"mine.toml","set":[],"virtual_time":true})").status, 202);
  const std::string output = whenEnded()["output"];
  EXPECT_THAT(output, HasSubstr("--virtual-time"));
  EXPECT_THAT(output, Not(HasSubstr("--web")));
}

TEST_F(RunLauncherTest, SaysThatTheProgramIsMissing) {
  EXPECT_THROW(
      static_cast<void>(launcher_.start(R"({"file":"mine.toml","set":[],"virtual_time":true})")),
      std::runtime_error);
}

TEST(LabCommand, KeepsTheEndOfLongOutput) {
  const CommandResult result = runCommand(
      {"/bin/sh", "-c", "i=0; while [ $i -lt 20000 ]; do echo line $i; i=$((i+1)); done"}, 60s,
      kNoStop);
  EXPECT_EQ(result.code, 0);
  EXPECT_LE(result.output.size(), 16384U);
  EXPECT_THAT(result.output, testing::StartsWith("line "));
  EXPECT_THAT(result.output, testing::EndsWith("line 19999\n"));
}

TEST(LabCommand, KillsACommandAndItsChildrenAfterTheTimeout) {
  const CommandResult result =
      runCommand({"/bin/sh", "-c", "echo a; sleep 1000 & wait"}, 200ms, kNoStop);
  EXPECT_TRUE(result.was_killed);
  EXPECT_EQ(result.output, "a\n");
  EXPECT_EQ(result.code, 128 + 9);
}

TEST(LabCommand, KillsTheCommandWhenStopIsSet) {
  EXPECT_TRUE(
      runCommand({"/bin/sh", "-c", "sleep 1000"}, 1000s, std::atomic<bool>(true)).was_killed);
}

TEST(LabCommand, CutsAtTheBeginOfALineOrCharacter) {
  EXPECT_EQ(tailOf("short", 100), "short");
  EXPECT_EQ(tailOf("one\ntwo\nthree", 8), "three");
  EXPECT_EQ(tailOf("\xc3\xa4\xc3\xa4\xc3\xa4", 3), "\xc3\xa4");
}

}  // namespace
}  // namespace lab::dashboard::run_launcher_test
