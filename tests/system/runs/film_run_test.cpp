// The film of a run with a painted camera, in virtual time: recorded, tracked again, analyzed
// again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/lab_process.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kShort =
    " --virtual-time --no-report --set light.steps[1].at_s=1 --set "
    "light.steps[1].ramp_s=1 --set camera.width_px=640 --set camera.height_px=480 --set "
    "camera.fps=20 ";

class FilmRun : public testing::Test {
 protected:
  fs::path labRun(const std::string& more) {
    const fs::path out = folder_.path() / std::to_string(++runs_);
    output_ = labOutput("run optical_loop --runs " + out.string() + kShort + "--set duration_s=3 " +
                        more);
    return onlyRun(out);
  }

  TemporaryFolder folder_;
  std::string output_;

 private:
  int runs_ = 0;
};

TEST_F(FilmRun, LosslessGivesThePosesAndTheRobotsOfTheRunAgainToTheBit) {
  for (const char* codec : {"ffv1", "ffvhuff"}) {
    const fs::path run =
        labRun(std::string("--set camera.record=true --set camera.record_codec=") + codec);
    const nlohmann::json film = readJson(run / "film/film.json");
    const std::string frames = film["frames"].dump();
    EXPECT_GT(film["frames"].get<int>(), 60);
    EXPECT_EQ(film["lost"], 0);
    EXPECT_EQ(film["complete"], true);

    EXPECT_THAT(
        labOutput("track " + run.string()),
        HasSubstr("in " + frames + " of " + frames + " frames those of the run, bit by bit"));
    const std::string poses = readFile(run / "film/poses.csv");
    EXPECT_THAT(poses, HasSubstr("\n" + std::to_string(film["frames"].get<int>() - 1) + ",5,"));

    EXPECT_THAT(labOutput("analyze --retrack --no-figures --no-bootstrap " + run.string()),
                HasSubstr("bit by bit"));
    EXPECT_TRUE(readFile(run / "retracked/log.lcmlog") == readFile(run / "log.lcmlog")) << codec;
    EXPECT_TRUE(fs::exists(run / "retracked/report.html"));
  }
}

TEST_F(FilmRun, ChangesNothingElseInTheRun) {
  const fs::path with = labRun("--set camera.record=true");
  const fs::path without = labRun("");

  EXPECT_THAT(readFile(with / "experiment.toml"), HasSubstr("record = true\n"));
  EXPECT_THAT(readFile(without / "experiment.toml"), Not(HasSubstr("record")));
  EXPECT_FALSE(fs::exists(without / "film"));
  for (const fs::path& run : {with, without}) {
    static_cast<void>(labOutput("analyze --no-figures --no-bootstrap " + run.string()));
  }
  EXPECT_TRUE(readFile(with / "trajectories.csv") == readFile(without / "trajectories.csv"));
}

TEST_F(FilmRun, TakesAnotherCalibrationAndSaysSo) {
  const fs::path run = labRun("--set camera.record=true");
  nlohmann::json calibration = readJson(run / "calibration/camera_in_force.json");
  calibration["translation_m"][0] = calibration["translation_m"][0].get<double>() + 0.01;
  const fs::path moved = folder_.path() / "moved.json";
  std::ofstream(moved) << calibration.dump();

  const std::string output =
      labOutput("analyze --retrack --no-figures --no-bootstrap --calibration " + moved.string() +
                " " + run.string());

  EXPECT_THAT(output, HasSubstr("in 0 of "));
  EXPECT_THAT(readFile(run / "retracked/report.html"),
              HasSubstr("with " + moved.string() + "</p>"));
}

// A run may come from a stranger.
TEST_F(FilmRun, ShowsControlCharactersOfItsNameAsText) {
  const fs::path run = folder_.path() / "odd\x1b[2J";
  fs::rename(labRun("--set camera.record=true"), run);

  for (const std::string command : {"track", "analyze --no-figures --no-bootstrap"}) {
    EXPECT_THAT(labOutput(command + " '" + run.string() + "'"),
                AllOf(HasSubstr("/odd\\x1b[2J/"), Not(HasSubstr("\x1b"))));
  }
}

TEST_F(FilmRun, CompressedSaysSo) {
  const fs::path run = labRun("--set camera.record=true --set camera.record_codec=h264");

  EXPECT_THAT(labOutput("track " + run.string()), HasSubstr("the film is compressed"));
  EXPECT_GT(readFile(run / "film/poses.csv").size(), 10'000U);
}

TEST_F(FilmRun, EndsAtItsBoundAndTheRunGoesOn) {
  const fs::path run = labRun("--set camera.record=true --set camera.record_most_GB=0.001");

  const nlohmann::json film = readJson(run / "film/film.json");
  EXPECT_THAT(film["problem"].get<std::string>(), HasSubstr("it has reached 0.001 GB"));
  EXPECT_GT(film["after_end"].get<int>(), 0);
  EXPECT_THAT(output_, AllOf(HasSubstr("film: ends after"), HasSubstr("the run goes on")));
  EXPECT_THAT(labOutput("track " + run.string()),
              HasSubstr("frames of the run are not in the film"));
}

TEST_F(FilmRun, NeedsFfmpegBeforeItBegins) {
  const fs::path out = folder_.path() / "none";
  const std::string programs = LAB_PROGRAMS;
  const Finished lab = run("PATH=" + programs + " " + programs + "/lab run optical_loop --runs " +
                           out.string() + kShort + "--set duration_s=3 --set camera.record=true");

  EXPECT_EQ(lab.exit_code, 2);
  EXPECT_THAT(lab.output, HasSubstr("ffmpeg is not installed: sudo apt-get install ffmpeg"));
  EXPECT_FALSE(fs::exists(out));
}

TEST_F(FilmRun, StaysOnTheMachineOfTheTracker) {
  EXPECT_THAT(
      labOutput("check optical_loop --set camera.record=true --set "
                "services.tracker_svc.host=me@other --set services.sim_svc.host=me@other --set "
                "link.unsecured=true",
                2),
      HasSubstr("camera.record: found true with tracker_svc on host \"me@other\""));
}

TEST_F(FilmRun, OfAKilledRunIsReadable) {
  const fs::path out = folder_.path() / "killed";
  Background lab("exec lab run optical_loop --runs " + out.string() + kShort +
                 "--set duration_s=600 --set camera.record=true");
  fs::path film;
  ASSERT_TRUE(waitUntil(
      [&] {
        if (film.empty() && fs::exists(out) && !fs::is_empty(out)) film = onlyRun(out) / "film";
        std::error_code error;
        return !film.empty() && fs::file_size(film / "film.mkv", error) > 3'000'000 && !error;
      },
      std::chrono::minutes(3)));
  lab.signal(SIGKILL);
  static_cast<void>(lab.wait(std::chrono::seconds(60)));
  // The encoder completes the movie by itself.
  EXPECT_TRUE(waitUntil([&] { return processesWith((film / "film.mkv").string()).empty(); },
                        std::chrono::minutes(1)));

  const std::string poses = (folder_.path() / "poses.csv").string();
  const Finished tracked =
      run("lab track " + (film / "film.mkv").string() + " --calibration " +
              (film / "../calibration/camera_in_force.json").string() + " --out " + poses,
          std::chrono::minutes(5));

  EXPECT_THAT(tracked.exit_code, testing::AnyOf(0, 3)) << tracked.output;
  EXPECT_GT(readFile(poses).size(), 5'000U);
  EXPECT_EQ(readJson(film / "film.json")["complete"], false);
}

}  // namespace
}  // namespace lab::system_test
