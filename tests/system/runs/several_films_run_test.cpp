// The films of two painted cameras in virtual time: recorded, tracked again as one, shown side by
// side.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <lab/tracked_frame_t.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/channels.hpp"
#include "common/bus/log_file.hpp"
#include "tests/support/lab_process.hpp"

namespace lab::system_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Four robots under two cameras whose clocks differ.
constexpr const char* kExperiment = R"(
fileversion = 1
name = "two"
duration_s = 3

[arena]
width_cm = 90
height_cm = 60

[[robots]]
id = 1
count = 4

[programs.abp]
model = "abp"
v_cm_s = 5
epsilon_s = 0.5
eta_rad_s = 1

[light_table]
bands = [{light = [0.00, 1.00], program = "abp"}]

[[light.steps]]
at_s = 0
layers = [{kind = "uniform", intensity = 0.8}]

[camera]
tracker = "camera"
fps = 20
width_px = 400
height_px = 400
record = true
record_codec = "ffvhuff"

[[cameras]]
name = "west"
view_width_cm = 57

[[cameras]]
name = "east"
view_x_cm = 33
view_width_cm = 57
clock_error_ms = 3
)";

class SeveralFilmsRun : public testing::Test {
 protected:
  SeveralFilmsRun() { std::ofstream(folder_.path() / "two.toml") << kExperiment; }

  fs::path labRun(const std::string& more = "") {
    const fs::path out = folder_.path() / std::to_string(++runs_);
    output_ = labOutput("run " + (folder_.path() / "two.toml").string() +
                        " --virtual-time --no-report --runs " + out.string() + " " + more);
    return onlyRun(out);
  }

  TemporaryFolder folder_;
  std::string output_;

 private:
  int runs_ = 0;
};

TEST_F(SeveralFilmsRun, GiveThePosesAndTheRobotsOfTheRunAgainToTheBit) {
  for (const char* codec : {"ffv1", "ffvhuff"}) {
    const fs::path run = labRun(std::string("--set camera.record_codec=") + codec);
    for (const std::string camera : {"west", "east"}) {
      const nlohmann::json film = readJson(run / "film" / camera / "film.json");
      EXPECT_EQ(film["camera"], camera);
      EXPECT_EQ(film["lost"], 0);
      EXPECT_EQ(film["complete"], true);
    }
    const int frames = readJson(run / "film/west/film.json")["frames"];
    EXPECT_GT(frames, 60);

    // A round has a frame of each camera.
    const std::string rounds = std::to_string(frames);
    EXPECT_THAT(labOutput("track " + run.string()),
                AllOf(HasSubstr(std::to_string(2 * frames) + " frames of 2 cameras"),
                      HasSubstr("in " + rounds + " of " + rounds + " rounds those of the run"),
                      Not(HasSubstr("film of camera"))));
    const std::string poses = readFile(run / "film/poses.csv");
    EXPECT_THAT(poses, HasSubstr("\n" + std::to_string(frames - 1) + ",4,"));

    static_cast<void>(labOutput("analyze --retrack --no-bootstrap --no-figures " + run.string()));
    EXPECT_TRUE(readFile(run / "retracked/log.lcmlog") == readFile(run / "log.lcmlog")) << codec;
  }
}

TEST_F(SeveralFilmsRun, AreShownSideBySideAndExported) {
  const fs::path run = labRun();
  static_cast<void>(labOutput("analyze --no-bootstrap " + run.string()));

  EXPECT_GT(readJson(run / "film_clip.json")["t_s"].size(), 60U);
  EXPECT_GT(fs::file_size(run / "film.mp4"), 10'000U);
  EXPECT_GT(fs::file_size(run / "film.jpg"), 10'000U);
  EXPECT_THAT(readFile(run / "report.html"),
              AllOf(HasSubstr("Camera east: "), HasSubstr("Camera west: ")));
  EXPECT_EQ(readJson(run / "summary.json")["films"][0]["camera"], "east");

  static_cast<void>(
      labOutput("export --mcap --out " + folder_.path().string() + " " + run.string()));
  EXPECT_THAT(
      readFile(folder_.path() / (run.filename().string() + ".mcap")),
      AllOf(HasSubstr("/lab/camera/east/compressed"), HasSubstr("/lab/camera/west/compressed")));
}

/// Frames whose times no tracker can have measured, from another program on the bus.
void addForgedFrames(const fs::path& log) {
  const fs::path whole = fs::path(log) += ".whole";
  fs::rename(log, whole);
  LogReader reader({whole});
  LogWriter writer(log);
  bool forged = false;
  while (const std::optional<Packet> packet = reader.next()) {
    writer.write(*packet);
    tracked_frame_t frame{};
    if (forged || packet->channel != channels::kTrackedFrame || !decode(packet->data, frame)) {
      continue;
    }
    forged = true;
    constexpr std::int64_t kYear_us = 365 * std::int64_t{86'400'000'000};
    for (const std::int64_t utime :
         {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min(),
          frame.utime + kYear_us}) {
      frame.utime = utime;
      const std::vector<std::uint8_t> message = encode(frame);
      writer.write({packet->channel, message, packet->received_utime});
    }
  }
  writer.flush();
  fs::remove(whole);
}

TEST_F(SeveralFilmsRun, AreShownAndTrackedWhateverAStrangerPutsIntoTheRun) {
  const fs::path run = labRun();
  addForgedFrames(run / "log.lcmlog");
  nlohmann::json film = readJson(run / "film/east/film.json");
  film["codec"] = "<script>alert(1)</script>";
  std::ofstream(run / "film/east/film.json") << film.dump();

  static_cast<void>(labOutput("analyze --no-bootstrap " + run.string()));

  EXPECT_GT(fs::file_size(run / "film.mp4"), 10'000U);
  EXPECT_THAT(readFile(run / "report.html"),
              AllOf(HasSubstr("(&lt;script&gt;alert(1)"), Not(HasSubstr("<script>alert(1)"))));
  static_cast<void>(labOutput("analyze --retrack --no-bootstrap --no-figures " + run.string()));
  EXPECT_TRUE(readFile(run / "retracked/log.lcmlog") == readFile(run / "log.lcmlog"));

  film["fps"] = 1e-300;
  std::ofstream(run / "film/east/film.json") << film.dump();
  EXPECT_THAT(labOutput("track " + run.string(), 2),
              HasSubstr("fps: found 1e-300, expected 0 (not known) or at least 0.001"));
}

TEST_F(SeveralFilmsRun, TakeOtherCalibrationsBySetAndNoSingleOne) {
  const fs::path run = labRun();
  const fs::path in_force = run / "calibration/camera_west_in_force.json";
  nlohmann::json calibration = readJson(in_force);
  calibration["translation_m"][0] = calibration["translation_m"][0].get<double>() + 0.01;
  const fs::path moved = folder_.path() / "moved.json";
  std::ofstream(moved) << calibration.dump();
  calibration["width_px"] = 200;
  const fs::path small = folder_.path() / "small.json";
  std::ofstream(small) << calibration.dump();
  const auto with = [](const fs::path& file) {
    return " --force --set cameras[0].calibration='\"" + file.string() + "\"'";
  };

  const std::string again = labOutput("track " + run.string() + with(moved));
  EXPECT_THAT(again, HasSubstr("in 0 of "));
  EXPECT_THAT(again, Not(HasSubstr("not in the film")));
  EXPECT_THAT(labOutput("track " + run.string() + with(small), 2),
              HasSubstr("small.json: found a calibration of 200 x 400 px, expected 400 x 400 px"));
  EXPECT_THAT(labOutput("track --calibration " + moved.string() + " " + run.string(), 2),
              AllOf(HasSubstr("found --calibration and films of several cameras"),
                    HasSubstr("--set cameras[0].calibration"), HasSubstr("film/east/film.mkv")));
  EXPECT_THAT(labOutput("track --force --overlay x.png " + run.string(), 2),
              HasSubstr("found --overlay and films of several cameras"));
  EXPECT_THAT(labOutput("track --calibration " + in_force.string() + " --out " +
                        (folder_.path() / "west.csv").string() + " " +
                        (run / "film/west/film.mkv").string()),
              HasSubstr("west.csv"));
}

TEST_F(SeveralFilmsRun, SayWhatIsMissing) {
  const fs::path run = labRun();
  const fs::path movie = run / "film/east/film.mkv";
  fs::resize_file(movie, fs::file_size(movie) / 2);
  const std::string cut = labOutput("track --force " + run.string(), 3);
  EXPECT_THAT(cut, AllOf(HasSubstr("fault    camera east: "), HasSubstr("frames could be read"),
                         Not(HasSubstr("in 0 of "))));

  fs::resize_file(movie, 0);
  EXPECT_THAT(labOutput("track --force " + run.string(), 3),
              HasSubstr("is not a movie that ffmpeg can read"));

  fs::remove_all(run / "film/east");
  EXPECT_THAT(labOutput("track --force " + run.string()), HasSubstr("camera east has no film"));
  static_cast<void>(labOutput("analyze --no-bootstrap " + run.string()));
  EXPECT_TRUE(fs::exists(run / "film.mp4"));  // with the other camera
}

TEST_F(SeveralFilmsRun, EndTogetherAtTheirBoundAndTheRunGoesOn) {
  const fs::path run = labRun("--set camera.record_most_GB=0.006");

  for (const char* camera : {"west", "east"}) {
    const nlohmann::json film = readJson(run / "film" / camera / "film.json");
    EXPECT_THAT(film["problem"].get<std::string>(),
                HasSubstr("the films of all cameras have reached 0.006 GB"));
    EXPECT_THAT(output_, HasSubstr(std::string("film of camera ") + camera + ": ends after"));
  }
  EXPECT_THAT(labOutput("track " + run.string()),
              AllOf(HasSubstr("rounds of the run are not in the films"),
                    HasSubstr("the film of camera east lacks")));
}

}  // namespace
}  // namespace lab::system_test
